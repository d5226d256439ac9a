// SPDX-License-Identifier: Apache-2.0
#include "common/query/listed_closest_points.hpp"

#include <array>
#include <cmath>

#include "common/surface/closest_on_cell.hpp"
#include "common/surface/closest_on_tile.hpp"

namespace spm {

namespace {

void set_on_cell(const AssetView& asset, const IndexPrimitive& primitive,
                 const NearestPrimitive& found, const Vector3& point,
                 ElementClosestPoint& closest_point) noexcept {
  const CellPacket& packet = asset.index.packets.cells[primitive.packet];
  TileClosestPoint& on = closest_point.on_tile;
  const bool on_border = std::abs(found.x) == 0.5F || std::abs(found.y) == 0.5F;
  if (on_border && packet.clips == 0) {
    on = closest_point_on_cell(packet, primitive.lane, point - asset.bvh.origin, found.x, found.y);
  } else {
    on.cell = cell_of(packet, primitive.lane);
    on.slope_eta = packet.slope_eta[primitive.lane] + packet.twist[primitive.lane] * found.y;
    on.slope_omega = packet.slope_omega[primitive.lane] + packet.twist[primitive.lane] * found.x;
    on.away_eta = found.away[0] * packet.spacing;
    on.away_omega = found.away[1] * packet.spacing;
    on.away_depth = found.away[2] * packet.spacing;
    settle_closest_point(on, std::sqrt(found.square));
  }
  closest_point.tile = &asset.tiles[packet.tile];
  closest_point.distance = static_cast<double>(on.distance);
  closest_point.along_normal = static_cast<double>(std::abs(on.below));
}

void set_on_triangle(const AssetView& asset, const IndexPrimitive& primitive,
                     const NearestPrimitive& found, const Vector3& point,
                     ElementClosestPoint& closest_point) noexcept {
  const PrimitivePackets& packets = asset.index.packets;
  const TrianglePacket& packet = packets.triangles[primitive.packet - packets.cells.size()];
  const auto vector = [&](const PacketVectors& from) {
    return Vector3(double{from[0][primitive.lane]}, double{from[1][primitive.lane]},
                   double{from[2][primitive.lane]});
  };
  const Vector3 away(double{found.away[0]}, double{found.away[1]}, double{found.away[2]});
  // One without a direction may be the nearest, but faces nothing.
  const bool has_normal = packet.min_share[primitive.lane] < no_share;
  closest_point.tile = nullptr;
  closest_point.distance = static_cast<double>(std::sqrt(found.square));
  closest_point.on_triangle = point - away;
  closest_point.triangle_normal = has_normal ? vector(packet.normal) : Vector3(Vector3::UnitZ());
  closest_point.along_normal = has_normal ? std::abs(closest_point.triangle_normal.dot(away)) : 0;
}

/// The closest point that a primitive of a list has; infinite where there is none.
void set_closest_point(const AssetView& asset, const PackedNumbers& names,
                       const NearestPrimitive& found, const Vector3& point,
                       ElementClosestPoint& closest_point) noexcept {
  if (!found.is_found()) return;
  const IndexPrimitive primitive = primitive_at(names, found.which);
  if (primitive.packet < asset.index.packets.cells.size()) {
    set_on_cell(asset, primitive, found, point, closest_point);
  } else {
    set_on_triangle(asset, primitive, found, point, closest_point);
  }
}

}  // namespace

ElementClosestPoint listed_nearest(const AssetView& asset, const IndexList& list,
                                   const Vector3& point) noexcept {
  const PackedNumbers names = packed_numbers_of(asset.index, list, list.nearest);
  ElementClosestPoint closest_point;
  set_closest_point(asset, names,
                    nearest_primitive(asset.index.packets, names, from_origin(asset.bvh, point)),
                    point, closest_point);
  return closest_point;
}

ListedClosestPoints listed_closest_points(const AssetView& asset, const IndexList& list,
                                          const Vector3& point) noexcept {
  const PackedNumbers names = packed_numbers_of(asset.index, list, list.nearest);
  return listed_closest_points(
      asset, list, point,
      nearest_primitive(asset.index.packets, names, from_origin(asset.bvh, point)));
}

ListedClosestPoints listed_closest_points(const AssetView& asset, const IndexList& list,
                                          const Vector3& point,
                                          const NearestPrimitive& found) noexcept {
  ListedClosestPoints closest_points;
  ElementClosestPoint& nearest = closest_points.nearest;
  set_closest_point(asset, packed_numbers_of(asset.index, list, list.nearest), found, point,
                    nearest);
  if (nearest.along_normal >= facing_cosine * nearest.distance) return closest_points;
  const double most = nearest.distance + facing_tolerances * asset.tolerance;
  if (!std::isfinite(most)) return closest_points;
  const PackedNumbers all = packed_numbers_of(asset.index, list, list.count);
  const NearestPrimitive facing = nearest_facing(
      asset.index.packets, all, from_origin(asset.bvh, point), static_cast<float>(facing_cosine));
  if (double{facing.square} <= most * most) {
    set_closest_point(asset, all, facing, point, closest_points.facing.emplace());
  }
  return closest_points;
}

}  // namespace spm
