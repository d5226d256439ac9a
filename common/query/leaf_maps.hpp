// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "common/field/local_map.hpp"
#include "common/query/query.hpp"

namespace spm {

/// A place in a leaf, in the coordinates of that of its maps which counts there.
struct PlaceOnMap {
  bool on_second = false;
  Vector3 z = Vector3::Zero();  ///< LocalMap
  double value = 0;             ///< over half the edge of the leaf
};

/// The local maps of a leaf of kind `polynomial`, `least` or `most`, unpacked.
struct LeafMaps {
  LocalMap first, second;  ///< the second of `least` and `most` alone
  [[nodiscard]] const LocalMap& of(const PlaceOnMap& on) const noexcept {
    return on.on_second ? second : first;
  }
};

/// False where the words, which are the leaf's, lead to no polynomial or name a plane that is not
/// there.
[[nodiscard]] inline bool unpack_leaf_maps(const AssetView& asset, const Leaf& leaf,
                                           const std::uint32_t* words, LeafMaps& maps) noexcept {
  const double unit = asset.octree.value_unit * leaf.per_half;
  words = polynomials_at(asset.octree, leaf, words);
  if (words == nullptr) return false;
  maps.first = unpack_local_map(words, unit);
  if (maps.first.plane >= asset.planes.size()) return false;
  if (leaf.kind == OctreeKind::polynomial) return true;
  maps.second = unpack_local_map(words + local_map_words, unit);
  return maps.second.plane < asset.planes.size();
}

/// What makes a vector one of length 1, by its square. The slope of a distance is nearly so long,
/// where a short series and one of Newton's steps are right to 1e-13, and faster than a root and a
/// division.
[[nodiscard]] inline double per_length(double square) noexcept {
  const double less = 1 - square;
  if (!(std::abs(less) < 1.0 / 16)) return square > 0 ? 1 / std::sqrt(square) : 0;
  const double near = (1 + less * (1.0 / 2)) +
                      less * less * ((3.0 / 8 + 5.0 / 16 * less) + less * less * (35.0 / 128));
  return near * (1.5 - 0.5 * square * near * near);
}

/// Where a point in a leaf is on its maps.
// Part of its callers, or a single query would write all maps to memory first, one that it does not
// have too.
[[nodiscard, gnu::always_inline]] inline PlaceOnMap place_on_map(const AssetView& asset,
                                                                 const Leaf& leaf,
                                                                 const LeafMaps& maps,
                                                                 const Vector3& point) noexcept {
  const Vector3 offset((point[0] - leaf.middle[0]) * leaf.per_half,
                       (point[1] - leaf.middle[1]) * leaf.per_half,
                       (point[2] - leaf.middle[2]) * leaf.per_half);
  PlaceOnMap on{false, local_coordinates(asset.planes[maps.first.plane], offset)};
  on.value = maps.first.at(on.z);
  if (leaf.kind == OctreeKind::polynomial) return on;
  const Vector3 other_z = local_coordinates(asset.planes[maps.second.plane], offset);
  const double other_value = maps.second.at(other_z);
  if ((other_value < on.value) == (leaf.kind == OctreeKind::least)) {
    on = {true, other_z, other_value};
  }
  return on;
}

/// The direction of the slope there, unit, outward, in the asset's frame.
[[nodiscard, gnu::always_inline]] inline Vector3 normal_on_map(const AssetView& asset,
                                                               const LeafMaps& maps,
                                                               const PlaceOnMap& on) noexcept {
  const LocalMap& map = maps.of(on);
  const Vector3 slope = map.gradient(on.z);
  const SupportPlane& plane = asset.planes[map.plane];
  const auto world = [&](int axis) {
    return slope[0] * plane.u[axis] + slope[1] * plane.v[axis] - slope[2] * plane.n[axis];
  };
  const double along_x = world(0), along_y = world(1), along_z = world(2);
  const double per = per_length(along_x * along_x + along_y * along_y + along_z * along_z);
  return {per * along_x, per * along_y, per * along_z};
}

/// The answer of a leaf's maps at a point in it, before the band's ends are applied.
[[nodiscard, gnu::always_inline]] inline Answer answer_by_maps(const AssetView& asset,
                                                               const Leaf& leaf,
                                                               const LeafMaps& maps,
                                                               const Vector3& point) noexcept {
  const PlaceOnMap on = place_on_map(asset, leaf, maps, point);
  Answer answer;
  answer.distance = leaf.half * on.value;
  answer.normal = normal_on_map(asset, maps, on);
  answer.plane = static_cast<std::int32_t>(maps.of(on).plane);
  answer.source = Source::polynomial;
  answer.status = Status::exact;
  return answer;
}

}  // namespace spm
