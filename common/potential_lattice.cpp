// SPDX-License-Identifier: Apache-2.0
#include "common/potential_lattice.hpp"

#include <cmath>

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

/// Trilinear, at shares of a cube of this edge (m), by its corners, x fastest.
Interpolated interpolated(const std::array<double, 8>& corners, const Vector3& share,
                          double edge) noexcept {
  const auto between = [](double low, double high, double at) { return low + at * (high - low); };
  const auto along_x = [&](std::size_t row) {
    return between(corners[2 * row], corners[2 * row + 1], share.x());
  };
  const auto step_x = [&](std::size_t row) { return corners[2 * row + 1] - corners[2 * row]; };
  const std::array rows{along_x(0), along_x(1), along_x(2), along_x(3)};
  const double low = between(rows[0], rows[1], share.y());
  const double high = between(rows[2], rows[3], share.y());
  Interpolated result;
  result.distance = between(low, high, share.z());
  result.slope.x() = between(between(step_x(0), step_x(1), share.y()),
                             between(step_x(2), step_x(3), share.y()), share.z());
  result.slope.y() = between(rows[1] - rows[0], rows[3] - rows[2], share.z());
  result.slope.z() = high - low;
  result.slope /= edge;
  return result;
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
  std::array<double, 8> corners{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Place place{static_cast<std::int32_t>(low.x()) + static_cast<std::int32_t>(i & 1U),
                      static_cast<std::int32_t>(low.y()) + static_cast<std::int32_t>(i >> 1U & 1U),
                      static_cast<std::int32_t>(low.z()) + static_cast<std::int32_t>(i >> 2U)};
    corners[i] = distance_at(asset, smoothing, place);
    if (std::isnan(corners[i])) return std::nullopt;
  }
  const auto [distance, slope] = interpolated(corners, at - low, spacing_);
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
