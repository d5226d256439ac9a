// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/reachability/reachability.hpp"

#include <algorithm>
#include <cmath>

#include "baker/reachability/reachability_field.hpp"
#include "baker/reachability/sealed_voids.hpp"
#include "common/base/octant.hpp"

namespace spm::baker {

namespace {

/// Cubes below this share of the diagonal are not searched any further.
constexpr double finest_share = 1.0 / 500;

/// Whether some place of the workspace is outside the solid, as far as cubes can show it. Where
/// there is hardly any room outside, the answer is no.
bool opens_into(const Caster& filled, const OrientedBox& workspace, const Vector3& middle,
                double edge) {
  if (!may_touch(workspace, middle, edge)) return false;
  const double around = std::sqrt(3.0) / 2 * edge;
  const double distance = filled.closest(middle).distance;
  if (distance + around < 0 || edge < finest_share * filled.diagonal()) return false;
  if (distance >= 0 && may_touch(workspace, middle, 0)) return true;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    const Vector3 side = octant_direction(octant);
    if (opens_into(filled, workspace, middle + edge / 4 * side, edge / 2)) return true;
  }
  return false;
}

}  // namespace

const char* name_of(PruneRule rule) noexcept {
  switch (rule) {
    case PruneRule::none:
      break;
    case PruneRule::workspace:
      return "workspace";
    case PruneRule::probe:
      return "probe";
    case PruneRule::unreachable:
      return "unreachable";
  }
  return "none";
}

struct Reachability::Implementation {
  const Caster& caster;
  double max_depth;
  double probe_radius;
  std::optional<OrientedBox> workspace;
  std::unique_ptr<Caster> filled;  ///< without sealed voids; null where there are none
  std::unique_ptr<ReachabilityField>
      places;  ///< of the ball; null where it can come to every place that a point can
};

Reachability::Reachability(const Caster& caster, const Band& band, double probe_radius,
                           const std::optional<OrientedBox>& workspace, const Progress& progress)
    : implementation_(new Implementation{caster, band.max_depth, probe_radius, workspace, {}, {}}) {
  Implementation& self = *implementation_;
  if (const std::optional<OuterSurface> filled = without_sealed_voids(caster)) {
    self.filled = std::make_unique<Caster>(*filled);
    const bool starts_outside =
        !workspace ||
        opens_into(*self.filled, *workspace, workspace->middle, 2 * workspace->half.norm());
    if (!starts_outside) self.filled.reset();
  }
  if (!(probe_radius > 0)) return;
  Eigen::AlignedBox3d box;
  for (std::uint32_t triangle = 0; triangle < caster.triangle_count(); ++triangle) {
    for (int corner = 0; corner < 3; ++corner) {
      box.extend(caster.corner(triangle, corner));
    }
  }
  // With voxels as coarse as the ball is wide, the ball could pass through everything.
  const double voxel = ReachabilityField::voxel_size(box.sizes(), probe_radius);
  if (std::sqrt(3.0) / 2 * voxel >= probe_radius) return;
  self.places = std::make_unique<ReachabilityField>(caster, box.min(), box.max(), probe_radius,
                                                    workspace, progress);
}

Reachability::~Reachability() = default;

PruneRule Reachability::cube(const Vector3& middle, double edge) const {
  const Implementation& self = *implementation_;
  if (self.workspace && !may_touch(*self.workspace, middle, edge)) return PruneRule::workspace;
  const double around = std::sqrt(3.0) / 2 * edge;
  if (self.filled && self.filled->closest(middle).distance + around < -self.max_depth) {
    const bool deep = self.caster.closest(middle).distance + around < -self.max_depth;
    return deep ? PruneRule::none : PruneRule::unreachable;
  }
  if (!self.places) return PruneRule::none;
  // Is there, somewhere in the cube, a probe pressed from a free place, or surface that touches a
  // free probe?
  const double radius = self.probe_radius;
  const ReachabilityField& places = *self.places;
  if (places.near(middle, std::max(self.max_depth + around, radius + 2 * around))) {
    return PruneRule::none;
  }
  const double distance = self.caster.closest(middle).distance;
  if (places.near(middle, radius + std::abs(distance) + 2 * around)) return PruneRule::none;
  return distance + around < -self.max_depth ? PruneRule::none : PruneRule::probe;
}

bool Reachability::cuts() const {
  const Implementation& self = *implementation_;
  return self.workspace || self.filled || self.places;
}

bool Reachability::checks(PruneRule rule) const {
  const Implementation& self = *implementation_;
  switch (rule) {
    case PruneRule::workspace:
      return self.workspace.has_value();
    case PruneRule::probe:
      return self.places != nullptr;
    case PruneRule::unreachable:
      return self.filled != nullptr;
    case PruneRule::none:
      break;
  }
  return false;
}

PruneRule Reachability::point(const Vector3& place) const { return cube(place, 0); }

}  // namespace spm::baker
