// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace spm::servo {

/// Copies a text into a place of fixed size. Cuts it if it is too long, and fills the rest with
/// zeros.
template <std::size_t Size>
void copy_text(char (&to)[Size], std::string_view from) noexcept {
  const std::size_t count = std::min(Size - 1, from.size());
  std::memcpy(to, from.data(), count);
  std::memset(to + count, 0, Size - count);
}

}  // namespace spm::servo
