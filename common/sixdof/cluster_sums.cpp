// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/cluster_sums.hpp"

#include <cmath>
#include <utility>

namespace spm {

namespace {

float distance(const std::array<float, 3>& a, const std::array<float, 3>& b) noexcept {
  const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return std::sqrt(x * x + y * y + z * z);
}

void add_to(std::array<float, 3>& sum, const std::array<double, 3>& more) noexcept {
  for (std::size_t k = 0; k < 3; ++k) sum[k] += static_cast<float>(more[k]);
}

}  // namespace

void ClusterSums::reserve(std::size_t clusters) {
  sums_.reserve(clusters);
  before_.reserve(clusters);
  changes_.reserve(2 * clusters);
}

std::size_t ClusterSums::bytes() const noexcept {
  return (sums_.capacity() + before_.capacity()) * sizeof(Sum) +
         changes_.capacity() * sizeof(ClusterChange);
}

void ClusterSums::begin() noexcept {
  sums_.clear();
  before_.clear();
  changes_.clear();
}

void ClusterSums::add(std::uint32_t key, const std::array<double, 3>& force,
                      const std::array<double, 3>& torque) noexcept {
  if (sums_.empty() || sums_.back().key != key) sums_.emplace_back().key = key;
  add_to(sums_.back().force, force);
  add_to(sums_.back().torque, torque);
}

void ClusterSums::end_level() noexcept {
  changes_.clear();
  const Sum nothing;
  for (std::size_t now = 0, then = 0; now < sums_.size() || then < before_.size();) {
    const bool only_now =
        then == before_.size() || (now < sums_.size() && sums_[now].key < before_[then].key);
    const bool only_then =
        now == sums_.size() || (then < before_.size() && before_[then].key < sums_[now].key);
    const Sum& sum = only_then ? nothing : sums_[now++];
    const Sum& before = only_now ? nothing : before_[then++];
    changes_.push_back({only_then ? before.key : sum.key, distance(sum.force, before.force),
                        distance(sum.torque, before.torque)});
  }
  std::swap(sums_, before_);
  sums_.clear();
}

}  // namespace spm
