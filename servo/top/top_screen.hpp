// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "servo/top/top.hpp"

namespace spm::servo {

/// No screen is made narrower than this.
inline constexpr std::size_t narrowest_screen = 40;

/// What `top` shows: lines of plain ASCII, none longer than `width` columns (at least
/// `narrowest_screen`). Sentences are broken between words, rows of the table are cut.
[[nodiscard]] std::string top_screen(const TopView& view, std::size_t width);

}  // namespace spm::servo
