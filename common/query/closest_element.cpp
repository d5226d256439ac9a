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

/// Closest points whose distances differ by no more than this share are one.
constexpr double same_share = 1e-6;

/// Votes for the two sides that differ by this leave no doubt.
constexpr double clear_margin = 0.8;
/// Doubt makes a distance less up to a tolerance from the surface, fading out up to so many.
constexpr double close_radius = 1.25;
/// But by no more than so many: the elements themselves may be off by the rest of a tolerance.
constexpr double max_reduction = 0.55;

/// Gathers the nearest of the elements that are shown to it.
class Gatherer {
 public:
  Gatherer(const AssetView& asset, const Vector3& point, CubeKind place,
           ElementReading& kept) noexcept
      : reading(kept),
        asset_(asset),
        point_(point),
        thinnest_(1 * asset.triangle_step),
        boundary_(place == CubeKind::boundary),
        band_end_(std::max(asset.band.max_depth, asset.band.margin) + asset.tolerance),
        // Outside nothing beyond the margin matters.
        limit_(place == CubeKind::outside ? asset.band.margin + 2 * asset.tolerance
                                          : std::numeric_limits<double>::infinity()) {}

  ElementReading& reading;

  /// Elements farther than this change nothing, m.
  [[nodiscard]] double limit() const noexcept { return limit_; }

  void visit(const BvhChild& child) noexcept {
    ++reading.visited;
    if (child.kind == ElementKind::tile) {
      visit_tile(child.first);
      return;
    }
    visit_fan(child);
  }

  void visit(const IndexPrimitive& primitive) noexcept {
    ++reading.visited;
    const PrimitivePackets& packets = asset_.index.packets;
    if (primitive.packet < packets.cells.size()) {
      visit_cell(packets.cells[primitive.packet], primitive.lane);
      return;
    }
    visit_triangle(packets.triangles[primitive.packet - packets.cells.size()], primitive.lane);
  }

 private:
  const AssetView& asset_;
  const Vector3& point_;
  double thinnest_;
  bool boundary_;
  double band_end_;
  double limit_;
  /// Of closest points that differ by rounding, those on an edge that elements share, the one that
  /// faces the point most: so that the order of visits does not tell.
  [[nodiscard]] static bool is_better(double distance, double along,
                                      const ElementClosestPoint& kept) noexcept {
    const double tie = same_share * distance;
    return distance < kept.distance - tie ||
           (distance <= kept.distance + tie && along > kept.along_normal);
  }

  void visit_tile(std::uint32_t which) noexcept {
    if (which >= asset_.tiles.size()) return;
    const Tile& tile = asset_.tiles[which];
    if (tile.plane >= asset_.planes.size()) return;
    const SupportPlane& plane = asset_.planes[tile.plane];
    keep_closest_point(
        tile, closest_on_tile(tile, asset_.height_unit, plane, point_, static_cast<float>(limit_)));
  }

  void visit_cell(const CellPacket& packet, std::uint32_t lane) noexcept {
    const Tile& tile = asset_.tiles[packet.tile];
    keep_closest_point(tile, closest_on_cell(tile, packet, lane, point_ - asset_.bvh.origin,
                                             static_cast<float>(limit_)));
  }

  void keep_closest_point(const Tile& tile, const TileClosestPoint& closest_point) noexcept {
    if (!std::isfinite(closest_point.distance)) return;
    const auto distance = static_cast<double>(closest_point.distance);
    const auto along = static_cast<double>(std::abs(closest_point.below));
    if (boundary_) reading.sides.add({distance, closest_point.below > 0, along});
    const auto keep = [&](ElementClosestPoint& kept) {
      kept.distance = distance;
      kept.tile = &tile;
      kept.on_tile = closest_point;
      kept.along_normal = along;
    };
    if (is_better(distance, along, reading.nearest)) keep(reading.nearest);
    if (along >= facing_cosine * distance && is_better(distance, along, reading.facing)) {
      keep(reading.facing);
    }
    narrow();
  }

