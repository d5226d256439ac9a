// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/full/fallback.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {

namespace {

/// Below this many triangles a closer test would cost more than it saves.
constexpr std::size_t few = 6;
/// Parts of the cube along an axis that are tested one by one.
constexpr int parts = 3;

double distance_to(const Caster& caster, std::uint32_t triangle, const Vector3& point) {
  return (closest_on_triangle(point, caster.corner(triangle, 0), caster.corner(triangle, 1),
                              caster.corner(triangle, 2)) -
          point)
      .norm();
}

}  // namespace

std::vector<std::uint32_t> closest_candidates(const Caster& caster, const Vector3& middle,
                                              double edge, double middle_distance) {
  // A point p of the cube is at most r from the middle m, so its closest triangle T has
  // |T - m| <= |T - p| + r <= |closest(m) - p| + r <= d(m) + 2 r.
  const double radius = edge * std::sqrt(3.0) / 2;
  std::vector<std::uint32_t> all;
  // Of a sheet what is felt is nearer than its middle.
  const double felt = 2 * caster.sheet_thickness();
  caster.within(middle, (std::abs(middle_distance) + 2 * radius + felt) * (1 + 1e-9), all);
  if (all.size() <= few) return all;

  std::vector<bool> needed(all.size(), false);
  std::vector<double> distance(all.size());
  for (int part = 0; part < parts * parts * parts; ++part) {
    const Vector3 place(part % parts, part / parts % parts, part / (parts * parts));
    const Vector3 point =
        middle + edge * ((place + Vector3::Constant(0.5)) / parts - Vector3::Constant(0.5));
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < all.size(); ++i) {
      distance[i] = distance_to(caster, all[i], point);
      nearest = std::min(nearest, distance[i]);
    }
    const double upper_bound = (nearest + 2 * radius / parts + felt) * (1 + 1e-9);
    for (std::size_t i = 0; i < all.size(); ++i)
      needed[i] = needed[i] || distance[i] <= upper_bound;
  }
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (needed[i]) kept.push_back(all[i]);
  }
  return kept;
}

}  // namespace spm::baker
