// SPDX-License-Identifier: Apache-2.0
#include "common/index/octant_lists.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "common/query/closest_element.hpp"
#include "common/surface/closest_on_tile.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm {

namespace {

/// Places along an edge of a cube that are corners of its octants, and in all.
constexpr unsigned side = 3, places = side * side * side;

/// The place of the surface that is a primitive's closest point of a point; nothing where nothing
/// is left of it.
std::optional<Vector3> closest_point_on(const AssetView& asset,
                                        const PrimitivePacketsData& primitives,
                                        const IndexPrimitive& primitive, const Vector3& point) {
  if (primitive.packet < primitives.cells.size()) {
    const CellPacket& packet = primitives.cells[primitive.packet];
    const Tile& tile = asset.tiles[packet.tile];
    const TileClosestPoint closest_point =
        closest_on_cell(tile, packet, primitive.lane, point - asset.bvh.origin,
                        std::numeric_limits<float>::infinity());
    if (!std::isfinite(closest_point.distance)) return std::nullopt;
    return point - from_plane_frame(asset.planes[tile.plane], double{closest_point.away_eta},
                                    double{closest_point.away_omega},
                                    double{closest_point.away_depth});
  }
  const TrianglePacket& packet = primitives.triangles[primitive.packet - primitives.cells.size()];
  Vector3 a, b, c;
  if (!stored_corner(asset, packet.first[primitive.lane], a) ||
      !stored_corner(asset, packet.second[primitive.lane], b) ||
      !stored_corner(asset, packet.second[primitive.lane] + 1, c)) {
    return std::nullopt;
  }
  return closest_on_triangle(point, a, b, c);
}

/// Corners of octants, what is nearest to them, and the squares of how far each packet is.
struct Corners {
  std::array<Vector3, places> at;
  std::array<std::optional<Vector3>, places> closest_points;
  std::array<std::array<float, places>, index_list_packets> squares;
};

/// `surface`: so many of the packets are not of caps, which are no surface.
void look_from_corners(const AssetView& asset, const PrimitivePacketsData& primitives,
                       const PacketNumbers& some, std::size_t surface, Corners& corners) {
  for (unsigned k = 0; k < places; ++k) {
    std::array<float, index_list_packets> found;
    const std::array<float, 3> place = from_origin(asset.bvh, corners.at[k]);
    const NearestPrimitive nearest =
        nearest_of_packets(primitives.view(), std::span(some).first(surface), place, found.data());
    static_cast<void>(nearest_of_packets(primitives.view(), std::span(some).subspan(surface), place,
                                         found.data() + surface));
    for (std::size_t i = 0; i < some.size(); ++i) corners.squares[i][k] = found[i];
    if (!nearest.is_found()) continue;
    corners.closest_points[k] =
        closest_point_on(asset, primitives,
                         {some[nearest.which / packet_width],
                          static_cast<std::uint32_t>(nearest.which % packet_width)},
                         corners.at[k]);
  }
}

/// A place of the surface, from the corners of an octant.
struct KnownPlace {
  PacketLanes squares;  ///< of its distances, m^2
  double farthest = 0;  ///< of its distances, m
};

KnownPlace known_place(const Corners& corners, const std::array<unsigned, 8>& own,
                       const Vector3& closest_point, double rounding) {
  KnownPlace known;
  for (unsigned k = 0; k < own.size(); ++k) {
    const double distance = (corners.at[own[k]] - closest_point).norm() + rounding;
    known.squares[k] = static_cast<float>(distance * distance);
    known.farthest = std::max(known.farthest, distance);
  }
  return known;
}

}  // namespace

std::array<IndexLists, 8> octant_lists(const AssetView& asset,
                                       const PrimitivePacketsData& primitives,
                                       const Vector3& middle, double half,
                                       const PacketNumbers& some, double slack, double rounding) {
  Corners corners;
  for (unsigned k = 0; k < places; ++k) {
    const Vector3 steps(k % side, k / side % side, k / (side * side));
    corners.at[k] = middle + half * (steps - Vector3::Ones());
  }
  const auto surface = static_cast<std::size_t>(
      std::lower_bound(some.begin(), some.end(), primitives.first_cap) - some.begin());
  look_from_corners(asset, primitives, some, surface, corners);
  std::array<IndexLists, 8> lists;
  for (unsigned octant = 0; octant < lists.size(); ++octant) {
    std::array<unsigned, 8> own;
    for (unsigned k = 0; k < own.size(); ++k) {
      const auto step = [&](unsigned axis) { return ((octant >> axis) & 1U) + ((k >> axis) & 1U); };
      own[k] = step(0) + side * (step(1) + side * step(2));
    }
    std::array<KnownPlace, 8> known;
    std::size_t count = 0;
    for (const unsigned from : own) {
      if (corners.closest_points[from]) {
        known[count++] = known_place(corners, own, *corners.closest_points[from], rounding);
      }
    }
    for (std::size_t i = 0; i < some.size(); ++i) {
      bool nearest = i < surface, near = true;
      for (std::size_t j = 0; j < count && near; ++j) {
        float least = empty_square;
        for (unsigned k = 0; k < own.size(); ++k) {
          least = std::min(least, corners.squares[i][own[k]] - known[j].squares[k]);
        }
        nearest = nearest && !(least >= 0);
        near = !(double{least} >= slack * (2 * known[j].farthest + slack));
      }
      if (!near) continue;
      lists[octant].all.push_back(some[i]);
      if (nearest) lists[octant].nearest.push_back(some[i]);
    }
  }
  return lists;
}

}  // namespace spm
