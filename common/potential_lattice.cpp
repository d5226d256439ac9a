// SPDX-License-Identifier: Apache-2.0
#include "common/potential_lattice.hpp"

#include <cmath>
#include <utility>

namespace spm {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
/// Farther from the origin, in spacings, there is no lattice.
constexpr double lattice_end = 1e9;

/// Signed distance at a place of the band, m; no number elsewhere.
double field_distance(const AssetView& asset, const RuntimeSmoothing& smoothing,
                      const Vector3& point) noexcept {
  if (smoothing.sigma > 0) {
    const SmoothedAnswer answer = smoothed_query(asset, smoothing, point);
    return answer.known && !answer.deep ? answer.distance : nothing;
  }
  const Answer answer = query_point(asset, point);
  return answer.status == Status::exact ? answer.distance : nothing;
}

struct Interpolated {
  double distance = 0;  ///< m
  Vector3 slope = Vector3::Zero();
};

/// The axes by their share of a cube, the largest first.
std::array<int, 3> by_share(const Vector3& share) noexcept {
  std::array<int, 3> axes{0, 1, 2};
  if (share[axes[0]] < share[axes[1]]) std::swap(axes[0], axes[1]);
  if (share[axes[1]] < share[axes[2]]) std::swap(axes[1], axes[2]);
  if (share[axes[0]] < share[axes[1]]) std::swap(axes[0], axes[1]);
  return axes;
}

}  // namespace

double PotentialLattice::distance_at(const AssetView& asset, const RuntimeSmoothing& smoothing,
                                     const Place& place) noexcept {
  // Neighbours never share a place in memory.
  std::size_t where = 0;
  for (const std::int32_t number : place) {
    where = where * kept + static_cast<std::size_t>(number & (kept - 1));
  }
  Corner& corner = corners_[where];
  if (!corner.is_asked || corner.place != place) {
    const Vector3 point = spacing_ * Vector3(place[0], place[1], place[2]);
    corner = {place, true, field_distance(asset, smoothing, point)};
  }
  return corner.distance;
}

std::optional<ContactForce> PotentialLattice::force(const AssetView& asset,
                                                    const ForceSettings& settings,
                                                    const RuntimeSmoothing& smoothing,
                                                    const Vector3& point) noexcept {
  const Vector3 at = point / spacing_;
  // Written so that what is no number is nowhere.
  if (!(at.cwiseAbs().maxCoeff() < lattice_end) || !at.allFinite()) return std::nullopt;
  const Vector3 low = at.array().floor();
  const Vector3 share = at - low;
  Place place{static_cast<std::int32_t>(low.x()), static_cast<std::int32_t>(low.y()),
              static_cast<std::int32_t>(low.z())};
  Interpolated found;
  double last = found.distance = distance_at(asset, smoothing, place);
  // Along the cube's edges to its far corner, the largest share first: the tetrahedron about it.
  for (const int axis : by_share(share)) {
    ++place[static_cast<std::size_t>(axis)];
    const double next = distance_at(asset, smoothing, place);
    found.distance += share[axis] * (next - last);
    found.slope[axis] = (next - last) / spacing_;
    last = next;
  }
  if (!std::isfinite(found.distance) || !found.slope.allFinite()) return std::nullopt;
  const auto [distance, slope] = found;
  const double steepness = slope.norm();
  ContactForce result;
  if (!(distance < settings.probe_radius) || !(steepness > 0)) return result;
  result.depth = (settings.probe_radius - distance) * steepness;
  result.normal = slope / steepness;
  result.force = settings.stiffness * result.depth * result.normal;
  result.contact = true;
  return result;
}

}  // namespace spm
