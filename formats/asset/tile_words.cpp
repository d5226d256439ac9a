// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/tile_words.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace spm {
namespace {

constexpr std::uint64_t all_cells = ~std::uint64_t{0};
constexpr std::uint32_t partly_valid = 1U << 24U;
constexpr std::uint32_t has_clips = 1U << 25U;
constexpr std::uint32_t known_bits = (1U << 26U) - 1;

/// Puts a tile at its place on the lattice of its level.
void place(Tile& tile, std::uint32_t level, std::int32_t column, std::int32_t row,
           double tile_spacing) noexcept {
  tile.spacing = static_cast<float>(std::ldexp(tile_spacing, -static_cast<int>(level)));
  const double stride = tile_stride * static_cast<double>(tile.spacing);
  tile.eta0 = column * stride;
  tile.omega0 = row * stride;
}

bool is_half(float value) noexcept {
  return std::isfinite(value) && half_to_float(float_to_half(value)) == value;
}

bool fits_16_bits(std::int32_t value) noexcept { return value == static_cast<std::int16_t>(value); }

std::uint32_t pack_halves(std::uint32_t low, std::uint32_t high) noexcept {
  return (low & 0xFFFFU) | high << 16U;
}

void append_long(std::vector<std::uint32_t>& words, std::uint64_t value) {
  words.push_back(static_cast<std::uint32_t>(value));
  words.push_back(static_cast<std::uint32_t>(value >> 32U));
}

/// Reads the words of `grid_masks` one after the other.
class Stream {
 public:
  explicit Stream(std::span<const std::uint32_t> words) : words_(words) {}

  /// The next `count` words; null where fewer are left.
  const std::uint32_t* take(std::size_t count) noexcept {
    if (count > words_.size() - at_) return nullptr;
    at_ += count;
    return words_.data() + at_ - count;
  }
  bool take_long(std::uint64_t& value) noexcept {
    const std::uint32_t* words = take(2);
    if (words != nullptr) value = words[0] | std::uint64_t{words[1]} << 32U;
    return words != nullptr;
  }
  [[nodiscard]] std::size_t taken() const noexcept { return at_; }

 private:
  std::span<const std::uint32_t> words_;
  std::size_t at_ = 0;
};

/// Reads the masks of a tile from `masks`. Returns the error, or nothing.
const char* read_masks(std::uint32_t flags, Stream& masks, Tile& tile) noexcept {
  tile.valid = all_cells;
  const bool whole = ((flags & partly_valid) == 0 || masks.take_long(tile.valid)) &&
                     ((flags & has_clips) == 0 || masks.take_long(tile.clipped));
  if (!whole) return "has masks that are cut short";
  if ((tile.clipped & ~tile.valid) != 0) return "clips cells that are not valid";
  if (tile.clipped == 0) return nullptr;
  tile.clips = masks.take(static_cast<std::size_t>(std::popcount(tile.clipped)));
  return tile.clips == nullptr ? "has clips that are cut short" : nullptr;
}

/// Reads the words of a tile. Returns the error, or nothing.
const char* read_tile(const std::uint32_t* words, double tile_spacing, std::size_t planes,
                      Tile& tile) noexcept {
  const std::uint32_t level = (words[0] >> 12U) & 0xFU;
  if ((words[0] & ~known_bits) != 0) return "has bits of no meaning";
  tile.plane = words[0] & (max_tile_planes - 1);
  tile.first_layer = (words[0] >> 16U) & (max_tile_layers - 1);
  if (tile.plane >= planes) return "names a plane that does not exist";
  if (level >= max_tile_levels) return "has a level that does not exist";
  place(tile, level, static_cast<std::int16_t>(words[1] & 0xFFFFU),
        static_cast<std::int16_t>(words[1] >> 16U), tile_spacing);
  const auto base = std::bit_cast<float>(words[2]);
  const auto slope_eta = static_cast<std::uint16_t>(words[3] & 0xFFFFU);
  const auto slope_omega = static_cast<std::uint16_t>(words[3] >> 16U);
  if (!std::isfinite(base) || !half_is_finite(slope_eta) || !half_is_finite(slope_omega)) {
    return "has a base or a slope that is not a number";
  }
  tile.base = static_cast<double>(base);
  tile.slope_eta = half_to_float(slope_eta);
  tile.slope_omega = half_to_float(slope_omega);
  return nullptr;
}

}  // namespace

