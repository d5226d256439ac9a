// SPDX-License-Identifier: Apache-2.0
#include "common/contact/nearest_in_planes.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace spm {

namespace {

/// Planes whose normals span less than this are treated as parallel.
constexpr double min_span = 1e-6;
/// How far outside a half-space a point may be and still count as inside, m: rounding.
constexpr double rounding = 1e-12;

double how_far_out(const HalfSpaces& spaces, const Vector3& place) noexcept {
  double most = 0;
  for (std::size_t i = 0; i < spaces.count; ++i) {
    most = std::max(most, spaces.planes[i].normal.dot(place) - spaces.planes[i].offset);
  }
  return most;
}

/// The point common to the planes of a subset that is nearest to `point`; false where they have
/// none.
bool closest_point_on(const HalfSpaces& spaces, unsigned subset, const Vector3& point,
                      Vector3& closest_point) noexcept {
  std::array<std::size_t, 3> members{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < spaces.count; ++i) {
    if (((subset >> i) & 1U) != 0) members[count++] = i;
  }
  // Weights of the normals, from their products. The unused rows are those of the unit matrix.
  Eigen::Matrix3d products = Eigen::Matrix3d::Identity();
  Vector3 beyond = Vector3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const HalfSpace& plane = spaces.planes[members[i]];
    beyond[static_cast<int>(i)] = plane.normal.dot(point) - plane.offset;
    for (std::size_t j = 0; j < count; ++j) {
      products(static_cast<int>(i), static_cast<int>(j)) =
          plane.normal.dot(spaces.planes[members[j]].normal);
    }
  }
  const double determinant = products.determinant();
  if (!(determinant > min_span)) return false;
  const Vector3 weights = products.inverse() * beyond;
  closest_point = point;
  for (std::size_t i = 0; i < count; ++i) {
    closest_point -= weights[static_cast<int>(i)] * spaces.planes[members[i]].normal;
  }
  return true;
}

}  // namespace

Vector3 nearest_in_planes(const HalfSpaces& spaces, const Vector3& point) noexcept {
  if (how_far_out(spaces, point) <= rounding) return point;
  Vector3 best = point, min_out = point;
  double nearest = std::numeric_limits<double>::infinity();
  double least = std::numeric_limits<double>::infinity();
  for (unsigned subset = 1; subset < (1U << spaces.count); ++subset) {
    Vector3 closest_point;
    if (!closest_point_on(spaces, subset, point, closest_point)) continue;
    const double out = how_far_out(spaces, closest_point);
    const double square = (closest_point - point).squaredNorm();
    if (out <= rounding + 1e-9 * std::sqrt(square) && square < nearest) {
      nearest = square;
      best = closest_point;
    }
    if (out < least) {
      least = out;
      min_out = closest_point;
    }
  }
  return std::isfinite(nearest) ? best : min_out;
}

}  // namespace spm
