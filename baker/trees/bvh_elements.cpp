// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trees/bvh_elements.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "baker/tiles/tile_fit.hpp"
#include "baker/trees/bvh_build.hpp"
#include "baker/trees/element_choice.hpp"
#include "baker/trees/triangle_fans.hpp"
#include "common/base/octant.hpp"
#include "common/surface/closest_on_tile.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {

namespace {

/// Every element that might be stored, and its stored form.
struct Elements {
  std::vector<BvhElement> all;
  std::vector<Tile> tiles;
  std::vector<TriangleFan> fans;  ///< as stored
};

void add_fans(const std::vector<std::array<Vector3, 3>>& triangles, bool cap, Elements& elements) {
  for (TriangleFan& fan : fans_of(triangles)) {
    Box box;
    for (const Vector3& corner : fan) box.include(corner);
    elements.all.push_back({.box = box,
                            .number = static_cast<std::uint32_t>(elements.fans.size()),
                            .triangles = static_cast<std::uint32_t>(fan.size() - 2),
                            .cap = cap});
    elements.fans.push_back(std::move(fan));
  }
}

Elements gather(const Caster& caster, const Asset& asset, const FallbackTriangles& form,
                const std::vector<SurfacePiece>& pieces) {
  Elements elements;
  for (const TileData& data : asset.tiles) {
    const Tile tile = view_of(data, asset.metadata.tile_spacing, asset.metadata.height_unit);
    elements.all.push_back({.box = tile_box(asset.planes[tile.plane], tile,
                                            static_cast<float>(asset.metadata.height_unit)),
                            .number = static_cast<std::uint32_t>(elements.tiles.size())});
    elements.tiles.push_back(tile);
  }
  std::vector<std::array<Vector3, 3>> surface, caps;
  for (const SurfacePiece& piece : pieces) {
    if (!form.lost(piece.corners)) surface.push_back(form.stored(piece.corners));
  }
  for (auto i = static_cast<std::uint32_t>(caster.surface_count()); i < caster.triangle_count();
       ++i) {
    const std::array<Vector3, 3> cap{caster.corner(i, 0), caster.corner(i, 1), caster.corner(i, 2)};
    if (!form.lost(cap)) caps.push_back(form.stored(cap));
  }
  add_fans(surface, false, elements);
  add_fans(caps, true, elements);
  return elements;
}

/// Distance of a point to a fan, m.
double distance_to(const TriangleFan& fan, const Vector3& point) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 2; k < fan.size(); ++k) {
    const Vector3 closest_point = closest_on_triangle(point, fan[0], fan[k - 1], fan[k]);
    least = std::min(least, (closest_point - point).norm());
  }
  return least;
}

/// Marks the elements that can be the nearest to some place of the band that is not pruned. Take a
/// cube of half diagonal r around q. An element cannot be nearest there if its distance from q is
/// more than the least one plus 2 r, since both distances change by at most the way gone. Nor can
/// it if its distance is more than the width of the band plus r.
class Marker {
 public:
  Marker(const Caster& caster, const Asset& asset, const Elements& elements, const BuiltBvh& bvh)
      : caster_(caster),
        asset_(asset),
        elements_(elements),
        bvh_(bvh),
        tile_needed_(elements.tiles.size(), false),
        fan_needed_(elements.fans.size(), false) {
    for (std::uint32_t i = 0, corner = 0; i < bvh.fans.size(); ++i) {
      fan_of_corner_.emplace_back(corner, bvh.fans[i]);
      corner += static_cast<std::uint32_t>(elements.fans[bvh.fans[i]].size());
    }
  }

  void mark(const Vector3& middle, double edge) {
    const double distance = caster_.closest(middle).distance;
    const double radius = std::sqrt(3.0) / 2 * edge;
    const double tolerance = *asset_.metadata.tolerance;
    const Band& band = asset_.metadata.band;
    if (distance + radius < -band.max_depth) return;
    if (distance - radius > band.margin + tolerance) return;
    if (edge > finest_share * caster_.diagonal()) {
      for (std::size_t octant = 0; octant < 8; ++octant) {
        mark(middle + edge / 4 * octant_direction(octant), edge / 2);
      }
      return;
    }
    const double widest = std::max(band.max_depth, band.margin);
    mark_within(middle, std::min(std::abs(distance) + 2 * radius, widest + radius) + 3 * tolerance);
  }

  [[nodiscard]] bool needed(const BvhElement& element) const {
    return element.triangles == 0 ? tile_needed_[element.number] : fan_needed_[element.number];
  }

