// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/charts/atlas.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

namespace spm::baker {

namespace {

constexpr std::uint64_t word_bits = 64;
/// A chart whose box is so many times its heights, and so much more, is parted.
constexpr std::uint64_t worth_parting = 2, least_parted = 64;
constexpr std::array<std::uint32_t, 8> widths{32, 64, 96, 128, 192, 256, 512, 1024};
constexpr std::uint32_t max_height = 4096;

/// A shape of heights: for each row the bits of its columns, from the first column of all.
struct Shape {
  std::uint32_t columns = 0;
  std::vector<std::vector<std::uint64_t>> rows;
  std::uint64_t count = 0;
};

struct Spot {
  std::uint32_t column = 0, row = 0;
};

/// A picture that fills with shapes.
class Picture {
 public:
  explicit Picture(std::uint32_t width) : width_(width), words_(width / word_bits + 2) {}

  /// Puts a shape where it first fits, row by row from the top: behind the last one like it.
  Spot put(const Shape& shape) {
    Spot& spot = last_[shape.rows];
    if (spot.row < first_row_) spot = {0, first_row_};
    for (;; spot = {0, spot.row + 1}) {
      while (spot.column + shape.columns <= width_) {
        const std::uint32_t shift = spot.column % word_bits;
        const std::uint64_t fitting = ~taken_for(shape, spot.column - shift, spot.row) >> shift;
        spot.column += fitting != 0 ? static_cast<std::uint32_t>(std::countr_zero(fitting))
                                    : static_cast<std::uint32_t>(word_bits) - shift;
        if (fitting == 0 || spot.column + shape.columns > width_) continue;
        fill(shape, spot.column, spot.row);
        return spot;
      }
    }
  }

 private:
  std::uint32_t width_;
  std::size_t words_;
  std::vector<std::vector<std::uint64_t>> taken_;
  std::uint32_t first_row_ = 0;  ///< rows before it are full
  std::map<std::vector<std::vector<std::uint64_t>>, Spot> last_;

  /// The bits of those columns, from one on that a word begins with, at which a shape does not fit
  /// in a row.
  [[nodiscard]] std::uint64_t taken_for(const Shape& shape, std::uint32_t column,
                                        std::uint32_t row) const {
    std::uint64_t taken = 0;
    for (std::size_t r = 0; r < shape.rows.size() && row + r < taken_.size(); ++r) {
      for (std::size_t k = 0; k < shape.rows[r].size(); ++k) {
        const std::size_t word = column / word_bits + k;
        if (word + 1 >= taken_[row + r].size()) break;
        const std::uint64_t low = taken_[row + r][word], high = taken_[row + r][word + 1];
        for (std::uint64_t bits = shape.rows[r][k]; bits != 0; bits &= bits - 1) {
          const int bit = std::countr_zero(bits);
          taken |= low >> bit | (bit == 0 ? 0 : high << (word_bits - static_cast<unsigned>(bit)));
          if (~taken == 0) return taken;
        }
      }
    }
    return taken;
  }

  void fill(const Shape& shape, std::uint32_t column, std::uint32_t row) {
    const std::size_t word = column / word_bits;
    const unsigned shift = column % word_bits;
    while (taken_.size() < row + shape.rows.size()) {
      taken_.emplace_back(words_ + 1, 0);
    }
    for (std::size_t r = 0; r < shape.rows.size(); ++r) {
      auto& taken = taken_[row + r];
      const auto& bits = shape.rows[r];
      for (std::size_t k = 0; k < bits.size(); ++k) {
        taken[word + k] |= bits[k] << shift;
        if (shift != 0) taken[word + k + 1] |= bits[k] >> (word_bits - shift);
      }
    }
    while (first_row_ < taken_.size() && is_full(taken_[first_row_])) ++first_row_;
  }

