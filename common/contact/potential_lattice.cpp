// SPDX-License-Identifier: Apache-2.0
#include "common/contact/potential_lattice.hpp"

#include <cmath>
#include <utility>

namespace spm {

namespace {

/// There is no lattice farther from the origin than this, in spacings.
constexpr double lattice_end = 1e9;

/// The axes ordered by their coordinate within a cube, the largest first.
std::array<int, 3> by_share(const Vector3& share) noexcept {
  std::array<int, 3> axes{0, 1, 2};
  if (share[axes[0]] < share[axes[1]]) std::swap(axes[0], axes[1]);
  if (share[axes[1]] < share[axes[2]]) std::swap(axes[1], axes[2]);
  if (share[axes[0]] < share[axes[1]]) std::swap(axes[0], axes[1]);
  return axes;
}

}  // namespace

PotentialLattice::FieldValue PotentialLattice::field_at(const AssetView& asset,
                                                        const RuntimeSmoothing& smoothing,
                                                        const Vector3& point) noexcept {
  if (smoothing.sigma > 0) {
    const SmoothedAnswer answer = smoothed_query(asset, smoothing, point);
    if (!answer.known || answer.deep) return {};
    return {answer.distance, answer.gradient};
  }
  const Answer answer = query_point(asset, point);
  if (answer.status != Status::exact) return {};
  return {answer.distance, answer.normal};
}

const PotentialLattice::FieldValue& PotentialLattice::corner_at(const AssetView& asset,
                                                                const RuntimeSmoothing& smoothing,
                                                                const Place& place) noexcept {
  // Neighbouring corners never share a place in memory.
  std::size_t where = 0;
  for (const std::int32_t number : place) {
    where = where * kept + static_cast<std::size_t>(number & (kept - 1));
  }
  Corner& corner = corners_[where];
  if (!corner.is_asked || corner.place != place) {
    const Vector3 point = spacing_ * Vector3(place[0], place[1], place[2]);
    corner = {place, true, field_at(asset, smoothing, point)};
  }
  return corner.value;
}

PotentialLattice::FieldValue PotentialLattice::interpolated(const AssetView& asset,
                                                            const RuntimeSmoothing& smoothing,
                                                            const Vector3& at) noexcept {
  const Vector3 low = at.array().floor();
  const Vector3 share = at - low;
  Place place{static_cast<std::int32_t>(low.x()), static_cast<std::int32_t>(low.y()),
              static_cast<std::int32_t>(low.z())};
  // Walks along the cube's edges to its far corner, the largest coordinate first. This gives the
  // tetrahedron around the point.
  const std::array<int, 3> axes = by_share(share);
  std::array<const FieldValue*, 4> corners{&corner_at(asset, smoothing, place)};
  for (std::size_t i = 0; i < 3; ++i) {
    ++place[static_cast<std::size_t>(axes[i])];
    corners[i + 1] = &corner_at(asset, smoothing, place);
  }
  const std::array<double, 4> weights{1 - share[axes[0]], share[axes[0]] - share[axes[1]],
                                      share[axes[1]] - share[axes[2]], share[axes[2]]};
  FieldValue found;
  found.distance = 0;
  std::array<double, 4> by_weight{};  // how the distance changes with each weight
  for (std::size_t i = 0; i < 4; ++i) {
    found.distance += weights[i] * corners[i]->distance;
    by_weight[i] += corners[i]->distance;
    Vector3 edge = Vector3::Zero();
    for (std::size_t j = i + 1; j < 4; ++j) {
      edge[axes[j - 1]] = spacing_;
      // A parabola along the edge. Its curvature is the difference of the slopes at its ends.
      const double bend = (corners[i]->gradient - corners[j]->gradient).dot(edge) / 2;
      found.distance += weights[i] * weights[j] * bend;
      by_weight[i] += weights[j] * bend;
      by_weight[j] += weights[i] * bend;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    found.gradient[axes[i]] = (by_weight[i + 1] - by_weight[i]) / spacing_;
  }
  return found;
}

std::optional<ContactForce> PotentialLattice::force(const AssetView& asset,
                                                    const ForceSettings& settings,
                                                    const RuntimeSmoothing& smoothing,
                                                    const Vector3& point) noexcept {
  const Vector3 at = point / spacing_;
  // Written so that NaN is outside.
  if (!(at.cwiseAbs().maxCoeff() < lattice_end) || !at.allFinite()) return std::nullopt;
  const auto [distance, slope] = interpolated(asset, smoothing, at);
  if (!std::isfinite(distance) || !slope.allFinite()) return std::nullopt;
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