 private:
  /// Largest cubes that are tested, as a share of the diagonal.
  static constexpr double finest_share = 1.0 / 80;

  const Caster& caster_;
  const Asset& asset_;
  const Elements& elements_;
  const BuiltBvh& bvh_;
  std::vector<bool> tile_needed_, fan_needed_;
  /// First corner of each fan in the tree's order, and its number.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> fan_of_corner_;

  void mark_within(const Vector3& middle, double distance) {
    const auto visit = [&](const BvhChild& child) {
      if (child.kind == ElementKind::tile) {
        const std::uint32_t which = bvh_.tiles[child.first];
        const Tile& tile = elements_.tiles[which];
        const SupportPlane& plane = asset_.planes[tile.plane];
        if (static_cast<double>(tile_distance_bound(tile, plane, middle)) <= distance) {
          tile_needed_[which] = true;
        }
        return;
      }
      const auto at = std::lower_bound(fan_of_corner_.begin(), fan_of_corner_.end(),
                                       std::pair(child.first, std::uint32_t{0}));
      const std::uint32_t which = at->second;
      if (distance_to(elements_.fans[which], middle) <= distance) fan_needed_[which] = true;
    };
    visit_elements({bvh_.data.origin, bvh_.data.size, bvh_.data.words}, middle, visit,
                   [distance] { return distance; });
  }
};

std::vector<bool> mark_needed(const Caster& caster, const Asset& asset, const Elements& elements,
                              const BuiltBvh& bvh, const SignOctreeBuilder& sign_octree) {
  Marker marker(caster, asset, elements, bvh);
  sign_octree.visit_leaves([&](const SignOctreeNode& leaf) {
    if (leaf.kind == SignKind::pruned || leaf.kind == SignKind::far) return;
    marker.mark(leaf.middle, leaf.edge);
  });
  std::vector<bool> needed;
  for (const BvhElement& element : elements.all) needed.push_back(marker.needed(element));
  return needed;
}

/// Adds up the bytes of the elements that are left out, by the rule that prunes their middle.
std::vector<Pruned> add_up(const Asset& asset, const Elements& elements,
                           const std::vector<bool>& needed, const Reachability& reachability) {
  std::array<std::uint64_t, 4> bytes{};
  for (std::size_t i = 0; i < needed.size(); ++i) {
    if (needed[i]) continue;
    const BvhElement& element = elements.all[i];
    auto rule =
        static_cast<std::size_t>(reachability.point((element.box.low + element.box.high) / 2));
    if (rule == 0) rule = static_cast<std::size_t>(reachability.likeliest());
    bytes[rule] += element.triangles == 0 ? tile_bytes(asset.tiles[element.number])
                                          : element.triangles * triangle_bytes;
  }
  std::vector<Pruned> pruned;
  for (const PruneRule rule : {PruneRule::workspace, PruneRule::probe, PruneRule::unreachable}) {
    const std::uint64_t sum = bytes[static_cast<std::size_t>(rule)];
    if (sum > 0 || reachability.checks(rule)) pruned.push_back({name_of(rule), sum});
  }
  return pruned;
}

}  // namespace

BvhElements::BvhElements(const Caster& caster, const std::vector<SurfacePiece>& triangles,
                         double tolerance)
    : caster_(caster), triangles_(triangles), form_(caster, tolerance) {}

std::vector<Pruned> BvhElements::build(Asset& asset, const SignOctreeBuilder& sign_octree,
                                       const Reachability* reachability) const {
  const Elements elements = gather(caster_, asset, form_, triangles_);
  BuiltBvh bvh = build_bvh(elements.all);
  std::vector<Pruned> pruned;
  if (reachability != nullptr) {
    const std::vector<bool> needed = mark_needed(caster_, asset, elements, bvh, sign_octree);
    pruned = add_up(asset, elements, needed, *reachability);
    std::vector<BvhElement> kept;
    for (std::size_t i = 0; i < needed.size(); ++i) {
      if (needed[i]) kept.push_back(elements.all[i]);
    }
    if (kept.size() < needed.size()) bvh = build_bvh(kept);
  }
  std::vector<TileData> tiles;
  for (const std::uint32_t which : bvh.tiles) tiles.push_back(asset.tiles[which]);
  asset.tiles = std::move(tiles);
  form_.describe(asset);
  for (const std::uint32_t which : bvh.fans) form_.append(elements.fans[which], asset);
  asset.first_cap = bvh.first_cap;
  asset.bvh = std::move(bvh.data);
  return pruned;
}

}  // namespace spm::baker
