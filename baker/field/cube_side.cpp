// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/cube_side.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "baker/field/corner_distances.hpp"
#include "common/field/crossings.hpp"
#include "common/field/side_by_crossings.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {

namespace {

/// How far the places of a cube are from triangles.
std::array<double, places_of_cube> distances_of_places(const LatticeSurface& surface,
                                                       const Cube& cube,
                                                       const std::vector<std::uint32_t>& passing) {
  std::array<double, places_of_cube> away;
  away.fill(std::numeric_limits<double>::infinity());
  for (const std::uint32_t triangle : passing) {
    const LatticeTriangle& passed = surface.any_triangle(triangle);
    const auto& corners = passed.corners;
    const CornerValues distances = passed.corner_distances(cube.middle, cube.half);
    for (std::size_t k = 0; k < 8; ++k) {
      away[k] = std::min(away[k], distances[static_cast<Eigen::Index>(k)]);
    }
    const Vector3 closest = closest_on_triangle(cube.middle, corners[0], corners[1], corners[2]);
    away[8] = std::min(away[8], (cube.middle - closest).norm());
  }
  return away;
}

/// Whether the box of a triangle comes within a distance of a cube, m.
bool reaches(const LatticeTriangle& triangle, const Cube& cube, double distance) {
  const auto& [a, b, c] = triangle.corners;
  const Vector3 low = a.cwiseMin(b).cwiseMin(c) - cube.middle;
  const Vector3 high = a.cwiseMax(b).cwiseMax(c) - cube.middle;
  return low.maxCoeff() <= cube.half + distance && -high.minCoeff() <= cube.half + distance;
}

/// Whether places beside some part of a triangle are told by crossings alone.
bool is_doubted(FeatureSides sides) noexcept {
  for (unsigned part = 0; part < 7; ++part) {
    if (unpack_side(sides, static_cast<TriangleFeature>(part)) == FeatureSide::by_crossings) {
      return true;
    }
  }
  return false;
}

}  // namespace

bool any_doubted(const LatticeSurface& surface, std::span<const std::uint32_t> triangles) {
  return std::any_of(triangles.begin(), triangles.end(), [&](std::uint32_t triangle) {
    return is_doubted(surface.triangles[triangle].sides);
  });
}

std::optional<CubeSide> find_cube_side(const LatticeSurface& surface, const Cube& cube,
                                       std::vector<std::uint32_t> solids) {
  // Nearer than that, rounding would decide.
  const double least = std::max(known_place_room * cube.half, 2 * surface.step);
  const Caster* whole = any_doubted(surface, solids) ? surface.caster->whole() : nullptr;
  if (whole != nullptr) {
    // Beside a gap what lies across it is asked as well.
    const double beyond = std::max(least, 3 * gap_steps * surface.step);
    whole->within(cube.middle, cube.radius() + beyond, solids);
    for (std::uint32_t& triangle : solids) {
      triangle += static_cast<std::uint32_t>(surface.triangles.size());
    }
    std::erase_if(solids, [&](std::uint32_t triangle) {
      return !reaches(surface.any_triangle(triangle), cube, beyond);
    });
    if (solids.size() > max_crossed) return std::nullopt;
  }
  std::array<double, places_of_cube> away = distances_of_places(surface, cube, solids);
  for (std::uint32_t tries = 0; tries < places_of_cube; ++tries) {
    const auto farthest = std::max_element(away.begin(), away.end());
    if (*farthest < least) return std::nullopt;
    const double distance = std::exchange(*farthest, 0);
    const auto number = static_cast<std::uint32_t>(farthest - away.begin());
    const Vector3 place = place_of_cube(cube.middle, cube.half, number);
    if (whole == nullptr) {
      return CubeSide{{number, surface.caster->surrounds(place, distance)}, std::move(solids)};
    }
    // Where parts overlap, their surfaces may be passed more than once.
    const int winding = whole->winding(place);
    if (winding <= 1) return CubeSide{{number, winding == 1}, std::move(solids)};
  }
  return std::nullopt;
}

}  // namespace spm::baker
