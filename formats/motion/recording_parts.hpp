// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

/// Of a recording's file, what its writer and its reader both know.
namespace spm::recording_parts {

inline constexpr std::string_view magic = "SPM-REC1";
inline constexpr std::size_t start_bytes = magic.size() + 8;
inline constexpr std::uint32_t row_kind = 1;
inline constexpr std::size_t head_bytes = 8;

/// The size of the first part of some bytes, with its head; 0 where no whole part is left.
[[nodiscard]] inline std::size_t part_bytes(std::string_view bytes) noexcept {
  if (bytes.size() < head_bytes) return 0;
  std::array<std::uint32_t, 2> head{};
  std::memcpy(head.data(), bytes.data(), head_bytes);
  const bool whole = head[1] % 8 == 0 && head[1] <= bytes.size() - head_bytes;
  return whole ? head_bytes + head[1] : 0;
}

/// A change of pose in the file.
struct PlacedPart {
  std::uint64_t tick = 0;
  std::uint64_t object = 0;
  std::array<double, 7> pose{};
};

}  // namespace spm::recording_parts
