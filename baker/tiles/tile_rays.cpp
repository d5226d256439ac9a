// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/tiles/tile_rays.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace spm::baker {

namespace {

/// Where the surface turns by more than this between two neighbouring rays, there is a crease
/// between them.
constexpr double crease_cosine = 0.82;  // 35 degrees
/// Surface seen at a flatter angle than this belongs to another plane.
constexpr double min_cosine = 0.4;
/// How far the depth may be off the tangent plane, in steps.
constexpr double leave_steps = 1.0;

}  // namespace

TileRays::TileRays(const Caster& caster, const TileSite& site, const TileSeed& seed)
    : caster_(caster),
      site_(site),
      eta0_(site.column * (site.spacing * tile_stride)),
      omega0_(site.row * (site.spacing * tile_stride)),
      seed_depth_(seed.depth) {
  const auto nearest = [&](double offset) {
    return static_cast<std::uint32_t>(std::clamp(std::lround(offset / site_.spacing * per_cell), 0L,
                                                 static_cast<long>(side) - 1));
  };
  const std::uint32_t i = nearest(seed.eta - eta0_), j = nearest(seed.omega - omega0_);
  // The seed's own triangle gives the first slope.
  const double x = (seed.eta - eta0_) / site_.spacing, y = (seed.omega - omega0_) / site_.spacing;
  const std::optional<TileRay> origin =
      cast(x, y, seed.depth, 1e-3 * site_.spacing + 1e-7 * caster.diagonal());
  if (!origin) return;
  const std::uint32_t start = j * side + i;
  std::vector<std::uint32_t> open;
  visit(start, *origin, x_of(start) - x, y_of(start) - y, open);
  for (std::size_t next = 0; next < open.size(); ++next) {
    const std::uint32_t k = open[next];
    const TileRay from = rays_[k];
    constexpr double step = 1.0 / per_cell;
    if (k % side > 0) visit(k - 1, from, -step, 0, open);
    if (k % side + 1 < side) visit(k + 1, from, step, 0, open);
    if (k / side > 0) visit(k - side, from, 0, -step, open);
    if (k / side + 1 < side) visit(k + side, from, 0, step, open);
  }
}

std::optional<TileRay> TileRays::cast(double x, double y, double depth, double window) const {
  const std::optional<Crossing> crossing =
      caster_.first_between(site_.plane, eta0_ + x * site_.spacing, omega0_ + y * site_.spacing,
                            depth - window, depth + window);
  if (!crossing || !crossing->entry) return std::nullopt;
  return TileRay{true, crossing->depth, &caster_.normal(crossing->triangle)};
}

void TileRays::visit(std::uint32_t k, const TileRay& from, double dx, double dy,
                     std::vector<std::uint32_t>& open) {
  if (rays_[k].hit) return;
  const Vector3& normal = *from.normal;
  const double facing = normal.dot(site_.plane.n);
  const double rise =
      (dx * normal.dot(site_.plane.u) + dy * normal.dot(site_.plane.v)) * site_.spacing / facing;
  const double window = leave_steps * site_.spacing / per_cell;
  const std::optional<TileRay> ray = cast(x_of(k), y_of(k), from.depth + rise, window);
  if (!ray || ray->normal->dot(normal) < crease_cosine ||
      ray->normal->dot(site_.plane.n) < min_cosine) {
    return;
  }
  rays_[k] = *ray;
  ++hits_;
  open.push_back(k);
}

}  // namespace spm::baker
