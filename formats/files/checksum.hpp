// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace spm {

/// Hex digits of a checksum.
inline constexpr std::size_t checksum_digits = 16;

/// XXH3-64 over all of `bytes`, with the digits of the recorded checksum at `digits_at` taken as
/// '0', so that the checksum covers every byte of the file that contains it. Needs digits_at + 16
/// <= size.
[[nodiscard]] std::uint64_t file_checksum(std::span<const std::byte> bytes,
                                          std::uint64_t digits_at) noexcept;

/// The same over an open file of `size` bytes, read by pread; nothing when it cannot be read
/// completely.
[[nodiscard]] std::optional<std::uint64_t> file_checksum(int descriptor, std::uint64_t size,
                                                         std::uint64_t digits_at) noexcept;

/// 16 lower-case hex digits.
[[nodiscard]] std::string checksum_text(std::uint64_t checksum);

}  // namespace spm
