// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/error.hpp"
#include "formats/exr/exr_layout.hpp"
#include "formats/files/output_file.hpp"

namespace spm {

/// A part of an EXR that is to be written; all its tiles have one size.
struct PartPlan {
  std::string name;
  SampleType type = SampleType::float32;
  std::vector<std::string> channels;  ///< in stored order
  std::uint32_t tile_width = 0;
  std::uint32_t tile_height = 0;
  TileGrid tiles;
  /// Bytes of a tile as they are stored in the file. May use `scratch`, which stays valid until the
  /// next call.
  std::function<std::span<const std::byte>(std::uint32_t tile, std::vector<std::byte>& scratch)>
      payload;

  [[nodiscard]] std::uint64_t tile_bytes() const noexcept {
    return std::uint64_t{sample_bytes(type)} * tile_width * tile_height * channels.size();
  }
  [[nodiscard]] std::uint64_t payload_bytes() const noexcept {
    return tile_bytes() * tiles.columns * tiles.rows;
  }
};

/// Attributes of the first part, in this order.
using Attribute = std::pair<std::string, std::variant<std::string, int, double>>;

/// Writes parts as a tiled, uncompressed multi-part EXR, without gaps and in increasing order. A
/// pad attribute aligns the samples of tiles whose size is a multiple of eight bytes to eight
/// bytes. The attributes of size and checksum are filled in last. Returns the size of the file.
/// Errors: file_or_device; invalid_input where a tile exceeds the 2 GiB that the format can hold.
[[nodiscard]] Result<std::uint64_t> write_exr(OutputFile& file, const std::string& path,
                                              const std::vector<PartPlan>& parts,
                                              std::vector<Attribute> attributes);

}  // namespace spm
