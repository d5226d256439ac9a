// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pictures/picture_legend.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "baker/pictures/picture_text.hpp"

namespace spm::baker {

namespace {

constexpr Colour ground{0.09, 0.10, 0.11}, ink{0.93, 0.93, 0.93};
constexpr std::uint32_t narrowest = 240;  ///< pixels: a smaller picture is widened for its legend
constexpr std::uint32_t wide = 400;       ///< pixels, from which on letters are twice as large
constexpr std::uint32_t edge = 8, bar_height = 12;
constexpr double longest_scale = 0.22;  ///< of the picture's width

/// Writes from the top down; first without a picture, to know its height.
class Sheet {
 public:
  Sheet(Picture* picture, std::uint32_t width, std::uint32_t top)
      : picture_(picture), width_(width), size_(width >= wide ? 2 : 1), y_(top + edge) {}

  [[nodiscard]] std::uint32_t size() const noexcept { return size_; }
  [[nodiscard]] std::uint32_t y() const noexcept { return y_; }
  [[nodiscard]] std::uint32_t width_of(const std::string& text) const {
    return static_cast<std::uint32_t>(text.size()) * letter_width * size_;
  }
  void text(std::uint32_t x, const std::string& words) {
    if (picture_ != nullptr) draw_text(*picture_, x, y_, words, ink, size_);
  }
  void fill(std::uint32_t x, std::uint32_t down, std::uint32_t across, std::uint32_t high,
            const Colour& colour) {
    if (picture_ != nullptr) fill_rectangle(*picture_, x, y_ + down, across, high, colour);
  }
  void next(std::uint32_t height) { y_ += height; }
  void next_line() { next(line_height * size_); }

  void bar(const ColourBar& bar) {
    const std::uint32_t across = width_ - 2 * edge;
    for (std::uint32_t x = 0; x < across; ++x) {
      fill(edge + x, 0, 1, bar_height, ramp_at(double(x) / std::max(1U, across - 1)));
    }
    next(bar_height + 4);
    const std::uint32_t low = width_of(bar.low), middle = width_of(bar.middle),
                        high = width_of(bar.high), gap = letter_width * size_;
    text(edge, bar.low);
    text(width_ - edge - std::min(width_ - edge, high), bar.high);
    const std::uint32_t half = across / 2;
    if (middle / 2 + std::max(low, high) + gap < half) text(edge + half - middle / 2, bar.middle);
    next_line();
  }

  void keys(const std::vector<std::pair<Colour, std::string>>& keys) {
    if (keys.empty()) return;
    std::uint32_t x = edge;
    const std::uint32_t block = 7 * size_;
    for (const auto& [colour, words] : keys) {
      const std::uint32_t needed = block + 4 * size_ + width_of(words);
      if (x > edge && x + needed > width_ - edge) {
        next_line();
        x = edge;
      }
      fill(x, 0, block, block, colour);
      text(x + block + 4 * size_, words);
      x += needed + 10 * size_;
    }
    next_line();
  }

  /// A line of a round length, with its length beside it.
  void scale(double pixel) {
    const double most = longest_scale * width_ * pixel;
    const double power = std::pow(10, std::floor(std::log10(most)));
    const double round = most >= 5 * power ? 5 * power : most >= 2 * power ? 2 * power : power;
    const auto across = static_cast<std::uint32_t>(std::lround(round / pixel));
    const std::uint32_t middle = 3 * size_;
    fill(edge, middle, across, size_, ink);
    fill(edge, 0, size_, 7 * size_, ink);
    fill(edge + across - size_, 0, size_, 7 * size_, ink);
    text(edge + across + 6 * size_, length_text(round));
    next_line();
  }

 private:
  Picture* picture_;
  std::uint32_t width_, size_, y_;
};

void write(Sheet& sheet, const Legend& legend, std::uint32_t width) {
  const std::size_t letters = (width - 2 * edge) / (letter_width * sheet.size());
  for (const std::string& line : wrapped(legend.caption, letters)) {
    sheet.text(edge, line);
    sheet.next_line();
  }
  sheet.next(4);
  if (legend.bar) sheet.bar(*legend.bar);
  sheet.keys(legend.keys);
  if (legend.pixel > 0) sheet.scale(legend.pixel);
}

}  // namespace

Picture with_legend(const Picture& picture, const Legend& legend) {
  const std::uint32_t width = std::max(picture.width, narrowest);
  Sheet measured(nullptr, width, picture.height);
  write(measured, legend, width);
  Picture whole{width, measured.y() + edge / 2, {}};
  whole.pixels.resize(std::size_t{3} * whole.width * whole.height);
  fill_rectangle(whole, 0, 0, whole.width, whole.height, ground);
  const std::uint32_t left = (width - picture.width) / 2;
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    const auto from = picture.pixels.begin() + std::ptrdiff_t{3} * y * picture.width;
    std::copy(from, from + std::ptrdiff_t{3} * picture.width,
              whole.pixels.begin() + std::ptrdiff_t{3} * (std::ptrdiff_t{y} * width + left));
  }
  Sheet sheet(&whole, width, picture.height);
  write(sheet, legend, width);
  return whole;
}

}  // namespace spm::baker