TileWords words_of(const std::vector<TileData>& tiles) {
  TileWords words;
  words.tiles.reserve(tiles.size() * tile_words);
  for (const TileData& tile : tiles) {
    const std::uint32_t flags =
        (tile.valid != all_cells ? partly_valid : 0U) | (tile.clipped != 0 ? has_clips : 0U);
    words.tiles.push_back(tile.plane | tile.level << 12U | tile.first_layer << 16U | flags);
    words.tiles.push_back(
        pack_halves(static_cast<std::uint32_t>(tile.column), static_cast<std::uint32_t>(tile.row)));
    words.tiles.push_back(std::bit_cast<std::uint32_t>(tile.base));
    words.tiles.push_back(
        pack_halves(float_to_half(tile.slope_eta), float_to_half(tile.slope_omega)));
    if (tile.valid != all_cells) append_long(words.masks, tile.valid);
    if (tile.clipped == 0) continue;
    append_long(words.masks, tile.clipped);
    words.masks.insert(words.masks.end(), tile.clips.begin(), tile.clips.end());
  }
  return words;
}

Tile tile_over(const TileData& data, double tile_spacing) noexcept {
  Tile tile;
  tile.heights = data.heights.data();
  tile.clips = data.clips.data();
  tile.valid = data.valid;
  tile.clipped = data.clipped;
  tile.base = static_cast<double>(data.base);
  tile.slope_eta = data.slope_eta;
  tile.slope_omega = data.slope_omega;
  tile.plane = data.plane;
  tile.first_layer = data.first_layer;
  place(tile, data.level, data.column, data.row, tile_spacing);
  return tile;
}

std::string tile_problem(const TileData& tile, std::size_t planes) {
  if (tile.plane >= planes || tile.plane >= max_tile_planes) return "has no plane";
  if (tile.level >= max_tile_levels || tile.first_layer >= max_tile_layers ||
      !fits_16_bits(tile.column) || !fits_16_bits(tile.row)) {
    return "has a place that cannot be stored";
  }
  if (!std::isfinite(tile.base) || !is_half(tile.slope_eta) || !is_half(tile.slope_omega)) {
    return "has a base or a slope that cannot be stored";
  }
  if ((tile.clipped & ~tile.valid) != 0 ||
      tile.clips.size() != static_cast<std::size_t>(std::popcount(tile.clipped))) {
    return "has clips that do not fit its cells";
  }
  if (!std::all_of(tile.heights.begin(), tile.heights.end(), half_is_finite)) {
    return "has heights that are not numbers";
  }
  return {};
}

TilesRead read_tiles(std::span<const std::uint32_t> words, std::span<const std::uint32_t> masks,
                     double tile_spacing, std::size_t planes) {
  TilesRead read;
  read.tiles.resize(words.size() / tile_words);
  Stream stream(masks);
  for (std::size_t index = 0; index < read.tiles.size(); ++index) {
    const std::uint32_t* own = words.data() + index * tile_words;
    Tile& tile = read.tiles[index];
    const char* problem = read_tile(own, tile_spacing, planes, tile);
    if (problem == nullptr) problem = read_masks(own[0], stream, tile);
    if (problem == nullptr) continue;
    read.problem = "tile " + std::to_string(index) + " " + problem;
    return read;
  }
  read.mask_words = stream.taken();
  return read;
}

}  // namespace spm
