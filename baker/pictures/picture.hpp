// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "common/base/error.hpp"

namespace spm::baker {

/// A picture: rows from the top, three bytes a pixel.
struct Picture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> pixels;
};

/// Red, green and blue, 0 to 1.
using Colour = std::array<double, 3>;

/// Dark blue at 0 over green to pale yellow at 1.
[[nodiscard]] Colour ramp_at(double position);

/// A relief of the distance maps of one plane, seen along the plane's normal, with u to the right
/// and v upward. Each pixel shows the crossing nearest to the plane, coloured by its distance
/// (bright is near) and shaded from the upper left. Dark grey where no map of the plane
/// answers. `longest_side` in pixels.
[[nodiscard]] Picture plane_picture(const AssetView& asset, std::size_t plane,
                                    std::uint32_t longest_side);

/// The same with what its colours and its size mean.
struct PlaneRelief {
  Picture picture;
  double nearest = 0, farthest = 0;  ///< m from the plane: of the brightest and the darkest colour
  double pixel = 0;                  ///< m, the edge of a pixel; 0 where there is nothing to show
};
[[nodiscard]] PlaneRelief plane_relief(const AssetView& asset, std::size_t plane,
                                       std::uint32_t longest_side);

/// Pictures side by side in rows, each centred in a square of `side` pixels.
[[nodiscard]] Picture contact_sheet(std::span<const Picture> pictures, std::uint32_t side);

/// A picture as a PNG file's bytes; the same picture gives the same bytes. Errors: internal.
[[nodiscard]] Result<std::string> to_png(const Picture& picture);

}  // namespace spm::baker
