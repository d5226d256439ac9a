// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "baker/pictures/picture.hpp"

namespace spm::baker {

/// Pixels of a letter with its gap, and of a line with its gap, at the size 1.
inline constexpr std::uint32_t letter_width = 6, line_height = 10;

/// Writes into a picture from an upper left corner on, in letters of 5 x 7 dots of `size` pixels.
/// What lies outside is cut off. ASCII alone: another byte is drawn as a box.
void draw_text(Picture& picture, std::uint32_t x, std::uint32_t y, std::string_view text,
               const Colour& colour, std::uint32_t size);

/// Fills a rectangle, as far as it lies in the picture.
void fill_rectangle(Picture& picture, std::uint32_t x, std::uint32_t y, std::uint32_t width,
                    std::uint32_t height, const Colour& colour);

/// A text in lines of at most so many letters, broken between words; a longer word is cut.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, std::size_t letters);

/// A length as a person reads it, such as "50 um" or "12.5 mm"; three digits that count.
[[nodiscard]] std::string length_text(double metres);

}  // namespace spm::baker
