// SPDX-License-Identifier: Apache-2.0
#include "common/surface/tile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spm {

std::uint32_t pack_clip(const Clip& clip) noexcept {
  const auto whole = [](float value, float most) {
    return static_cast<std::int32_t>(std::lround(std::clamp(value, -most, most)));
  };
  const auto a = static_cast<std::uint32_t>(whole(clip.a, 127)) & 0xFFU;
  const auto b = static_cast<std::uint32_t>(whole(clip.b, 127)) & 0xFFU;
  const auto c = static_cast<std::uint32_t>(whole(clip.c * 128, 32767)) & 0xFFFFU;
  return a | b << 8U | c << 16U;
}

std::uint16_t float_to_half(float value) noexcept {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
  const auto sign = static_cast<std::uint16_t>((bits >> 16U) & 0x8000U);
  const float size = std::min(std::abs(value), 65504.0F);
  if (!(size >= 0x1p-14F)) return sign;
  // Round to nearest, ties to even, in the float's own bits.
  std::uint32_t magnitude = std::bit_cast<std::uint32_t>(size * 0x1p-112F);
  magnitude += 0xFFFU + ((magnitude >> 13U) & 1U);
  return static_cast<std::uint16_t>(sign | (magnitude >> 13U));
}

void tile_heights(const Tile& tile, float height_unit, TileHeights& heights) noexcept {
  for (std::uint32_t i = 0; i < tile_sample_count; ++i) {
    heights[i] = half_to_float(tile.heights[i]) * height_unit;
  }
  const float step_eta = tile.slope_eta * tile.spacing;
  const float step_omega = tile.slope_omega * tile.spacing;
  for (std::uint32_t j = 0; j < tile_samples; ++j) {
    const float row = static_cast<float>(j) * step_omega;
    for (std::uint32_t i = 0; i < tile_samples; ++i) {
      heights[j * tile_samples + i] += static_cast<float>(i) * step_eta + row;
    }
  }
}

void derive_bounds(Tile& tile, float height_unit) noexcept {
  TileHeights heights;
  tile_heights(tile, height_unit, heights);
  float highest = -std::numeric_limits<float>::infinity();
  float lowest = std::numeric_limits<float>::infinity();
  float ripple = 0;
  for (std::uint32_t row = 0; row < tile_cells; ++row) {
    for (std::uint32_t column = 0; column < tile_cells; ++column) {
      if (((tile.valid >> (row * tile_cells + column)) & 1U) == 0) continue;
      // The block of 2 x 2 cells that contains this cell, and the mean plane of its corners.
      const std::uint32_t left = column & ~1U, top = row & ~1U;
      const auto corner = [&](std::uint32_t i, std::uint32_t j) {
        return heights[(top + j) * tile_samples + left + i];
      };
      const float h00 = corner(0, 0), h20 = corner(2, 0), h02 = corner(0, 2), h22 = corner(2, 2);
      const float mean = (h00 + h20 + h02 + h22) / 4;
      const float per_column = (h20 - h00 + h22 - h02) / 4;
      const float per_row = (h02 - h00 + h22 - h20) / 4;
      for (std::uint32_t j = 0; j < 2; ++j) {
        for (std::uint32_t i = 0; i < 2; ++i) {
          const std::uint32_t x = column + i, y = row + j;
          const float height = heights[y * tile_samples + x];
          const float plane = mean + (static_cast<float>(x - left) - 1) * per_column +
                              (static_cast<float>(y - top) - 1) * per_row;
          ripple = std::max(ripple, std::abs(height - plane));
          const float residual = height - (static_cast<float>(x) * tile.slope_eta +
                                           static_cast<float>(y) * tile.slope_omega) *
                                              tile.spacing;
          highest = std::max(highest, residual);
          lowest = std::min(lowest, residual);
        }
      }
    }
  }
  if (highest < lowest) highest = lowest = 0;
  // The rounding of single precision must not make the bound invalid.
  const float slack = 1e-5F * (tile.spacing + std::max(std::abs(highest), std::abs(lowest)));
  tile.highest = highest + slack;
  tile.lowest = lowest - slack;
  tile.ripple = ripple + slack;
}

}  // namespace spm
