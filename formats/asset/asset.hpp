// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "common/base/error.hpp"

namespace spm {

/// The version of the file format that this program writes and reads.
inline constexpr int asset_format_version = 13;

enum class AssetForm { sparse, full };

/// The content of the string attribute `spm` of a baked file, except the plane table. SI units.
/// Everything here is a function of the mesh and the options: never a path, time or thread count.
struct AssetMetadata {
  AssetForm form = AssetForm::sparse;
  std::string kind;         ///< "face" or "vertex": how the support planes were made
  std::string mesh_sha256;  ///< of the mesh file's bytes, 64 hex digits
  std::string options;      ///< JSON object: the options that change the output, normalised
  double mesh_unit = 1;     ///< metres per unit of the mesh file
  double scale = 1;         ///< factor of --fit-diagonal about the origin, after the unit
  double diagonal = 0;      ///< of the bounding box of the referenced vertices, m
  Vector3 box_min = Vector3::Zero();
  Vector3 box_max = Vector3::Zero();
  bool closed = false;  ///< the mesh had no border edge
  std::uint64_t border_edges = 0;
  std::uint64_t mesh_triangles = 0;
  Band band;
  double probe_radius = 0;          ///< m, 0 a point
  std::optional<double> tolerance;  ///< m; empty for `full`
  bool tolerance_met = false;
  std::optional<double> certified;  ///< m: the proven largest error in the band; `sparse` only
  std::uint32_t layers_max = 0;     ///< most crossings met along one ray
  double inconsistent_samples = 0;  ///< part of the rays whose crossings did not alternate
  /// Part of the surface's area, where two walls lie on each other, beside which the side is tried
  /// and not proven; `sparse` only.
  double tried_area = 0;
  double fallback_cells = 0;  ///< part of the record cells that have triangles
  /// m, from the middle of a sheet to what is felt of it; 0 where the mesh has no sheets.
  double sheet_thickness = 0;
  /// JSON object: what the parts of the mesh were taken for, and what was found in it and mended.
  std::string solid = "{}";

  /// Sets what a query reads of this.
  void add_to(AssetView& view) const noexcept;
};

/// One distance map of a `full` asset in memory; see DistanceMap for the meaning of each field.
struct MapData {
  std::uint32_t plane = 0;
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  std::uint32_t layers = 1;
  double eta0 = 0;  ///< 0 in a `full` asset, whose planes start at their first sample
  double omega0 = 0;
  double spacing = 0;
  std::vector<float> samples;       ///< layer-major, then row, then column
  std::vector<std::uint32_t> mask;  ///< mask_words(columns, rows, layers) words
};

/// A chart of a `sparse` asset in memory; see HeightChart for the meaning of each field. Its
/// spacing is AtlasData::spacing / 2^level.
struct ChartData {
  std::uint32_t plane = 0;  ///< below 65536
  std::uint32_t level = 0;  ///< below 32
  std::int32_t column0 = 0, row0 = 0;
  std::uint32_t columns = 0, rows = 0;  ///< 3 or more, below 65536
  std::uint32_t first = 0;              ///< place of its first height in the atlas
  bool offset = false;                  ///< of the offset surface (AtlasData::offset)
  float base = 0;                       ///< m below the support plane: heights count from there
};

/// The distance maps of a `sparse` asset: one picture of heights, in which each chart has its own
/// places.
struct AtlasData {
  double spacing = 0;  ///< m, of level 0
  double offset = 0;   ///< m: the signed distance at which the offset surface lies, 0 or less
  std::uint32_t width = 0;
  std::vector<float> heights;  ///< m, row by row
  bool halves = false;         ///< stored as HALF samples, which all but unused ones are exactly
  std::vector<ChartData> charts;
};

/// Of a `full` asset; see Grid.
struct GridData {
  Vector3 origin = Vector3::Zero();
  double cell_size = 1;
  std::array<std::uint32_t, 3> cells{0, 0, 0};
  std::vector<std::uint32_t> index;
  std::vector<std::uint32_t> records;
};

/// Of a `sparse` asset; see DistanceOctree and IndexedTriangles.
struct OctreeData {
  Vector3 origin = Vector3::Zero();
  double edge = 0;
  std::array<std::uint32_t, 3> roots{0, 0, 0};
  double clearance_unit = 1, reach = 1, beyond_share = 0;
  std::vector<std::uint32_t> root_words, words, lists;
  Vector3 lattice_origin = Vector3::Zero();  ///< of the exact triangles' corners
  double lattice_step = 1;
  std::vector<std::uint32_t> corners, triangles, sides;  ///< words of IndexedTriangles

