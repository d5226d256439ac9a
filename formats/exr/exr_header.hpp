// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace spm {

/// Position of an attribute's value in a file.
struct AttributePlace {
  std::uint64_t offset = 0;
  std::uint32_t size = 0;
};

/// The information in the first bytes of an EXR, read before anything in the file may be trusted.
struct ExrHeader {
  bool complete = false;  ///< the headers of all parts lie in the bytes
  std::uint64_t end = 0;  ///< first byte behind the headers, where the chunk tables begin
  bool multi_part = false;
};

/// True where the bytes begin as an EXR does.
[[nodiscard]] bool is_exr(std::span<const std::byte> bytes) noexcept;

/// Walks over the headers of all parts; every read is checked against the end of the bytes.
[[nodiscard]] ExrHeader scan_header(std::span<const std::byte> bytes) noexcept;

/// Finds a string attribute of the first part by its name. We walk the header ourselves because the
/// checksum must be known before a parser may be trusted with the file.
[[nodiscard]] std::optional<AttributePlace> find_string_attribute(std::span<const std::byte> bytes,
                                                                  std::string_view name) noexcept;

}  // namespace spm
