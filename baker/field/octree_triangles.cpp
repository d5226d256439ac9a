// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/octree_triangles.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <span>

#include "baker/base/bake_error.hpp"
#include "common/field/indexed_triangles.hpp"
#include "common/field/triangle_list.hpp"

namespace spm::baker {

namespace {

/// So few are not put in order.
constexpr std::size_t close_together = 4;

Vector3 middle_of(const LatticeTriangle& triangle) {
  return (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3;
}

/// Orders triangles by halving along the longest side of their box again and again.
void order(const LatticeSurface& surface, std::span<std::uint32_t> triangles) {
  if (triangles.size() <= close_together) return;
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const std::uint32_t triangle : triangles) {
    const Vector3 middle = middle_of(surface.any_triangle(triangle));
    low = low.cwiseMin(middle);
    high = high.cwiseMax(middle);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t half = triangles.size() / 2;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half),
                   triangles.end(), [&](std::uint32_t a, std::uint32_t b) {
                     const double x = middle_of(surface.any_triangle(a))[axis];
                     const double y = middle_of(surface.any_triangle(b))[axis];
                     return x != y ? x < y : a < b;
                   });
  order(surface, triangles.first(half));
  order(surface, triangles.subspan(half));
}

void append(std::uint64_t word, std::vector<std::uint32_t>& words) {
  words.push_back(static_cast<std::uint32_t>(word));
  words.push_back(static_cast<std::uint32_t>(word >> 32U));
}

}  // namespace

std::vector<std::uint32_t> write_triangles(const LatticeSurface& surface,
                                           const std::vector<bool>& used, OctreeData& data) {
  std::vector<std::uint32_t> ordered;
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    if (used[i]) ordered.push_back(i);
  }
  order(surface, ordered);
  data.lattice_origin = surface.origin;
  data.lattice_step = surface.step;
  data.sides.resize((ordered.size() + 1) / 2, 0);
  std::vector<std::uint32_t> numbers(used.size(), not_stored);
  std::map<LatticePoint, std::uint32_t> corners;
  for (std::uint32_t number = 0; number < ordered.size(); ++number) {
    const LatticeTriangle& triangle = surface.any_triangle(ordered[number]);
    numbers[ordered[number]] = number;
    std::array<std::uint32_t, 3> of_triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [found, fresh] =
          corners.emplace(triangle.steps[k], static_cast<std::uint32_t>(corners.size()));
      if (fresh) append(pack_three(triangle.steps[k]), data.corners);
      of_triangle[k] = found->second;
    }
    append(pack_three(of_triangle, triangle.thin), data.triangles);
    data.sides[number / 2] |= pack_traits({.sides = triangle.sides,
                                           .crossed = ordered[number] >= surface.triangles.size()})
                              << 16U * (number % 2);
  }
  if (corners.size() > corner_mask || ordered.size() > list_first_mask) {
    throw BakeError(ExitCode::tolerance_not_met,
                    "exact lists take more than 2 million corners or 4 million triangles of the "
                    "mesh; take a coarser tolerance or fewer triangles");
  }
  return numbers;
}

}  // namespace spm::baker