  /// Sets what a query reads; the vectors must outlive it.
  void add_to(AssetView& view) const noexcept {
    view.octree = {.origin = origin,
                   .edge = edge,
                   .per_edge = 1 / edge,
                   .roots = roots,
                   .root_words = root_words,
                   .words = words,
                   .lists = lists,
                   .clearance_unit = clearance_unit,
                   .reach = reach,
                   .beyond_share = beyond_share};
    view.exact = {.origin = lattice_origin,
                  .step = lattice_step,
                  .corners = corners,
                  .triangles = triangles,
                  .sides = sides};
  }
};

/// A baked asset in memory, as the baker builds it and the writer writes it. `full`: map k belongs
/// to plane k; all maps have the same columns and rows, but the number of layers may differ.
/// `sparse`: an atlas, no such maps, and an octree instead of the grid.
struct Asset {
  AssetMetadata metadata;
  std::vector<SupportPlane> planes;
  std::vector<MapData> maps;
  AtlasData atlas;
  GridData grid;
  OctreeData octree;
  std::vector<float> triangles;  ///< `full` only: corners of the fallback's triangles, three each
};

/// The views and small tables of an AssetView over memory that somebody else owns. Move-only. The
/// memory that maps, grid and triangles point to must outlive it.
class AssetTables {
 public:
  AssetTables() = default;
  AssetTables(AssetTables&&) noexcept = default;
  AssetTables& operator=(AssetTables&&) noexcept = default;
  AssetTables(const AssetTables&) = delete;
  AssetTables& operator=(const AssetTables&) = delete;

  /// Builds the tables. `layer_offsets` is what the maps point to;
  /// it moves here so that the pointers stay valid. `rest` gives everything that is not a table:
  /// grid or octree, triangles, band, tolerance and form.
  AssetTables(std::vector<SupportPlane> planes, std::vector<DistanceMap> maps,
              std::vector<std::vector<std::uint32_t>> layer_offsets,
              std::vector<HeightChart> charts, const AssetView& rest);

  [[nodiscard]] const AssetView& view() const noexcept { return view_; }

  /// Memory that the tables take beside what they point to.
  [[nodiscard]] std::uint64_t bytes() const noexcept;

 private:
  std::vector<SupportPlane> planes_;
  std::vector<DistanceMap> maps_;
  std::vector<HeightChart> charts_;
  std::vector<std::vector<std::uint32_t>> layer_offsets_;
  std::vector<double> nx_, ny_, nz_, offset_;
  AssetView view_;
};

/// Tables over an asset in memory, so that the baker queries its result with the servo's own code.
/// `asset` must outlive the tables and stay unchanged.
[[nodiscard]] AssetTables tables_of(const Asset& asset);

/// Rounds the values that the file stores with fewer digits than a double has to the stored values,
/// so that an asset in memory and the same asset read back give the same answers. `sparse` only:
/// plane bases to eight decimals and plane origins to a hundred-millionth of the diagonal
/// (orthonormal to 1e-7). Call it before anything is fitted; it may be repeated.
void round_to_stored(Asset& asset);
/// The same of planes alone, of an object of that diagonal, m.
void round_planes(std::vector<SupportPlane>& planes, double diagonal);

/// How far beyond the band's end an answer may lie, m: the tolerance, or a thousandth of the
/// diagonal where the asset promises none.
[[nodiscard]] inline double answer_tolerance(const AssetMetadata& metadata) {
  return metadata.tolerance.value_or(1e-3 * metadata.diagonal);
}

}  // namespace spm
