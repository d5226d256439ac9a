// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/distance_map.hpp"
#include "common/support_plane.hpp"

namespace spm {

/// Where an asset answers exactly, for the probe's centre; metres.
struct Band {
  double max_depth = 0;  ///< inside, 0 or more
  double margin = 0;     ///< outside, 0 or more
};

/// Spatial partition: a regular grid over the band's bounding box. Views; nothing is owned.
///
/// `index` has one word a cell, x fastest. Its two top bits tell what the cell is (CellKind), the
/// 30 others hold its payload. A record in `records` is one header word, then the candidates:
///   header: bits 0-15 the number of map candidates, bits 16-31 the number of triangles;
///   map candidate: bits 0-23 the map, bits 24-31 the layer in the map;
///   triangle: bits 0-30 the triangle, bit 31 set for a cap, which decides the side and carries no
///   distance.
/// A header of all ones (split_header) means a split cell: eight words like those of `index`
/// follow, one an octant, x fastest; at most split_levels splits lie within each other. Words are
/// read in place from a file that may be damaged after it was checked, so a reader checks every
/// offset and index before it uses it.
struct Grid {
  Vector3 origin = Vector3::Zero();
  double cell_size = 1;
  std::array<std::uint32_t, 3> cells{0, 0, 0};
  std::span<const std::uint32_t> index;
  std::span<const std::uint32_t> records;
};

inline constexpr std::uint32_t split_header = 0xFFFFFFFFU;
inline constexpr int split_levels = 1;
/// Bits of an index word below its kind.
inline constexpr std::uint32_t payload_mask = 0x3FFFFFFFU;

/// A map candidate of a record, as its word names it.
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

/// What turns distance and normal on a map into those of the solid: 1 where the crossing (from 0)
/// is an entry, -1 where it is an exit, which has the solid on the plane's side of the surface.
[[nodiscard]] constexpr double side_of_crossing(std::uint32_t crossing) noexcept {
  return (crossing & 1U) == 0 ? 1 : -1;
}

enum class CellKind : std::uint32_t {
  far = 0,     ///< wholly outside and beyond the margin
  deep = 1,    ///< wholly inside and below max_depth; payload: normal, octahedral, 15 bits an axis
  record = 2,  ///< touches the band; payload: word of its record
  pruned = 3,  ///< left out by the bake
};

/// Everything a query reads, as a table of pointers into a baked file or into the baker's memory.
/// Immutable after it was built; any number of threads may read it.
struct AssetView {
  std::span<const SupportPlane> planes;
  std::span<const DistanceMap> maps;
  std::span<const float> triangles;  ///< nine floats each: three corners, metres
  Grid grid;
  Band band;
  double tolerance = 0;  ///< m; how far an answer at the band's end may lie beyond it
  bool full = false;     ///< map k belongs to plane k and `paper` applies

  // The planes again, as arrays a component, for the paper's search over all of them; `full` only.
  std::span<const double> plane_nx, plane_ny, plane_nz;
  std::span<const double> plane_offset;  ///< n . x0
};

}  // namespace spm
