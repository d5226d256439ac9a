// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/structure_picture.hpp"

#include <optional>

#include "common/field/triangle_list.hpp"
#include "common/query/query.hpp"
#include "common/surface/support_plane_mapping.hpp"

namespace spm::baker {

namespace {

/// The share of light that the border of a leaf keeps.
constexpr double border_light = 0.55;

std::optional<Colour> colour_in_octree(const DistanceOctree& octree, const Leaf& leaf) {
  namespace colours = structure_colours;
  switch (leaf.kind) {
    case OctreeKind::map: {
      const std::uint32_t* words = words_at(octree, leaf);
      if (words == nullptr) return std::nullopt;
      return NamedMaps(words[0]).two() ? colours::two_maps : colours::one_map;
    }
    case OctreeKind::list: {
      const std::uint32_t* words = words_at(octree, leaf);
      if (words == nullptr) return std::nullopt;
      return list_of(octree, words).size() > packet_size ? colours::long_list : colours::list;
    }
    case OctreeKind::deep:
      return colours::deep;
    case OctreeKind::pruned:
      return colours::pruned;
    default:
      return std::nullopt;
  }
}

std::optional<Colour> colour_in_full(const AssetView& asset, const Vector3& place) {
  namespace colours = structure_colours;
  const Answer answer = query_point(asset, place);
  if (answer.status == Status::deep) return colours::deep;
  if (answer.status == Status::pruned) return colours::pruned;
  if (answer.source == Source::none) return std::nullopt;
  return answer.source == Source::triangles ? colours::list : colours::one_map;
}

std::optional<Colour> structure_colour(const AssetView& asset, const Vector3& place) {
  if (asset.full) return colour_in_full(asset, place);
  return colour_in_octree(asset.octree, leaf_at(asset.octree, place));
}

bool same_leaf(const AssetView& asset, const Vector3& one, const Vector3& other) {
  if (asset.full) return true;
  const Leaf a = leaf_at(asset.octree, one);
  const Leaf b = leaf_at(asset.octree, other);
  return a.level == b.level && a.middle == b.middle;
}

}  // namespace

Picture structure_on_surface(const Caster& surface, const AssetView& asset, const Window& window,
                             std::uint32_t side) {
  return coloured_surface(surface, window, side, [&asset](const Vector3& place, const Vector3&) {
    return structure_colour(asset, place);
  });
}

Picture structure_in_section(const ExactSurface& exact, const AssetView& asset,
                             const Window& window, std::uint32_t side) {
  const SupportPlane plane = plane_with_normal(window.middle, window.toward);
  const double pixel = window.edge / side;
  return coloured_section(exact, window, side, [&](const Vector3& place) {
    std::optional<Colour> colour = structure_colour(asset, place);
    const bool border = !same_leaf(asset, place, place + pixel * plane.u) ||
                        !same_leaf(asset, place, place + pixel * plane.v);
    if (colour && border) {
      for (double& part : *colour) part *= border_light;
    }
    return colour;
  });
}

}  // namespace spm::baker
