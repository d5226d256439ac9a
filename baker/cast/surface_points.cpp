// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cast/surface_points.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/random.hpp"

namespace spm::baker {

std::vector<SurfacePoint> surface_points(const Caster& caster, double spacing, double inset,
                                         std::uint64_t seed) {
  std::vector<SurfacePoint> points;
  for (std::uint32_t triangle = 0; triangle < caster.solid_count(); ++triangle) {
    const Vector3& a = caster.corner(triangle, 0);
    const Vector3 ab = caster.corner(triangle, 1) - a;
    const Vector3 ac = caster.corner(triangle, 2) - a;
    // Korobov points of the plastic number are evenly spread over the triangle. The seed shifts
    // them.
    const double count = std::ceil(ab.cross(ac).norm() / 2 / (spacing * spacing));
    double x = random_unit(seed, 2ULL * triangle);
    double y = random_unit(seed, 2ULL * triangle + 1);
    for (double i = 1; i < count; ++i) {
      const bool mirror = x + y > 1;
      points.push_back({a + (mirror ? 1 - x : x) * ab + (mirror ? 1 - y : y) * ac, triangle});
      x = std::fmod(x + 0.7548776662466927, 1.0);
      y = std::fmod(y + 0.5698402909980532, 1.0);
    }
    // The rim as well, or a tip that reaches over a tile's border would belong to no tile.
    const Vector3 middle = a + (ab + ac) / 3;
    const auto drawn_in = [&](const Vector3& point) {
      const Vector3 inwards = middle - point;
      return Vector3(point + std::min(0.1, inset / inwards.norm()) * inwards);
    };
    for (int corner = 0; corner < 3; ++corner) {
      const Vector3& from = caster.corner(triangle, corner);
      const Vector3 along = caster.corner(triangle, (corner + 1) % 3) - from;
      const double steps = std::ceil(along.norm() / spacing);
      for (double step = 0; step < steps; ++step) {
        points.push_back({drawn_in(from + step / steps * along), triangle});
      }
    }
  }
  return points;
}

}  // namespace spm::baker
