// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trees/fallback_triangles.hpp"

#include <algorithm>
#include <cmath>

#include "baker/proof/tile_bins.hpp"

namespace spm::baker {

namespace {

/// Share of the tolerance that the rounding of triangles may take.
constexpr double rounding_share = 0.1;
/// Triangles flatter than this many steps lose their direction in the rounding.
constexpr double min_steps = 1;

}  // namespace

double FallbackTriangles::rounding(double tolerance) { return rounding_share * tolerance; }

FallbackTriangles::FallbackTriangles(const Caster& caster, double tolerance) {
  Box box;
  for (std::uint32_t i = 0; i < caster.triangle_count(); ++i) {
    for (int k = 0; k < 3; ++k) box.include(caster.corner(i, k));
  }
  const double step = (box.high - box.low).maxCoeff() / 65535;
  if (min_steps * step <= rounding(tolerance)) {
    origin_ = box.low;
    step_ = step;
  }
}

std::uint16_t FallbackTriangles::steps(const Vector3& corner, int axis) const {
  const double place = (corner[axis] - origin_[axis]) / step_;
  return static_cast<std::uint16_t>(std::lround(std::clamp(place, 0.0, 65535.0)));
}

std::array<Vector3, 3> FallbackTriangles::stored(const std::array<Vector3, 3>& corners) const {
  std::array<Vector3, 3> result;
  for (std::size_t k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      result[k][axis] = step_ > 0 ? origin_[axis] + step_ * steps(corners[k], axis)
                                  : static_cast<double>(static_cast<float>(corners[k][axis]));
    }
  }
  return result;
}

bool FallbackTriangles::lost(const std::array<Vector3, 3>& corners) const {
  const auto [a, b, c] = stored(corners);
  const double twice_area = (b - a).cross(c - a).norm();
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return !(twice_area > min_steps * step_ * longest);
}

void FallbackTriangles::describe(Asset& asset) const {
  asset.triangle_origin = origin_;
  asset.triangle_step = step_;
}

void FallbackTriangles::append(const TriangleFan& fan, Asset& asset) const {
  for (const Vector3& corner : fan) {
    for (int axis = 0; axis < 3; ++axis) {
      if (step_ > 0) {
        asset.small_triangles.push_back(steps(corner, axis));
      } else {
        asset.triangles.push_back(static_cast<float>(corner[axis]));
      }
    }
  }
}

}  // namespace spm::baker
