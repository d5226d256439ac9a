// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/surface/closest_on_triangle.hpp"

namespace spm {

/// What tells the side of a place whose nearest point of the surface lies on a part of a triangle.
enum class FeatureSide : unsigned {
  by_normal = 0,       ///< the triangle's normal, since all around face nearly the same way
  outside = 1,         ///< all such places are outside, as where the surface is convex
  inside = 2,          ///< all such places are inside
  against_normal = 3,  ///< the triangle's normal, which points inwards
};

/// One FeatureSide for the face, each side and each corner of a triangle, two bits each, the face
/// lowest. That of a face is by_normal, but where another triangle lies on it and faces the other
/// way: around a sheet without thickness all is outside, around a gap without width inside.
///
/// Places whose nearest point is one and the same side or corner lie in a convex cone that the
/// surface does not meet, so they are all on one side of it, and a bake can tell which. Only where
/// the surface is nearly flat does the cone shrink to a line, and there normals tell.
using FeatureSides = std::uint16_t;

[[nodiscard]] constexpr FeatureSides pack_side(TriangleFeature feature, FeatureSide side) noexcept {
  return static_cast<FeatureSides>(static_cast<unsigned>(side)
                                   << 2U * static_cast<unsigned>(feature));
}

/// Whether a place is inside. `along` is the component of the way from its nearest point along the
/// triangle's normal.
[[nodiscard]] constexpr bool is_inside(FeatureSides sides, TriangleFeature feature,
                                       double along) noexcept {
  const unsigned side = (unsigned{sides} >> 2U * static_cast<unsigned>(feature)) & 3U;
  switch (static_cast<FeatureSide>(side)) {
    case FeatureSide::by_normal:
      return along < 0;
    case FeatureSide::against_normal:
      return along > 0;
    default:
      return side == static_cast<unsigned>(FeatureSide::inside);
  }
}

}  // namespace spm
