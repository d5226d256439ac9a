// SPDX-License-Identifier: Apache-2.0
#include "common/field/side_by_crossings.hpp"

#include <cstddef>

#include "common/field/crossings.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm {

std::optional<bool> side_by_crossings(const IndexedTriangles& mesh, const TriangleList& list,
                                      const Vector3& middle, double half, const Vector3& point,
                                      double away) noexcept {
  if (!list.known || mesh.size() == 0) return std::nullopt;
  const std::size_t first = list.crossed > 0 ? std::size_t{list.solids} + list.sheets : 0;
  const std::size_t count = list.crossed > 0 ? list.crossed : list.solids;
  const auto corners = [&](std::size_t k) {
    const std::uint32_t number = list.triangle(first + k);
    return corners_of(mesh, number < mesh.size() ? number : 0);
  };
  const auto surrounded = [&](const Vector3& there) {
    return is_surrounded(count, corners, *list.known, middle, half, there);
  };
  const std::optional<bool> inside = surrounded(point);
  const double gap = gap_steps * mesh.step;
  if (inside != false || list.crossed == 0 || away < 2 * gap) return inside;
  // Beside a wall that is not felt, with the inside on both its sides, it is in a gap.
  for (std::size_t k = 0; k < count; ++k) {
    const auto [a, b, c] = corners(k);
    const ClosestFeature on = closest_feature(point, a, b, c);
    if ((on.point - point).squaredNorm() > gap * gap || on.normal == Vector3::Zero()) continue;
    const Vector3 beyond = 2 * gap * on.normal.normalized();
    if (surrounded(point + beyond) == true && surrounded(point - beyond) == true) return true;
  }
  return false;
}

}  // namespace spm
