// SPDX-License-Identifier: Apache-2.0
#include "common/query/closest_element.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/surface/closest_on_triangle.hpp"

namespace spm {

namespace {

/// Beyond the band an element this much nearer than the one found is not looked for: in the middle
/// of a ball all are equally near.
constexpr double deep_share = 0.8;

/// Feet whose distances differ by no more than this share are one.
constexpr double same_share = 1e-6;

/// Claims for the two sides that differ by this leave no doubt.
constexpr double clear_margin = 0.8;
/// Doubt makes a distance less up to a tolerance from the surface, fading out up to so many.
constexpr double close_reach = 1.25;
/// But by no more than so many: the elements themselves may be off by the rest of a tolerance.
constexpr double most_less = 0.55;

/// Gathers the nearest of the elements that are shown to it.
class Gatherer {
 public:
  Gatherer(const AssetView& asset, const Vector3& point, CubeKind place,
           ElementReading& kept) noexcept
      : reading(kept),
        asset_(asset),
        point_(point),
        thinnest_(1 * asset.triangle_step),
        told_(place == CubeKind::told),
        band_end_(std::max(asset.band.max_depth, asset.band.margin) + asset.tolerance),
        // Outside nothing beyond the margin matters.
        limit_(place == CubeKind::outside ? asset.band.margin + 2 * asset.tolerance
                                          : std::numeric_limits<double>::infinity()) {}

  ElementReading& reading;

  /// Elements farther than this change nothing, m.
  [[nodiscard]] double limit() const noexcept { return limit_; }

  void visit(const TreeChild& child) noexcept {
    ++reading.visited;
    if (child.kind == ElementKind::tile) {
      visit_tile(child.first);
      return;
    }
    visit_fan(child);
  }

  void visit(const IndexUnit& unit) noexcept {
    ++reading.visited;
    const UnitGroups& groups = asset_.index.groups;
    if (unit.group < groups.cells.size()) {
      visit_cell(groups.cells[unit.group], unit.lane);
      return;
    }
    visit_triangle(groups.triangles[unit.group - groups.cells.size()], unit.lane);
  }

 private:
  const AssetView& asset_;
  const Vector3& point_;
  double thinnest_;
  bool told_;
  double band_end_;
  double limit_;
  /// Of feet that differ by rounding, those on an edge that elements share, the one that faces the
  /// point most: so that the order of visits does not tell.
  [[nodiscard]] static bool is_better(double distance, double along,
                                      const ElementFoot& kept) noexcept {
    const double tie = same_share * distance;
    return distance < kept.distance - tie ||
           (distance <= kept.distance + tie && along > kept.along_normal);
  }

  void visit_tile(std::uint32_t which) noexcept {
    if (which >= asset_.tiles.size()) return;
    const Tile& tile = asset_.tiles[which];
    if (tile.plane >= asset_.planes.size()) return;
    const SupportPlane& plane = asset_.planes[tile.plane];
    keep_foot(tile,
              closest_on_tile(tile, asset_.height_unit, plane, point_, static_cast<float>(limit_)));
  }

  void visit_cell(const CellGroup& group, std::uint32_t lane) noexcept {
    const Tile& tile = asset_.tiles[group.tile];
    keep_foot(tile, closest_on_cell(tile, group, lane, point_ - asset_.tree.origin,
                                    static_cast<float>(limit_)));
  }

  void keep_foot(const Tile& tile, const TileFoot& foot) noexcept {
    if (!std::isfinite(foot.distance)) return;
    const auto distance = static_cast<double>(foot.distance);
    const auto along = static_cast<double>(std::abs(foot.below));
    if (told_) reading.sides.add({distance, foot.below > 0, along});
    const auto keep = [&](ElementFoot& kept) {
      kept.distance = distance;
      kept.tile = &tile;
      kept.on_tile = foot;
      kept.along_normal = along;
    };
    if (is_better(distance, along, reading.nearest)) keep(reading.nearest);
    if (along >= facing_cosine * distance && is_better(distance, along, reading.facing)) {
      keep(reading.facing);
    }
    narrow();
  }

  void visit_fan(const TreeChild& fan) noexcept {
    const bool cap = fan.first >= asset_.first_cap;
    Vector3 a, b, c;
    if (!stored_corner(asset_, fan.first, a) || !stored_corner(asset_, fan.first + 1, b)) return;
    for (std::uint32_t k = 0; k < fan.count; ++k, b = c) {
      if (!stored_corner(asset_, fan.first + k + 2, c)) return;
      visit_triangle(a, b, c, cap);
    }
  }

  void visit_triangle(const TriangleGroup& group, std::uint32_t lane) noexcept {
    const std::uint32_t first = group.first[lane], second = group.second[lane];
    Vector3 a, b, c;
    if (!stored_corner(asset_, first, a) || !stored_corner(asset_, second, b) ||
        !stored_corner(asset_, second + 1, c)) {
      return;
    }
    visit_triangle(a, b, c, first >= asset_.first_cap);
  }

