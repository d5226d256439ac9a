// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace spm {

// Samples and words are used in place, in little-endian order; see check_host.

// Names of parts and attributes of a baked file. The attributes belong to the first part. The
// values of `checksum` and `bytes` have a fixed width, because they are filled in last.
namespace part_name {
inline constexpr std::string_view heights = "heights";        ///< `full` adds the number of layers
inline constexpr std::string_view grid_maps = "grid_maps";    ///< `sparse` only
inline constexpr std::string_view grid_index = "grid_index";  ///< `full` only
inline constexpr std::string_view grid_records = "grid_records";  ///< `full` only
inline constexpr std::string_view grid_roots = "grid_roots";      ///< `sparse` only
inline constexpr std::string_view grid_cubes = "grid_cubes";      ///< `sparse` only
inline constexpr std::string_view grid_lists = "grid_lists";      ///< `sparse` only
inline constexpr std::string_view grid_masks = "grid_masks";      ///< `full` only
inline constexpr std::string_view triangles = "triangles";
inline constexpr std::string_view triangles_corners = "triangles_corners";  ///< `sparse` only
inline constexpr std::string_view triangles_sides = "triangles_sides";      ///< `sparse` only
}  // namespace part_name
namespace attribute_name {
inline constexpr std::string_view description = "spm";
inline constexpr std::string_view checksum = "spm_checksum";
inline constexpr std::string_view bytes = "spm_bytes";
inline constexpr std::string_view pad = "spm_pad";
}  // namespace attribute_name

/// Decimals of the attribute that records the size of the file.
inline constexpr std::uint32_t bytes_decimals = 20;

/// Bytes in front of a tile's samples in a multi-part file: part, tile x and y, level x and y,
/// size.
inline constexpr std::uint64_t chunk_header_bytes = 24;

/// Samples of a part, all of one type: HALF, FLOAT or UINT.
enum class SampleType { half16, float32, uint32 };

[[nodiscard]] constexpr std::uint32_t sample_bytes(SampleType type) noexcept {
  return type == SampleType::half16 ? 2 : 4;
}

/// Part of a `full` asset that holds the maps with this number of layers: "heights01", ...
[[nodiscard]] std::string heights_part_name(std::uint32_t layers);

/// Channel of a layer: "Y", "hit1.Y", "hit2.Y", ...
[[nodiscard]] std::string channel_name(std::uint32_t layer);

/// Channel names of `layers` layers in the order in which EXR stores them: that of strcmp.
[[nodiscard]] std::vector<std::string> stored_channels(std::uint32_t layers);

/// Offset of each layer's samples within a row of a tile, in samples: its channel's rank times the
/// number of columns.
[[nodiscard]] std::vector<std::uint32_t> stored_layer_offsets(std::uint32_t layers,
                                                              std::uint32_t columns);

/// Number of columns and rows of tiles, or of samples.
struct TileGrid {
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
};

/// Arranges `count` tiles in a picture: at most 32 times as long as wide where that is possible,
/// then with as few spare tiles as possible, then as square as possible.
[[nodiscard]] TileGrid arrange_tiles(std::uint32_t count, std::uint32_t tile_width,
                                     std::uint32_t tile_height);

/// Dimensions of a picture for a flat array of `count` words, 1 or more, with few spare words.
[[nodiscard]] TileGrid arrange_words(std::uint64_t count);

}  // namespace spm
