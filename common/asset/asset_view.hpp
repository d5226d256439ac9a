// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "common/field/distance_octree.hpp"
#include "common/field/indexed_triangles.hpp"
#include "common/surface/distance_map.hpp"
#include "common/surface/height_chart.hpp"
#include "common/surface/support_plane.hpp"

namespace spm {

/// The band in which an asset answers exactly, for the probe's centre; metres.
struct Band {
  double max_depth = 0;  ///< inside, 0 or more
  double margin = 0;     ///< outside, 0 or more
};

/// Spatial partition of a `full` asset: a regular grid over the band's bounding box. Views; nothing
/// is owned.
///
/// `index` has one word per cell, x fastest. Its two top bits are the kind of the cell (CellKind);
/// the 30 others are its payload. The payload of a cell of kind `record` is one of
///   bit 28 set: a split cell; bits 0-27 the place in `records` of eight words like those of
///     `index`, one per octant, x fastest; splits are nested at most split_levels deep;
///   else: bits 0-27 the place in `records` of a list.
/// A list is a header word, then one word for each of its maps, then one for each of its triangles:
///   header: bits 0-7 the number of maps, bits 8-23 the number of triangles, the rest 0;
///   map: bits 0-23 the map, bits 24-31 its layer;
///   triangle: its number, times two, plus one for a sheet's.
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
/// Bits of an index word below its kind, and their parts in a cell of kind `record`.
inline constexpr std::uint32_t payload_mask = 0x3FFFFFFFU;
inline constexpr std::uint32_t split_bit = 1U << 28U;
inline constexpr std::uint32_t offset_mask = 0x0FFFFFFFU;
inline constexpr std::uint32_t max_listed = 0xFFU;
inline constexpr std::uint32_t max_listed_triangles = 0xFFFFU;

/// A map candidate in a list of a `full` asset, unpacked from its word.
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

/// Sign that converts distance and normal on a map to those of the solid: 1 where the crossing
/// (counted from 0) is an entry, -1 where it is an exit, where the solid is on the plane's side of
/// the surface.
[[nodiscard]] constexpr double side_of_crossing(std::uint32_t crossing) noexcept {
  return (crossing & 1U) == 0 ? 1 : -1;
}

enum class CellKind : std::uint32_t {
  far = 0,   ///< wholly outside and beyond the margin
  deep = 1,  ///< wholly inside and deeper than max_depth; payload: normal, octahedral, 15 bits per
             ///< axis
  record = 2,  ///< touches the band; payload: see Grid
  pruned = 3,  ///< left out by the bake
};

/// A corner of a box that nothing is known of: it holds all places.
[[nodiscard]] inline Vector3 unknown_box(double side) noexcept {
  return Vector3::Constant(side * std::numeric_limits<double>::infinity());
}

/// Everything that a query reads, as pointers into a baked file or into the baker's memory.
/// Immutable once built; any number of threads may read it.
struct AssetView {
  std::span<const SupportPlane> planes;
  std::span<const DistanceMap> maps;
  std::span<const HeightChart> charts;  ///< `sparse` only: the distance maps that answer
  StoredHeights atlas;                  ///< `sparse` only: the heights of all charts
  std::span<const float> triangles;     ///< `full` only: of the fallback, three corners each, m
  Grid grid;                            ///< `full` only
  DistanceOctree octree;                ///< `sparse` only
  IndexedTriangles exact;               ///< `sparse` only
  Band band;
  Vector3 box_low = unknown_box(-1), box_high = unknown_box(1);  ///< m, of the mesh
  double tolerance = 0;        ///< m; how far beyond the band's end an answer may lie
  double sheet_thickness = 0;  ///< m, from the middle of a sheet to what is felt of it
  bool full = false;           ///< map k belongs to plane k and `paper` applies

  /// True where the paper's equations can be evaluated: there are planes, and each has its map.
  [[nodiscard]] bool maps_every_plane() const noexcept {
    return full && !planes.empty() && maps.size() == planes.size();
  }

  // The planes again, as one array per component, for the paper's search over all of them; `full`
  // only.
  std::span<const double> plane_nx, plane_ny, plane_nz;
  std::span<const double> plane_offset;  ///< n . x0
};

/// A box that contains an asset's band: places outside it are `far`.
struct Extent {
  Vector3 low = Vector3::Zero();
  Vector3 size = Vector3::Zero();
};
[[nodiscard]] inline Extent extent_of(const AssetView& asset) noexcept {
  if (asset.full) {
    const auto& cells = asset.grid.cells;
    return {asset.grid.origin, asset.grid.cell_size * Vector3(cells[0], cells[1], cells[2])};
  }
  const auto& roots = asset.octree.roots;
  return {asset.octree.origin, asset.octree.edge * Vector3(roots[0], roots[1], roots[2])};
}

}  // namespace spm
