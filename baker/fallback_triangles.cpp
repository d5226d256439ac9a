// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fallback_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spm::baker {

namespace {

/// Share of the tolerance that the rounding of triangles may take.
constexpr double rounding_share = 0.1;
/// Triangles flatter than so many steps lose their direction in the rounding.
constexpr double least_steps = 1;

}  // namespace

double FallbackTriangles::rounding(double tolerance) { return rounding_share * tolerance; }

FallbackTriangles::FallbackTriangles(const Caster& caster, const std::vector<SurfacePiece>& pieces,
                                     double tolerance) {
  const auto total = static_cast<std::uint32_t>(caster.triangle_count());
  pieces_ = static_cast<std::uint32_t>(pieces.size());
  first_cap_ = pieces_ + static_cast<std::uint32_t>(caster.surface_count());
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (std::uint32_t i = 0; i < total; ++i) {
    for (int k = 0; k < 3; ++k) {
      low = low.cwiseMin(caster.corner(i, k));
      high = high.cwiseMax(caster.corner(i, k));
    }
  }
  const double step = (high - low).maxCoeff() / 65535;
  if (least_steps * step <= rounding(tolerance)) {
    origin_ = low;
    step_ = step;
  }
  for (const SurfacePiece& piece : pieces) add(piece.corners);
  for (std::uint32_t i = 0; i < total; ++i) {
    add({caster.corner(i, 0), caster.corner(i, 1), caster.corner(i, 2)});
  }
}

void FallbackTriangles::add(const std::array<Vector3, 3>& corners) {
  for (const Vector3& corner : corners) {
    for (int axis = 0; axis < 3; ++axis) {
      if (step_ > 0) {
        const double steps = (corner[axis] - origin_[axis]) / step_;
        small_.push_back(static_cast<std::uint16_t>(std::lround(std::clamp(steps, 0.0, 65535.0))));
      } else {
        large_.push_back(static_cast<float>(corner[axis]));
      }
    }
  }
}

std::array<Vector3, 3> FallbackTriangles::corners(std::uint32_t number) const {
  std::array<Vector3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t first = 9 * std::size_t{number} + 3 * k;
    if (step_ > 0) {
      corners[k] = origin_ + step_ * Vector3(small_[first], small_[first + 1], small_[first + 2]);
    } else {
      corners[k] = Vector3(static_cast<double>(large_[first]), static_cast<double>(large_[first + 1]),
                           static_cast<double>(large_[first + 2]));
    }
  }
  return corners;
}

bool FallbackTriangles::lost(std::uint32_t number) const {
  const auto [a, b, c] = corners(number);
  const double twice_area = (b - a).cross(c - a).norm();
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return !(twice_area > least_steps * step_ * longest);
}

void FallbackTriangles::show(AssetView& view) const {
  view.triangles = large_;
  view.small_triangles = small_;
  view.triangle_origin = origin_;
  view.triangle_step = step_;
}

void FallbackTriangles::append(std::uint32_t number, Asset& asset) const {
  const auto first = static_cast<std::ptrdiff_t>(9 * std::size_t{number});
  if (step_ > 0) {
    asset.small_triangles.insert(asset.small_triangles.end(), small_.begin() + first,
                                 small_.begin() + first + 9);
  } else {
    asset.triangles.insert(asset.triangles.end(), large_.begin() + first,
                           large_.begin() + first + 9);
  }
}

void FallbackTriangles::describe(Asset& asset) const {
  asset.triangle_origin = origin_;
  asset.triangle_step = step_;
}

}  // namespace spm::baker
