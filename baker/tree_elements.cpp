// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/tree_elements.hpp"

#include <algorithm>
#include <cmath>

#include "baker/element_choice.hpp"
#include "baker/octant.hpp"
#include "baker/tile_fit.hpp"
#include "baker/tree_build.hpp"
#include "common/closest_on_triangle.hpp"

namespace spm::baker {

namespace {

/// Every element that might be stored, and how it is stored.
struct Elements {
  std::vector<TreeElement> all;
  std::vector<Tile> tiles;
  std::vector<std::array<Vector3, 3>> triangles;  ///< as stored
};

Elements gather(const Caster& caster, const Asset& asset, const FallbackTriangles& form,
                const std::vector<SurfacePiece>& pieces) {
  Elements elements;
  for (const TileData& data : asset.tiles) {
    const Tile tile = view_of(data, asset.metadata.tile_spacing, asset.metadata.height_unit);
    elements.all.push_back({.box = tile_box(asset.planes[tile.plane], tile,
                                            static_cast<float>(asset.metadata.height_unit)),
                            .number = static_cast<std::uint32_t>(elements.tiles.size()),
                            .tile = true});
    elements.tiles.push_back(tile);
  }
  const auto add = [&](const std::array<Vector3, 3>& corners, bool cap) {
    if (form.lost(corners)) return;
    const std::array<Vector3, 3> stored = form.stored(corners);
    Box box;
    for (const Vector3& corner : stored) box.include(corner);
    elements.all.push_back({.box = box,
                            .number = static_cast<std::uint32_t>(elements.triangles.size()),
                            .tile = false,
                            .cap = cap});
    elements.triangles.push_back(stored);
  };
  for (const SurfacePiece& piece : pieces) add(piece.corners, false);
  for (auto i = static_cast<std::uint32_t>(caster.surface_count()); i < caster.triangle_count();
       ++i) {
    add({caster.corner(i, 0), caster.corner(i, 1), caster.corner(i, 2)}, true);
  }
  return elements;
}

/// Marks the elements that can be the nearest to some place of the band that is not pruned: in a
/// cube of half diagonal r around q an element cannot if its distance from q is more than the least
/// plus 2 r, since both change by at most the way; nor if it is more than the band is wide plus r.
class Marker {
 public:
  Marker(const Caster& caster, const Asset& asset, const Elements& elements, const BuiltTree& tree)
      : caster_(caster),
        asset_(asset),
        elements_(elements),
        tree_(tree),
        tile_needed_(elements.tiles.size(), false),
        triangle_needed_(elements.triangles.size(), false) {}

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

  [[nodiscard]] bool needed(const TreeElement& element) const {
    return element.tile ? tile_needed_[element.number] : triangle_needed_[element.number];
  }

 private:
  /// Cubes that are looked at are no larger, of the diagonal.
  static constexpr double finest_share = 1.0 / 80;

  const Caster& caster_;
  const Asset& asset_;
  const Elements& elements_;
  const BuiltTree& tree_;
  std::vector<bool> tile_needed_, triangle_needed_;

  void mark_within(const Vector3& middle, double reach) {
    const auto visit = [&](const TreeChild& child) {
      if (child.kind == ElementKind::tile) {
        const std::uint32_t which = tree_.tiles[child.first];
        const Tile& tile = elements_.tiles[which];
        const SupportPlane& plane = asset_.planes[tile.plane];
        if (static_cast<double>(tile_distance_bound(tile, plane, middle)) <= reach) {
          tile_needed_[which] = true;
        }
        return;
      }
      for (std::uint32_t k = 0; k < child.count; ++k) {
        const std::uint32_t which = tree_.triangles[child.first + k];
        const auto& [a, b, c] = elements_.triangles[which];
        if ((closest_on_triangle(middle, a, b, c) - middle).norm() <= reach) {
          triangle_needed_[which] = true;
        }
      }
    };
    visit_elements({tree_.data.origin, tree_.data.size, tree_.data.words}, middle, visit,
                   [reach] { return reach; });
  }
};

std::vector<bool> mark_needed(const Caster& caster, const Asset& asset, const Elements& elements,
                              const BuiltTree& tree, const SpaceBuilder& space) {
  Marker marker(caster, asset, elements, tree);
  space.visit_leaves([&](const SpaceNode& leaf) {
    if (leaf.kind == SpaceKind::pruned || leaf.kind == SpaceKind::far) return;
    marker.mark(leaf.middle, leaf.edge);
  });
  std::vector<bool> needed;
  for (const TreeElement& element : elements.all) needed.push_back(marker.needed(element));
  return needed;
}

/// Adds up what elements that are left out would have taken, by the rule that cuts their middle.
std::vector<Pruned> add_up(const Asset& asset, const Elements& elements,
                           const std::vector<bool>& needed, const Reach& reach) {
  std::array<std::uint64_t, 4> bytes{};
  for (std::size_t i = 0; i < needed.size(); ++i) {
    if (needed[i]) continue;
    const TreeElement& element = elements.all[i];
    auto rule = static_cast<std::size_t>(reach.point((element.box.low + element.box.high) / 2));
    if (rule == 0) rule = static_cast<std::size_t>(reach.likeliest());
    bytes[rule] += element.tile ? tile_bytes(asset.tiles[element.number]) : triangle_bytes;
  }
  std::vector<Pruned> pruned;
  for (const PruneRule rule : {PruneRule::workspace, PruneRule::probe, PruneRule::unreachable}) {
    const std::uint64_t sum = bytes[static_cast<std::size_t>(rule)];
    if (sum > 0) pruned.push_back({name_of(rule), sum});
  }
  return pruned;
}

}  // namespace

TreeElements::TreeElements(const Caster& caster, const std::vector<SurfacePiece>& triangles,
                           double tolerance)
    : caster_(caster), triangles_(triangles), form_(caster, tolerance) {}

std::vector<Pruned> TreeElements::build(Asset& asset, const SpaceBuilder& space,
                                        const Reach* reach) const {
  const Elements elements = gather(caster_, asset, form_, triangles_);
  BuiltTree tree = build_tree(elements.all);
  std::vector<Pruned> pruned;
  if (reach != nullptr) {
    const std::vector<bool> needed = mark_needed(caster_, asset, elements, tree, space);
    pruned = add_up(asset, elements, needed, *reach);
    std::vector<TreeElement> kept;
    for (std::size_t i = 0; i < needed.size(); ++i) {
      if (needed[i]) kept.push_back(elements.all[i]);
    }
    tree = build_tree(kept);
  }
  std::vector<TileData> tiles;
  for (const std::uint32_t which : tree.tiles) tiles.push_back(asset.tiles[which]);
  asset.tiles = std::move(tiles);
  form_.describe(asset);
  for (const std::uint32_t which : tree.triangles) form_.append(elements.triangles[which], asset);
  asset.first_cap = tree.first_cap;
  asset.tree = std::move(tree.data);
  return pruned;
}

}  // namespace spm::baker
