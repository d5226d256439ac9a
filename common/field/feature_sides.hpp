// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/base/vector.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm {

/// What tells the side of a place whose nearest point of the surface lies on a part of a triangle.
enum class FeatureSide : unsigned {
  by_normal = 0,     ///< the triangle's normal, since all around face nearly the same way
  outside = 1,       ///< all such places are outside, as where the surface is convex
  inside = 2,        ///< all such places are inside
  by_crossings = 3,  ///< nothing but the surface's crossings by a way from a place of known side
};

/// One FeatureSide for the face, each side and each corner of a triangle, two bits each, the face
/// lowest. That of a face is by_normal, but where another triangle lies on it and faces the other
/// way: around a sheet without thickness all is outside, around a gap without width inside.
///
/// Places whose nearest point is one and the same side or corner lie in a convex cone that the
/// surface does not meet, so they are all on one side of it, and a bake can tell which. Only where
/// the surface is nearly flat does the cone shrink to a line, and there normals tell. Where parts
/// of the surface lie closer to each other than its rounding, only crossings do
/// (side_by_crossings).
using FeatureSides = std::uint16_t;

[[nodiscard]] constexpr FeatureSides pack_side(TriangleFeature feature, FeatureSide side) noexcept {
  return static_cast<FeatureSides>(static_cast<unsigned>(side)
                                   << 2U * static_cast<unsigned>(feature));
}

[[nodiscard]] constexpr FeatureSide unpack_side(FeatureSides sides,
                                                TriangleFeature feature) noexcept {
  return static_cast<FeatureSide>(unsigned{sides} >> 2U * static_cast<unsigned>(feature) & 3U);
}

/// The ways from a flat part to the places that are nearest to it are no farther from a normal than
/// that has this cosine: squared, with room for single precision.
inline constexpr double least_along_square = 0.01;

/// The component of a way along a normal of any length; 0 where the way is too slanted to tell a
/// side.
[[nodiscard]] inline double along_normal(const Vector3& normal, const Vector3& way) noexcept {
  const double along = normal.dot(way);
  const double least = least_along_square * normal.squaredNorm() * way.squaredNorm();
  return along * along < least ? 0 : along;
}

/// Whether a place is inside; nothing where only crossings tell. `along` is the way from its
/// nearest point along the triangle's normal (along_normal).
[[nodiscard]] constexpr std::optional<bool> side_told(FeatureSides sides, TriangleFeature feature,
                                                      double along) noexcept {
  const FeatureSide side = unpack_side(sides, feature);
  switch (side) {
    case FeatureSide::by_normal:
      return along == 0 ? std::nullopt : std::optional(along < 0);
    case FeatureSide::by_crossings:
      return std::nullopt;
    default:
      return side == FeatureSide::inside;
  }
}

/// Closer to an end of a side than this part of the way to the place (squared), single precision
/// may take the side for what is nearest where its end is, or another part of the surface there.
inline constexpr double least_from_end_square = 4e-4;

/// The same where the closest point, at `closest`, may lie near an end of a side: nothing where the
/// corner there tells another side. `away_square` is the square of the way to the place.
[[nodiscard]] inline std::optional<bool> side_told(FeatureSides sides, TriangleFeature feature,
                                                   double along,
                                                   const std::array<Vector3, 3>& corners,
                                                   const Vector3& closest,
                                                   double away_square) noexcept {
  const std::optional<bool> told = side_told(sides, feature, along);
  if (!is_side(feature)) return told;
  const std::size_t first = static_cast<std::size_t>(feature) - 1;
  for (const std::size_t corner : {first, (first + 1) % 3}) {
    const auto end = static_cast<TriangleFeature>(4 + corner);
    if (side_told(sides, end, along) == told) continue;
    if ((closest - corners[corner]).squaredNorm() < least_from_end_square * away_square) return {};
  }
  return told;
}

}  // namespace spm
