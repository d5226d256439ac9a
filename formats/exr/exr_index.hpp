// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "formats/exr/exr_layout.hpp"

namespace spm {

/// A part whose tiles can be read in place.
struct ExrPart {
  std::string name;
  SampleType type = SampleType::float32;
  std::vector<std::string> channels;  ///< in stored order
  std::uint32_t tile_width = 0;
  std::uint32_t tile_height = 0;
  TileGrid tiles;
  std::vector<std::uint64_t> offsets;  ///< of each tile's samples in the file, row-major

  [[nodiscard]] std::uint64_t tile_samples() const noexcept {
    return std::uint64_t{tile_width} * tile_height * channels.size();
  }
  [[nodiscard]] std::uint64_t tile_bytes() const noexcept {
    return tile_samples() * sample_bytes(type);
  }
};

/// Parses a file in memory with OpenEXRCore, and checks everything that reading in place relies on.
/// Every part is tiled, of one level, uncompressed and in increasing order, with channels of one
/// type. Every tile is complete, inside the file, aligned to its samples, behind the tables and
/// disjoint from all others. There is nothing else in the file. Errors: invalid_input, with `path`
/// in front.
[[nodiscard]] Result<std::vector<ExrPart>> index_exr(std::span<const std::byte> bytes,
                                                     const std::string& path);

}  // namespace spm
