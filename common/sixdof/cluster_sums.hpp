// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace spm {

/// By how much the sum over a cluster of samples differs between a level and the one above it.
struct ClusterChange {
  std::uint32_t key = 0;
  float force = 0;   ///< N
  float torque = 0;  ///< N m
};

/// What presses on a level of samples, added up cluster by cluster, and how that changed from the
/// level above it. Keys tell object and cluster, and grow as samples are looked at.
class ClusterSums {
 public:
  /// Makes room (allocates) for so many clusters of a level; then the rest does not allocate.
  void reserve(std::size_t clusters);
  /// Begins a tick.
  void begin() noexcept;
  /// Adds what presses in a cluster, N and N m, whose key is that of the last or larger.
  void add(std::uint32_t key, const std::array<double, 3>& force,
           const std::array<double, 3>& torque) noexcept;
  /// Ends a level, after which `changes` tells of it.
  void end_level() noexcept;
  /// Of each cluster in which something presses on the level that ended, or did on the one above,
  /// in the order of keys.
  [[nodiscard]] std::span<const ClusterChange> changes() const noexcept { return changes_; }
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Sum {
    std::uint32_t key = 0;
    std::array<float, 3> force{}, torque{};
  };
  std::vector<Sum> sums_, before_;
  std::vector<ClusterChange> changes_;
};

}  // namespace spm
