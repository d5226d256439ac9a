// SPDX-License-Identifier: Apache-2.0
#include "formats/files/checksum.hpp"

#include <unistd.h>

// Keeps the state on the stack, so that a loading thread checks a file again without allocating.
#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace spm {
namespace {

constexpr std::array<char, checksum_digits> zero_digits = [] {
  std::array<char, checksum_digits> digits{};
  digits.fill('0');
  return digits;
}();

/// Writes '0' where the window [start, start + count) contains digits of the recorded checksum.
void blank_digits(char* window, std::uint64_t start, std::uint64_t count,
                  std::uint64_t digits_at) noexcept {
  const std::uint64_t from = std::max(start, digits_at);
  const std::uint64_t to = std::min(start + count, digits_at + checksum_digits);
  for (std::uint64_t at = from; at < to; ++at) window[at - start] = '0';
}

}  // namespace

std::uint64_t file_checksum(std::span<const std::byte> bytes, std::uint64_t digits_at) noexcept {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  XXH3_64bits_update(&state, bytes.data(), digits_at);
  XXH3_64bits_update(&state, zero_digits.data(), zero_digits.size());
  const std::span<const std::byte> rest = bytes.subspan(digits_at + checksum_digits);
  XXH3_64bits_update(&state, rest.data(), rest.size());
  return XXH3_64bits_digest(&state);
}

std::optional<std::uint64_t> file_checksum(int descriptor, std::uint64_t size,
                                           std::uint64_t digits_at) noexcept {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  std::array<char, 65536> window{};
  std::uint64_t offset = 0;
  while (offset < size) {
    const std::uint64_t wanted = std::min<std::uint64_t>(window.size(), size - offset);
    const ssize_t count = ::pread(descriptor, window.data(), wanted, static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return std::nullopt;
    blank_digits(window.data(), offset, static_cast<std::uint64_t>(count), digits_at);
    XXH3_64bits_update(&state, window.data(), static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
  return XXH3_64bits_digest(&state);
}

std::string checksum_text(std::uint64_t checksum) {
  std::string text(checksum_digits, '0');
  for (std::size_t digit = checksum_digits; digit-- > 0; checksum >>= 4U) {
    text[digit] = "0123456789abcdef"[checksum & 15U];
  }
  return text;
}

}  // namespace spm
