// SPDX-License-Identifier: Apache-2.0
#include "formats/exr/exr_header.hpp"

#include <array>
#include <cstring>

namespace spm {
namespace {

constexpr std::array<unsigned char, 4> exr_magic{0x76, 0x2f, 0x31, 0x01};
constexpr std::uint64_t first_attribute = 8;  // behind magic and version
constexpr unsigned multi_part_flag = 0x10;    // in the second byte of the version

/// A reader that never goes beyond the end; `ok` turns false where it would have.
struct Cursor {
  std::span<const std::byte> bytes;
  std::uint64_t at = 0;
  bool ok = true;

  std::string_view text() noexcept {
    const char* start = reinterpret_cast<const char*>(bytes.data()) + at;
    const void* end = at < bytes.size() ? std::memchr(start, 0, bytes.size() - at) : nullptr;
    if (end == nullptr) {
      ok = false;
      return {};
    }
    const auto length = static_cast<std::size_t>(static_cast<const char*>(end) - start);
    at += length + 1;
    return {start, length};
  }

  std::uint32_t size() noexcept {
    std::uint32_t value = 0;
    if (bytes.size() - at < sizeof value) {
      ok = false;
      return 0;
    }
    std::memcpy(&value, bytes.data() + at, sizeof value);
    at += sizeof value;
    if (value > bytes.size() - at) ok = false;
    return value;
  }
};

}  // namespace

bool is_exr(std::span<const std::byte> bytes) noexcept {
  return bytes.size() >= exr_magic.size() &&
         std::memcmp(bytes.data(), exr_magic.data(), exr_magic.size()) == 0;
}

ExrHeader scan_header(std::span<const std::byte> bytes) noexcept {
  ExrHeader header;
  if (!is_exr(bytes) || bytes.size() <= first_attribute) return header;
  header.multi_part = (static_cast<unsigned>(bytes[5]) & multi_part_flag) != 0;
  Cursor cursor{bytes, first_attribute};
  bool part_begins = true;
  while (cursor.ok) {
    const std::string_view name = cursor.text();
    if (!cursor.ok) break;
    if (name.empty()) {
      if (part_begins || !header.multi_part) {
        header.complete = true;
        header.end = cursor.at;
        break;
      }
      part_begins = true;
      continue;
    }
    part_begins = false;
    cursor.text();
    const std::uint32_t size = cursor.ok ? cursor.size() : 0;
    if (cursor.ok) cursor.at += size;
  }
  return header;
}

std::optional<AttributePlace> find_string_attribute(std::span<const std::byte> bytes,
                                                    std::string_view name) noexcept {
  if (!is_exr(bytes) || bytes.size() <= first_attribute) return std::nullopt;
  Cursor cursor{bytes, first_attribute};
  while (cursor.ok) {
    const std::string_view found = cursor.text();
    if (!cursor.ok || found.empty()) break;
    const std::string_view type = cursor.text();
    const std::uint32_t size = cursor.ok ? cursor.size() : 0;
    if (!cursor.ok) break;
    if (found == name && type == "string") return AttributePlace{cursor.at, size};
    cursor.at += size;
  }
  return std::nullopt;
}

}  // namespace spm