  [[nodiscard]] bool is_full(const std::vector<std::uint64_t>& taken) const {
    for (std::uint32_t column = 0; column < width_; ++column) {
      if ((taken[column / word_bits] >> (column % word_bits) & 1U) == 0) return false;
    }
    return true;
  }
};

/// Where shapes lie in a picture of a width, by number; the largest are put first.
struct Layout {
  std::uint32_t width = 0, height = 0;
  std::vector<Spot> spots;
};

Layout arrange(const std::vector<Shape>& shapes, std::uint32_t width) {
  std::vector<std::size_t> order(shapes.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::max<std::size_t>(shapes[a].rows.size(), shapes[a].columns) >
           std::max<std::size_t>(shapes[b].rows.size(), shapes[b].columns);
  });
  Picture picture(width);
  Layout layout{width, 0, std::vector<Spot>(shapes.size())};
  for (const std::size_t i : order) layout.spots[i] = picture.put(shapes[i]);
  // One more height may be read behind the last of each.
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Spot& spot = layout.spots[i];
    const auto rows = static_cast<std::uint32_t>(shapes[i].rows.size());
    const bool to_the_end = spot.column + shapes[i].columns == width;
    layout.height = std::max(layout.height, spot.row + rows + (to_the_end ? 1 : 0));
  }
  return layout;
}

/// The smallest picture of several widths, the first of equals: up to nine times as high as wide.
Layout arrange(const std::vector<Shape>& shapes) {
  std::uint32_t widest = 0;
  std::uint64_t heights = 0;
  for (const Shape& shape : shapes) {
    widest = std::max(widest, shape.columns);
    heights += shape.count;
  }
  const double square = std::sqrt(static_cast<double>(heights));
  std::optional<Layout> best;
  for (const std::uint32_t width : widths) {
    if (width != widths.back() &&
        (width < widest || width < square / 3 || (best && width > square)))
      continue;
    if (best && width == widths.back()) break;
    // HALF samples of rows of so many take whole words.
    Layout next = arrange(shapes, std::max(width, (widest + 3) / 4 * 4));
    // No picture is so long that no viewer shows it.
    if (next.height > max_height && width != widths.back()) continue;
    if (!best ||
        std::uint64_t{next.width} * next.height < std::uint64_t{best->width} * best->height) {
      best = std::move(next);
    }
  }
  return *best;
}

}  // namespace

void Atlas::need(const ChartAtLevel& chart, const Vector3& middle, double half) {
  const HeightRange range = ChartField(heights_, chart).range_over(middle, half);
  const HeightGrid& grid = heights_.of(chart);
  const auto [found, fresh] = needed_.try_emplace(chart);
  Needed& needed = found->second;
  if (fresh) {
    needed.parts.assign(grid.rows, std::vector<std::uint32_t>(grid.columns, 0));
    needed.box = range;
  }
  needed.box.meet(range);
  for (std::int64_t row = range.row_from; row <= range.row_to; ++row) {
    auto& parts = needed.parts[static_cast<std::size_t>(row)];
    for (std::int64_t column = range.column_from; column <= range.column_to; ++column) {
      parts[static_cast<std::size_t>(column)] = 1;
    }
  }
}

std::uint32_t Atlas::number(const ChartAtLevel& chart, const Vector3& middle, double half) const {
  const HeightRange range = ChartField(heights_, chart).range_over(middle, half);
  const Needed& needed = needed_.at(chart);
  return needed.first +
         needed.parts[static_cast<std::size_t>(range.row_from)]
                     [static_cast<std::size_t>(range.column_from)] -
         1;
}

std::uint32_t Atlas::find_parts(Needed& needed) {
  std::uint64_t count = 0;
  for (const auto& row : needed.parts) {
    for (const std::uint32_t part : row) count += part;
  }
  if (needed.box.count() <= worth_parting * count + least_parted) return 1;
  std::uint32_t parts = 1;
  std::vector<std::array<std::int64_t, 2>> open;
  for (std::int64_t row = needed.box.row_from; row <= needed.box.row_to; ++row) {
    for (std::int64_t column = needed.box.column_from; column <= needed.box.column_to; ++column) {
      const auto meet = [&](std::int64_t at_column, std::int64_t at_row) {
        if (!needed.box.has(at_column, at_row)) return;
        std::uint32_t& part =
            needed.parts[static_cast<std::size_t>(at_row)][static_cast<std::size_t>(at_column)];
        if (part != 1) return;
        part = parts + 1;
        open.push_back({at_column, at_row});
      };
      meet(column, row);
      if (open.empty()) continue;
      while (!open.empty()) {
        const auto [at_column, at_row] = open.back();
        open.pop_back();
        meet(at_column - 1, at_row);
        meet(at_column + 1, at_row);
        meet(at_column, at_row - 1);
        meet(at_column, at_row + 1);
      }
      ++parts;
    }
  }
  // They were counted from 2 on.
  for (auto& row : needed.parts) {
    for (std::uint32_t& part : row) part -= part > 0 ? 1U : 0U;
  }
  return parts - 1;
}

