// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "formats/asset/asset.hpp"

namespace spm {

/// Content of the string attribute `spm`: everything of an asset except height samples, the grid,
/// the octree's words and triangles.
struct AssetDescription {
  AssetMetadata metadata;
  std::vector<SupportPlane> planes;
  std::vector<double> plane_spacing;      ///< `full` only: metres between samples, one per plane
  std::vector<std::uint32_t> plane_tile;  ///< `full` only: EXR tile, counted through all parts
  // `full` only: see Grid.
  Vector3 grid_origin = Vector3::Zero();
  double grid_cell_size = 1;
  std::array<std::uint32_t, 3> grid_cells{0, 0, 0};
  std::uint64_t grid_records = 0;                        ///< words
  OctreeData octree;                                     ///< `sparse` only, without its words
  std::uint64_t octree_words = 0, octree_lists = 0;      ///< `sparse` only: words
  std::uint64_t exact_triangles = 0, exact_corners = 0;  ///< `sparse` only
  std::uint32_t maps = 0;  ///< `full` only, with their columns and rows
  std::uint32_t map_columns = 0;
  std::uint32_t map_rows = 0;
  AtlasData atlas;                 ///< `sparse` only, without its heights and charts
  std::uint32_t atlas_charts = 0;  ///< `sparse` only
  std::uint32_t triangles = 0;     ///< `full` only: of the fallback
};

/// Description of an asset in memory, without the EXR tiles of its planes.
[[nodiscard]] AssetDescription describe(const Asset& asset);

/// JSON text of a description: one line, keys in a fixed order, numbers that round-trip. The same
/// description always gives the same text. `metadata.options` must be a JSON object.
[[nodiscard]] std::string to_json(const AssetDescription& description);

/// Reads the text back. Every field is checked for presence, type and range; planes must be
/// orthonormal, right-handed bases (1e-6). Unknown keys are ignored, because later programs may add
/// some. Errors: invalid_input, with `place` (the file) in front of the message.
[[nodiscard]] Result<AssetDescription> parse_description(std::string_view text,
                                                         const std::string& place);

}  // namespace spm
