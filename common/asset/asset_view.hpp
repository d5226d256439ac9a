// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/surface/distance_map.hpp"
#include "common/asset/element_index.hpp"
#include "common/asset/element_tree.hpp"
#include "common/asset/space_tree.hpp"
#include "common/surface/support_plane.hpp"
#include "common/surface/tile.hpp"

namespace spm {

/// Where an asset answers exactly, for the probe's centre; metres.
struct Band {
  double max_depth = 0;  ///< inside, 0 or more
  double margin = 0;     ///< outside, 0 or more
};

/// Spatial partition of a `full` asset: a regular grid over the band's bounding box. Views; nothing
/// is owned.
///
/// `index` has one word a cell, x fastest. Its two top bits tell what the cell is (CellKind), the
/// 30 others hold its payload. The payload of a cell of kind `record` is one of
///   bit 28 set: a split cell; bits 0-27 the place in `records` of eight words like those of
///     `index`, one an octant, x fastest; at most split_levels splits lie within each other;
///   else: bits 0-27 the place in `records` of a list.
/// A list is a header word, then a word each for its maps, then for its triangles:
///   header: bits 0-7 how many maps, bits 8-23 how many triangles, the rest 0;
///   map: bits 0-23 the map, bits 24-31 its layer;
///   triangle: its number, times two, plus one for a cap, which decides the side and carries no
///     distance.
/// Words are read in place from a file that may be damaged after it was checked, so a reader checks
/// every offset and index before it uses it.
struct Grid {
  Vector3 origin = Vector3::Zero();
  double cell_size = 1;
  std::array<std::uint32_t, 3> cells{0, 0, 0};
  std::span<const std::uint32_t> index;
  std::span<const std::uint32_t> records;
};

inline constexpr int split_levels = 6;
/// Bits of an index word below its kind, and what they hold for a cell of kind `record`.
inline constexpr std::uint32_t payload_mask = 0x3FFFFFFFU;
inline constexpr std::uint32_t split_bit = 1U << 28U;
inline constexpr std::uint32_t offset_mask = 0x0FFFFFFFU;
inline constexpr std::uint32_t most_listed = 0xFFU;
inline constexpr std::uint32_t most_listed_triangles = 0xFFFFU;

/// A map candidate of a `full` asset's list, as its word names it.
struct MapCandidate {
  std::uint32_t map = 0;
  std::uint32_t layer = 0;  ///< below 256
};

[[nodiscard]] constexpr MapCandidate unpack_candidate(std::uint32_t word) noexcept {
  return {word & 0xFFFFFFU, word >> 24U};
}

[[nodiscard]] constexpr std::uint32_t pack_candidate(const MapCandidate& candidate) noexcept {
  return candidate.map | candidate.layer << 24U;
}

[[nodiscard]] constexpr std::uint32_t list_header(std::uint32_t maps,
                                                  std::uint32_t triangles) noexcept {
  return maps | triangles << 8U;
}

/// What turns distance and normal on a map into those of the solid: 1 where the crossing (from 0)
/// is an entry, -1 where it is an exit, which has the solid on the plane's side of the surface.
[[nodiscard]] constexpr double side_of_crossing(std::uint32_t crossing) noexcept {
  return (crossing & 1U) == 0 ? 1 : -1;
}

enum class CellKind : std::uint32_t {
  far = 0,     ///< wholly outside and beyond the margin
  deep = 1,    ///< wholly inside and below max_depth; payload: normal, octahedral, 15 bits an axis
  record = 2,  ///< touches the band; payload: see Grid
  pruned = 3,  ///< left out by the bake
};

/// Everything a query reads, as a table of pointers into a baked file or into the baker's memory.
/// Immutable after it was built; any number of threads may read it.
struct AssetView {
  std::span<const SupportPlane> planes;
  std::span<const DistanceMap> maps;
  std::span<const Tile> tiles;  ///< `sparse` only, as `maps` are `full` only
  float height_unit = 1;        ///< m a unit of the tiles' heights
  /// Corners of the exact fallback, in `full` three a triangle, in `sparse` in fans (ElementTree):
  /// three floats each, metres; or three numbers of 16 bits, of which triangle_step metres from
  /// triangle_origin make a coordinate. One of the two is empty.
  std::span<const float> triangles;
  std::span<const std::uint16_t> small_triangles;
  Vector3 triangle_origin = Vector3::Zero();
  double triangle_step = 0;
  /// `sparse` only: corners from this number on are of caps, which decide the side and carry no
  /// distance.
  std::uint32_t first_cap = 0;
  Grid grid;           ///< `full` only
  SpaceTree space;     ///< `sparse` only
  ElementTree tree;    ///< `sparse` only
  ElementIndex index;  ///< `sparse` only; empty before it was derived
  Band band;
  double tolerance = 0;  ///< m; how far an answer at the band's end may lie beyond it
  bool full = false;     ///< map k belongs to plane k and `paper` applies

  /// True where the paper's equations can be asked: each of some planes has its map.
  [[nodiscard]] bool maps_every_plane() const noexcept {
    return full && !planes.empty() && maps.size() == planes.size();
  }

  // The planes again, as arrays a component, for the paper's search over all of them; `full` only.
  std::span<const double> plane_nx, plane_ny, plane_nz;
  std::span<const double> plane_offset;  ///< n . x0
};

/// The box around an asset's band, or more: places outside it are far.
struct Extent {
  Vector3 low = Vector3::Zero();
  Vector3 size = Vector3::Zero();
};
[[nodiscard]] inline Extent extent_of(const AssetView& asset) noexcept {
  if (asset.full) {
    const auto& cells = asset.grid.cells;
    return {asset.grid.origin, asset.grid.cell_size * Vector3(cells[0], cells[1], cells[2])};
  }
  const double margin = asset.band.margin + asset.tolerance;
  const Vector3 size(static_cast<double>(asset.tree.size[0]),
                     static_cast<double>(asset.tree.size[1]),
                     static_cast<double>(asset.tree.size[2]));
  return {asset.tree.origin - Vector3::Constant(margin), size + Vector3::Constant(2 * margin)};
}

}  // namespace spm