AtlasData Atlas::lay_out(std::vector<SupportPlane>& planes) {
  AtlasData atlas;
  atlas.spacing = heights_.spacing(0);
  atlas.halves = heights_.halves();
  atlas.offset = heights_.offset({.offset = true});
  std::map<std::uint32_t, std::uint32_t> rows_of_planes;
  std::vector<Shape> shapes;
  std::vector<HeightRange> boxes;
  for (auto& [at, needed] : needed_) {
    const PlaneChart& known = heights_.charts().charts()[at.chart];
    const auto [plane, fresh] =
        rows_of_planes.try_emplace(known.plane, static_cast<std::uint32_t>(planes.size()));
    if (fresh) planes.push_back(heights_.planes()[known.plane]);
    const HeightGrid& grid = heights_.of(at);
    needed.first = static_cast<std::uint32_t>(shapes.size());
    const std::uint32_t parts = find_parts(needed);
    boxes.resize(boxes.size() + parts);
    for (std::int64_t row = needed.box.row_from; row <= needed.box.row_to; ++row) {
      for (std::int64_t column = needed.box.column_from; column <= needed.box.column_to; ++column) {
        const std::uint32_t part =
            needed.parts[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
        if (part > 0) boxes[needed.first + part - 1].meet({column, column, row, row});
      }
    }
    for (std::uint32_t part = 1; part <= parts; ++part) {
      const HeightRange& box = boxes[needed.first + part - 1];
      ChartData& data = atlas.charts.emplace_back();
      data.plane = plane->second;
      data.level = at.level;
      data.offset = at.offset;
      data.base = grid.base;
      data.column0 = grid.column0 + static_cast<std::int32_t>(box.column_from);
      data.row0 = grid.row0 + static_cast<std::int32_t>(box.row_from);
      data.columns = static_cast<std::uint32_t>(box.column_to - box.column_from + 1);
      data.rows = static_cast<std::uint32_t>(box.row_to - box.row_from + 1);
      Shape& shape = shapes.emplace_back();
      shape.columns = data.columns;
      for (std::uint32_t row = 0; row < data.rows; ++row) {
        auto& bits = shape.rows.emplace_back((data.columns + word_bits - 1) / word_bits, 0);
        const auto& from = needed.parts[static_cast<std::size_t>(box.row_from) + row];
        for (std::uint32_t column = 0; column < data.columns; ++column) {
          if (from[static_cast<std::size_t>(box.column_from) + column] != part) continue;
          bits[column / word_bits] |= std::uint64_t{1} << (column % word_bits);
          ++shape.count;
        }
      }
    }
  }
  if (shapes.empty()) return atlas;
  const Layout layout = arrange(shapes);
  atlas.width = layout.width;
  atlas.heights.assign(std::size_t{layout.width} * layout.height, 0);
  for (const auto& [at, needed] : needed_) {
    const HeightGrid& grid = heights_.of(at);
    for (std::int64_t row = needed.box.row_from; row <= needed.box.row_to; ++row) {
      for (std::int64_t column = needed.box.column_from; column <= needed.box.column_to; ++column) {
        const std::uint32_t part =
            needed.parts[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
        if (part == 0) continue;
        const std::size_t which = needed.first + part - 1;
        const Spot& spot = layout.spots[which];
        const auto x = static_cast<std::size_t>(column - boxes[which].column_from) + spot.column;
        const auto y = static_cast<std::size_t>(row - boxes[which].row_from) + spot.row;
        atlas.heights[y * layout.width + x] = grid.at(column, row);
      }
    }
  }
  for (std::size_t which = 0; which < shapes.size(); ++which) {
    atlas.charts[which].first = layout.spots[which].row * layout.width + layout.spots[which].column;
  }
  return atlas;
}

}  // namespace spm::baker