  void visit_fan(const BvhChild& fan) noexcept {
    const bool cap = fan.first >= asset_.first_cap;
    Vector3 a, b, c;
    if (!stored_corner(asset_, fan.first, a) || !stored_corner(asset_, fan.first + 1, b)) return;
    for (std::uint32_t k = 0; k < fan.count; ++k, b = c) {
      if (!stored_corner(asset_, fan.first + k + 2, c)) return;
      visit_triangle(a, b, c, cap);
    }
  }

  void visit_triangle(const TrianglePacket& packet, std::uint32_t lane) noexcept {
    const std::uint32_t first = packet.first[lane], second = packet.second[lane];
    Vector3 a, b, c;
    if (!stored_corner(asset_, first, a) || !stored_corner(asset_, second, b) ||
        !stored_corner(asset_, second + 1, c)) {
      return;
    }
    visit_triangle(a, b, c, first >= asset_.first_cap);
  }

  void visit_triangle(const Vector3& a, const Vector3& b, const Vector3& c, bool cap) noexcept {
    if (cap && !boundary_) return;
    const Vector3 across = (b - a).cross(c - a);
    // No nearer than its plane.
    const double level = across.dot(point_ - a);
    if (level * level > 1.000001 * limit_ * limit_ * across.squaredNorm()) return;
    const Vector3 closest_point = closest_on_triangle(point_, a, b, c);
    const Vector3 away = point_ - closest_point;
    const double distance = away.norm();
    if (!(distance <= limit_)) return;
    const double size = across.norm();
    // A triangle without a direction may be the nearest, but tells no side.
    const Vector3 normal = size > 0 ? Vector3(across / size) : Vector3(Vector3::UnitZ());
    const double height = normal.dot(away);
    const double along = size > 0 ? std::abs(height) : 0;
    if (boundary_) vote({a, b, c}, closest_point, size, {distance, height < 0, along});
    const auto keep = [&](ElementClosestPoint& kept) {
      kept.distance = distance;
      kept.tile = nullptr;
      kept.on_triangle = closest_point;
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
  void vote(const std::array<Vector3, 3>& corners, const Vector3& closest_point, double size,
            const SideVote& vote) noexcept {
    const double longest = std::sqrt(
        std::max({(corners[1] - corners[0]).squaredNorm(), (corners[2] - corners[1]).squaredNorm(),
                  (corners[0] - corners[2]).squaredNorm()}));
    if (size < thinnest_ * longest) {
      reading.sides.add({vote.distance, vote.inside, 0});
      return;
    }
    reading.sides.add_exact(vote, corners, closest_point);
  }

  void narrow() noexcept {
    const double nearest = reading.nearest.distance;
    if (!boundary_ && nearest > band_end_) {
      limit_ = std::min(limit_, std::max(band_end_, deep_share * nearest));
      return;
    }
    double limit = std::max(
        nearest, std::min(reading.facing.distance, nearest + facing_tolerances * asset_.tolerance));
    if (boundary_) {
      const bool close = nearest < close_radius * asset_.tolerance;
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
      asset.bvh, point, [&gatherer](const BvhChild& child) { gatherer.visit(child); },
      [&gatherer] { return gatherer.limit(); });
  return reading;
}

ElementReading read_elements(const AssetView& asset, const IndexList& list,
                             const Vector3& point) noexcept {
  ElementReading reading = empty_reading(asset);
  Gatherer gatherer(asset, point, CubeKind::boundary, reading);
  visit_list(
      asset.index, list, from_origin(asset.bvh, point),
      [&gatherer](const IndexPrimitive& primitive) { gatherer.visit(primitive); },
      [&gatherer] { return gatherer.limit(); });
  return reading;
}

double signed_distance(const AssetView& asset, const ElementReading& reading) noexcept {
  const double distance = reading.nearest.distance;
  const double side = reading.sides.inside() ? -1 : 1;
  const double tolerances = distance / asset.tolerance;
  if (!(tolerances < close_radius)) return side * distance;
  const double clear = std::min(1.0, reading.sides.margin() / clear_margin);
  const double fade = std::clamp((tolerances - 1) / (close_radius - 1), 0.0, 1.0);
  const double doubt = (1 - clear) * (1 - fade);
  return side * (distance - doubt * std::min(distance, max_reduction * asset.tolerance));
}

}  // namespace spm
