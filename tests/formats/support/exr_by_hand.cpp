// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/support/exr_by_hand.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace spm::test {
namespace {

std::string text_at(const std::string& bytes, std::uint64_t& at) {
  const std::size_t end = bytes.find('\0', at);
  if (end == std::string::npos) throw std::runtime_error("text without an end");
  std::string text = bytes.substr(at, end - at);
  at = end + 1;
  return text;
}

void interpret(HandPart& part) {
  const std::string& list = part.attributes.at("channels");
  for (std::uint64_t at = 0; list.at(at) != '\0';) {
    part.channels.push_back(text_at(list, at));
    const std::uint32_t type = word_at(list, at);
    part.sample_bytes = type == 1 ? 2 : 4;
    at += 16;  // type, linearity, sampling x and y
  }
  const std::string& window = part.attributes.at("dataWindow");
  part.width = word_at(window, 8) - word_at(window, 0) + 1;
  part.height = word_at(window, 12) - word_at(window, 4) + 1;
  const std::string& tiles = part.attributes.at("tiles");
  part.tile_width = word_at(tiles, 0);
  part.tile_height = word_at(tiles, 4);
}

}  // namespace

std::uint32_t word_at(const std::string& bytes, std::uint64_t offset) {
  std::uint32_t value = 0;
  if (offset + sizeof value > bytes.size()) throw std::runtime_error("past the end");
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

float float_at(const std::string& bytes, std::uint64_t offset) {
  const std::uint32_t word = word_at(bytes, offset);
  float value = 0;
  std::memcpy(&value, &word, sizeof value);
  return value;
}

std::uint64_t HandPart::sample_offset(std::size_t tile, const std::string& channel, std::uint32_t x,
                                      std::uint32_t y) const {
  const auto rank = static_cast<std::uint64_t>(
      std::find(channels.begin(), channels.end(), channel) - channels.begin());
  if (rank == channels.size()) throw std::runtime_error("no channel " + channel);
  return table.at(tile) + 24 +
         sample_bytes * (std::uint64_t{y} * tile_width * channels.size() + rank * tile_width + x);
}

HandFile read_by_hand(const std::string& bytes) {
  HandFile file;
  std::uint64_t at = 8;
  if (word_at(bytes, 0) != 20000630 || word_at(bytes, 4) != (2 | 0x1000)) {
    throw std::runtime_error("not a multi-part EXR of version 2");
  }
  while (bytes.at(at) != '\0') {
    HandPart part;
    for (std::string name = text_at(bytes, at); !name.empty(); name = text_at(bytes, at)) {
      text_at(bytes, at);
      const std::uint32_t size = word_at(bytes, at);
      part.attributes[name] = bytes.substr(at + 4, size);
      at += 4 + size;
    }
    interpret(part);
    file.parts.push_back(std::move(part));
  }
  file.header_bytes = ++at;
  for (HandPart& part : file.parts) {
    const std::uint64_t chunks =
        std::uint64_t{part.width / part.tile_width} * (part.height / part.tile_height);
    for (std::uint64_t k = 0; k < chunks; ++k, at += 8) {
      part.table.push_back(word_at(bytes, at) | (std::uint64_t{word_at(bytes, at + 4)} << 32U));
    }
  }
  return file;
}

}  // namespace spm::test
