// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/triangle_sides.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <utility>

namespace spm::baker {

TriangleSides::TriangleSides(std::span<const Triangle> triangles) : numbers_(3 * triangles.size()) {
  // The two corners, the lesser one first, and which use.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> found;
  found.reserve(numbers_.size());
  for (const Triangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
      found.emplace_back(std::uint64_t{low} << 32U | high,
                         static_cast<std::uint32_t>(found.size()));
    }
  }
  tbb::parallel_sort(found);
  std::vector<CubeBins::Member> members;
  members.reserve(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i > 0 && found[i].first != found[i - 1].first) ++count_;
    numbers_[found[i].second] = static_cast<std::uint32_t>(count_);
    members.emplace_back(count_, found[i].second);
  }
  count_ += found.empty() ? 0 : 1;
  uses_ = CubeBins(count_, members);
}

}  // namespace spm::baker