  void visit_triangle(const Vector3& a, const Vector3& b, const Vector3& c, bool cap) noexcept {
    if (cap && !told_) return;
    const Vector3 across = (b - a).cross(c - a);
    // No nearer than its plane.
    const double level = across.dot(point_ - a);
    if (level * level > 1.000001 * limit_ * limit_ * across.squaredNorm()) return;
    const Vector3 foot = closest_on_triangle(point_, a, b, c);
    const Vector3 away = point_ - foot;
    const double distance = away.norm();
    if (!(distance <= limit_)) return;
    const double size = across.norm();
    // A triangle without a direction may be the nearest, but tells no side.
    const Vector3 normal = size > 0 ? Vector3(across / size) : Vector3(Vector3::UnitZ());
    const double height = normal.dot(away);
    const double along = size > 0 ? std::abs(height) : 0;
    if (told_) claim({a, b, c}, foot, size, {distance, height < 0, along});
    const auto keep = [&](ElementFoot& kept) {
      kept.distance = distance;
      kept.tile = nullptr;
      kept.on_triangle = foot;
      kept.triangle_normal = normal;
      kept.along_normal = along;
    };
    if (!cap && is_better(distance, along, reading.nearest)) keep(reading.nearest);
    if (!cap && along >= facing_cosine * distance && is_better(distance, along, reading.facing)) {
      keep(reading.facing);
    }
    narrow();
  }

  /// Adds what a triangle says of the side. One thinner than its corners' rounding has a normal by
  /// chance.
  void claim(const std::array<Vector3, 3>& corners, const Vector3& foot, double size,
             const SideClaim& claim) noexcept {
    const double longest = std::sqrt(
        std::max({(corners[1] - corners[0]).squaredNorm(), (corners[2] - corners[1]).squaredNorm(),
                  (corners[0] - corners[2]).squaredNorm()}));
    if (size < thinnest_ * longest) {
      reading.sides.add({claim.distance, claim.inside, 0});
      return;
    }
    reading.sides.add_exact(claim, corners, foot);
  }

  void narrow() noexcept {
    const double nearest = reading.nearest.distance;
    if (!told_ && nearest > band_end_) {
      limit_ = std::min(limit_, std::max(band_end_, deep_share * nearest));
      return;
    }
    double limit = std::max(
        nearest, std::min(reading.facing.distance, nearest + facing_tolerances * asset_.tolerance));
    if (told_) {
      const bool close = nearest < close_reach * asset_.tolerance;
      limit = std::max(limit, reading.sides.limit(close ? clear_margin : 0));
    }
    limit_ = std::min(limit_, limit);
  }
};

ElementReading empty_reading(const AssetView& asset) noexcept {
  return {tie_tolerances * asset.tolerance,
          std::max(rounding_tolerances * asset.tolerance, 2 * asset.triangle_step)};
}

}  // namespace

bool stored_corner(const AssetView& asset, std::size_t which, Vector3& corner) noexcept {
  const std::size_t first = which * 3;
  if (!asset.small_triangles.empty()) {
    if (first + 3 > asset.small_triangles.size()) return false;
    const std::uint16_t* number = asset.small_triangles.data() + first;
    corner = asset.triangle_origin + asset.triangle_step * Vector3(number[0], number[1], number[2]);
    return true;
  }
  if (first + 3 > asset.triangles.size()) return false;
  const float* number = asset.triangles.data() + first;
  corner = Vector3(number[0], number[1], number[2]);
  return true;
}

bool triangle_corners(const AssetView& asset, std::size_t triangle,
                      std::array<Vector3, 3>& corners) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    if (!stored_corner(asset, 3 * triangle + k, corners[k])) return false;
  }
  return true;
}

ElementReading read_elements(const AssetView& asset, const Vector3& point,
                             CubeKind place) noexcept {
  ElementReading reading = empty_reading(asset);
  Gatherer gatherer(asset, point, place, reading);
  visit_elements(
      asset.tree, point, [&gatherer](const TreeChild& child) { gatherer.visit(child); },
      [&gatherer] { return gatherer.limit(); });
  return reading;
}

ElementReading read_elements(const AssetView& asset, const IndexList& list,
                             const Vector3& point) noexcept {
  ElementReading reading = empty_reading(asset);
  Gatherer gatherer(asset, point, CubeKind::told, reading);
  visit_list(
      asset.index, list, from_origin(asset.tree, point),
      [&gatherer](const IndexUnit& unit) { gatherer.visit(unit); },
      [&gatherer] { return gatherer.limit(); });
  return reading;
}

double told_distance(const AssetView& asset, const ElementReading& reading) noexcept {
  const double distance = reading.nearest.distance;
  const double side = reading.sides.inside() ? -1 : 1;
  const double tolerances = distance / asset.tolerance;
  if (!(tolerances < close_reach)) return side * distance;
  const double clear = std::min(1.0, reading.sides.margin() / clear_margin);
  const double fade = std::clamp((tolerances - 1) / (close_reach - 1), 0.0, 1.0);
  const double doubt = (1 - clear) * (1 - fade);
  return side * (distance - doubt * std::min(distance, most_less * asset.tolerance));
}

}  // namespace spm
