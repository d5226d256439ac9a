// SPDX-License-Identifier: Apache-2.0
#include "common/query/band_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace spm {

namespace {

/// The squares of the distances along each axis from a place to the lower and the upper half of a
/// cube; `from_middle` is the place from the cube's middle, `half` half the cube's edge.
struct HalfSquares {
  double lower, upper;
};
HalfSquares half_squares(double from_middle, double half) noexcept {
  const double quarter = half / 2;
  const double lower = std::max(0.0, std::abs(from_middle + quarter) - quarter);
  const double upper = std::max(0.0, std::abs(from_middle - quarter) - quarter);
  return {lower * lower, upper * upper};
}

/// A search for the nearest cube, nearer ones first.
struct Search {
  const DistanceOctree& octree;
  double best;  ///< square, m2

  // Or the compiler writes one level into another until the code is five times as long, and slower.
  [[gnu::noinline]] void take(OctreeKind kind, std::uint32_t word, int level,
                              const std::array<double, 3>& from_middle, double half,
                              double square) noexcept {
    if (kind == OctreeKind::far || !(square < best)) return;
    if (kind != OctreeKind::split || level == max_octree_levels ||
        std::size_t{word} + 1 >= octree.words.size()) {
      best = square;
      return;
    }
    const std::uint32_t first = octree.words[word];
    const std::uint32_t kinds = octree.words[word + 1];
    std::array<HalfSquares, 3> squares;
    std::uint32_t nearest = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      squares[axis] = half_squares(from_middle[axis], half);
      if (from_middle[axis] >= 0) nearest |= 1U << axis;
    }
    for (const std::uint32_t across : {0U, 1U, 2U, 4U, 3U, 5U, 6U, 7U}) {
      const std::uint32_t octant = nearest ^ across;
      const auto below = static_cast<OctreeKind>((kinds >> 4U * octant) & 15U);
      if (below == OctreeKind::far) continue;
      double apart = 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        apart += (octant >> axis & 1U) != 0 ? squares[axis].upper : squares[axis].lower;
      }
      if (!(apart < best)) continue;
      std::array<double, 3> from;
      for (unsigned axis = 0; axis < 3; ++axis) {
        from[axis] = from_middle[axis] + ((octant >> axis & 1U) != 0 ? -half / 2 : half / 2);
      }
      take(below, first + words_before(kinds, octant), level + 1, from, half / 2, apart);
    }
  }
};

}  // namespace

double distance_to_band(const DistanceOctree& octree, const Vector3& point, double most) noexcept {
  Search search{octree, most * most};
  std::array<std::int64_t, 3> low, high, own;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const double at = point[axis] - octree.origin[axis];
    const auto last = static_cast<double>(octree.roots[axis]) - 1;
    // The cube's number, from -1 to one after the last. Rounded towards 0, which is down from
    // there.
    const auto root = [&](double place) {
      return static_cast<std::int64_t>(std::clamp(place * octree.per_edge + 1, 0.0, last + 2)) - 1;
    };
    low[axis] = std::max<std::int64_t>(0, root(at - most));
    high[axis] = std::min(static_cast<std::int64_t>(last), root(at + most));
    own[axis] = root(at);
  }
  const auto look = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    const std::array<std::int64_t, 3> root{x, y, z};
    std::array<double, 3> from;
    double square = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      from[axis] =
          point[axis] - octree.origin[axis] - octree.edge * (static_cast<double>(root[axis]) + 0.5);
      const double apart = std::max(0.0, std::abs(from[axis]) - octree.edge / 2);
      square += apart * apart;
    }
    const auto place = static_cast<std::size_t>(x + octree.roots[0] * (y + octree.roots[1] * z));
    if (const std::optional<OctreeRoot> cube = root_at(octree, place)) {
      search.take(cube->kind, cube->word, 0, from, octree.edge / 2, square);
    }
  };
  const bool within = own[0] >= low[0] && own[0] <= high[0] && own[1] >= low[1] &&
                      own[1] <= high[1] && own[2] >= low[2] && own[2] <= high[2];
  if (within) look(own[0], own[1], own[2]);
  for (std::int64_t z = low[2]; z <= high[2]; ++z) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      for (std::int64_t x = low[0]; x <= high[0]; ++x) {
        if (x != own[0] || y != own[1] || z != own[2]) look(x, y, z);
      }
    }
  }
  return shortened_bound * std::sqrt(search.best);
}

}  // namespace spm
