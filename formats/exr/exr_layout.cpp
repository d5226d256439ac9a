// SPDX-License-Identifier: Apache-2.0
#include "formats/exr/exr_layout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace spm {

std::string heights_part_name(std::uint32_t layers) {
  return std::string(part_name::heights) + (layers < 10 ? "0" : "") + std::to_string(layers);
}

std::string channel_name(std::uint32_t layer) {
  return layer == 0 ? "Y" : "hit" + std::to_string(layer) + ".Y";
}

std::vector<std::string> stored_channels(std::uint32_t layers) {
  std::vector<std::string> names;
  for (std::uint32_t layer = 0; layer < layers; ++layer) names.push_back(channel_name(layer));
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::uint32_t> stored_layer_offsets(std::uint32_t layers, std::uint32_t columns) {
  const std::vector<std::string> stored = stored_channels(layers);
  std::vector<std::uint32_t> offsets(layers);
  for (std::uint32_t layer = 0; layer < layers; ++layer) {
    const auto found = std::lower_bound(stored.begin(), stored.end(), channel_name(layer));
    offsets[layer] = static_cast<std::uint32_t>(found - stored.begin()) * columns;
  }
  return offsets;
}

TileGrid arrange_tiles(std::uint32_t count, std::uint32_t tile_width, std::uint32_t tile_height) {
  constexpr double longest = 32;
  using Cost = std::tuple<double, std::uint64_t, double>;
  TileGrid best;
  Cost best_cost;
  for (std::uint32_t rows = 1; rows <= count; ++rows) {
    const std::uint32_t columns = (count + rows - 1) / rows;
    const double ratio =
        static_cast<double>(columns) * tile_width / (static_cast<double>(rows) * tile_height);
    const double aspect = std::max(ratio, 1 / ratio);
    const std::uint64_t spare = std::uint64_t{columns} * rows - count;
    const Cost cost{std::max(aspect, longest), spare, aspect};
    if (best.rows == 0 || cost < best_cost) {
      best = {columns, rows};
      best_cost = cost;
    }
  }
  return best;
}

TileGrid arrange_words(std::uint64_t count) {
  constexpr std::uint32_t widest = 1024;
  if (count <= widest) return {static_cast<std::uint32_t>(count), 1};
  TileGrid best;
  std::uint64_t best_spare = 0;
  for (std::uint32_t width = widest; width > widest / 2; --width) {
    const std::uint64_t rows = (count + width - 1) / width;
    const std::uint64_t spare = rows * width - count;
    if (best.rows == 0 || spare < best_spare) {
      best = {width, static_cast<std::uint32_t>(rows)};
      best_spare = spare;
    }
  }
  return best;
}

}  // namespace spm
