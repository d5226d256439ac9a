// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace spm::test {

/// A part as the bytes say, read by code that shares nothing with the product and no EXR library:
/// the layout of an uncompressed, tiled multi-part file as its specification states it.
struct HandPart {
  std::map<std::string, std::string> attributes;  ///< raw values
  std::vector<std::string> channels;              ///< in stored order
  std::uint32_t width = 0, height = 0, tile_width = 0, tile_height = 0;
  std::uint32_t sample_bytes = 4;
  std::vector<std::uint64_t> table;

  [[nodiscard]] std::string name() const { return attributes.at("name"); }

  /// Offset in the file of sample (x, y) of a channel of tile k.
  [[nodiscard]] std::uint64_t sample_offset(std::size_t tile, const std::string& channel,
                                            std::uint32_t x, std::uint32_t y) const;
};

struct HandFile {
  std::uint64_t header_bytes = 0;
  std::vector<HandPart> parts;
};

[[nodiscard]] HandFile read_by_hand(const std::string& bytes);

[[nodiscard]] std::uint32_t word_at(const std::string& bytes, std::uint64_t offset);
[[nodiscard]] float float_at(const std::string& bytes, std::uint64_t offset);

}  // namespace spm::test
