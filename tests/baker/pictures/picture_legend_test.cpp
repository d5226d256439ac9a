// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pictures/picture_legend.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "baker/pictures/picture_text.hpp"

namespace picture_legend_test {

using namespace spm::baker;

namespace {

Picture plain(std::uint32_t width, std::uint32_t height) {
  Picture picture{width, height, {}};
  picture.pixels.assign(std::size_t{3} * width * height, 0);
  return picture;
}

/// The pixels of a letter as rows of text.
std::vector<std::string> drawn(char letter) {
  Picture picture = plain(5, 7);
  draw_text(picture, 0, 0, std::string(1, letter), {1, 1, 1}, 1);
  std::vector<std::string> rows;
  for (std::uint32_t y = 0; y < 7; ++y) {
    std::string& row = rows.emplace_back();
    for (std::uint32_t x = 0; x < 5; ++x)
      row += picture.pixels[std::size_t{3} * (y * 5 + x)] > 0 ? '#' : '.';
  }
  return rows;
}

}  // namespace

TEST_CASE("Letters look like themselves") {
  CHECK(drawn('F') ==
        std::vector<std::string>{"#####", "#....", "#....", "####.", "#....", "#....", "#...."});
  CHECK(drawn('1') ==
        std::vector<std::string>{"..#..", ".##..", "..#..", "..#..", "..#..", "..#..", ".###."});
  CHECK(drawn('\n') == drawn('\x80'));
}

TEST_CASE("A legend stands below the picture and changes none of it") {
  Picture picture = plain(480, 20);
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    picture.pixels[i] = static_cast<std::uint8_t>(i % 251);
  }
  const Legend legend{"What is seen, in more words than fit into one line of so small a picture.",
                      ColourBar{"0", "25 um", "50 um, tolerance"},
                      {{Colour{1, 0, 0}, "more"}},
                      1e-4};
  const Picture whole = with_legend(picture, legend);
  REQUIRE(whole.width == 480);
  REQUIRE(whole.height > 100);
  CHECK(std::equal(picture.pixels.begin(), picture.pixels.end(), whole.pixels.begin()));
  CHECK(with_legend(picture, legend).pixels == whole.pixels);
  // The colours of the bar are there from its dark end to its bright one.
  const auto has = [&](const Colour& colour) {
    for (std::size_t i = 0; i + 2 < whole.pixels.size(); i += 3) {
      const auto same = [&](std::size_t part) {
        return whole.pixels[i + part] == static_cast<std::uint8_t>(std::lround(255 * colour[part]));
      };
      if (same(0) && same(1) && same(2)) return true;
    }
    return false;
  };
  CHECK(has(ramp_at(0)));
  CHECK(has(ramp_at(1)));
  CHECK(has({1, 0, 0}));
}

TEST_CASE("A tiny picture is widened for its legend") {
  CHECK(with_legend(plain(1, 1), {"nothing to show", {}, {}, 0}).width >= 200);
}

TEST_CASE("Texts are broken between words, and a word that is too long is cut") {
  CHECK(wrapped("one two three", 8) == std::vector<std::string>{"one two", "three"});
  CHECK(wrapped("abcdefghij", 4) == std::vector<std::string>{"abcd", "efgh", "ij"});
  CHECK(wrapped("", 4).empty());
}

TEST_CASE("Lengths are told in the unit that a person would take") {
  CHECK(length_text(5e-5) == "50 um");
  CHECK(length_text(0.0125) == "12.5 mm");
  CHECK(length_text(2) == "2 m");
}

}  // namespace picture_legend_test
