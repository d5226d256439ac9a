// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pictures/picture.hpp"

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/query/octree_query.hpp"
#include "common/surface/distance_map.hpp"

namespace spm::baker {
namespace {

constexpr std::uint8_t background = 40;

/// Dark blue over green to pale yellow, so that lightness rises evenly and colour-blind eyes see
/// it.
constexpr std::array<Colour, 5> ramp{{{0.17, 0.17, 0.40},
                                      {0.16, 0.39, 0.53},
                                      {0.19, 0.60, 0.54},
                                      {0.57, 0.79, 0.40},
                                      {0.98, 0.92, 0.55}}};

}  // namespace

Colour ramp_at(double position) {
  const double scaled = std::clamp(position, 0.0, 1.0) * (ramp.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(scaled), ramp.size() - 2);
  const double share = scaled - static_cast<double>(low);
  Colour colour{};
  for (std::size_t i = 0; i < 3; ++i) {
    colour[i] = (1 - share) * ramp[low][i] + share * ramp[low + 1][i];
  }
  return colour;
}

namespace {

struct Extent {
  double left = std::numeric_limits<double>::infinity();
  double bottom = std::numeric_limits<double>::infinity();
  double right = -std::numeric_limits<double>::infinity();
  double top = -std::numeric_limits<double>::infinity();
};

/// Widens an extent by a rectangle from its lower left corner.
void widen(Extent& extent, double eta0, double omega0, double width, double height) {
  extent.left = std::min(extent.left, eta0);
  extent.bottom = std::min(extent.bottom, omega0);
  extent.right = std::max(extent.right, eta0 + width);
  extent.top = std::max(extent.top, omega0 + height);
}

/// Where a chart's spline is defined, on its plane.
Extent extent_of(const HeightChart& chart, const SupportPlane& plane) {
  const double spacing = chart.spacing();
  const double column = 0.5 - chart.column.at(plane.x0), row = 0.5 - chart.row.at(plane.x0);
  Extent extent;
  widen(extent, spacing * column, spacing * row, spacing * (chart.columns - 2),
        spacing * (chart.rows - 2));
  return extent;
}

Extent extent_of(const AssetView& asset, std::size_t plane) {
  Extent extent;
  for (const DistanceMap& map : asset.maps) {
    if (map.plane != plane) continue;
    widen(extent, map.eta0, map.omega0, (map.columns - 1) * map.spacing,
          (map.rows - 1) * map.spacing);
  }
  for (const HeightChart& chart : asset.charts) {
    if (chart.plane != plane || chart.offset != 0) continue;
    const Extent of = extent_of(chart, asset.planes[plane]);
    widen(extent, of.left, of.bottom, of.right - of.left, of.top - of.bottom);
  }
  return extent;
}

/// Canvas of heights: for each pixel the surface nearest to the plane.
struct Canvas {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Extent extent;
  double pitch = 0;  ///< metres a pixel
  std::vector<Height> heights;

  [[nodiscard]] double eta(std::uint32_t x) const { return extent.left + (x + 0.5) * pitch; }
  [[nodiscard]] double omega(std::uint32_t y) const { return extent.top - (y + 0.5) * pitch; }
};

/// Keeps a height where it is nearer to the plane than the height that the pixel shows.
void show(Height& pixel, const Height& found) {
  if (std::isfinite(found.value) && found.value < pixel.value) pixel = found;
}

/// Calls `visit` with the pixels that a rectangle may cover, and their places on the plane.
template <class Visit>
void visit_pixels(Canvas& canvas, double eta0, double omega0, double width, double height,
                  const Visit& visit) {
  const auto first = [&](double offset) {
    return static_cast<std::uint32_t>(std::max(0.0, std::floor(offset / canvas.pitch)));
  };
  const std::uint32_t x0 = first(eta0 - canvas.extent.left);
  const std::uint32_t y0 = first(canvas.extent.top - omega0 - height);
  const std::uint32_t x1 = std::min(canvas.width, first(eta0 + width - canvas.extent.left) + 1);
  const std::uint32_t y1 = std::min(canvas.height, first(canvas.extent.top - omega0) + 1);
  for (std::uint32_t y = y0; y < y1; ++y) {
    for (std::uint32_t x = x0; x < x1; ++x) {
      visit(canvas.heights[std::size_t{y} * canvas.width + x], canvas.eta(x), canvas.omega(y));
    }
  }
}

void draw_map(Canvas& canvas, const DistanceMap& map) {
  visit_pixels(canvas, map.eta0, map.omega0, (map.columns - 1) * map.spacing,
               (map.rows - 1) * map.spacing, [&map](Height& pixel, double eta, double omega) {
                 const MapCell cell = locate(map, eta, omega);
                 if (!cell.inside) return;
                 for (std::uint32_t layer = 0; layer < map.layers; ++layer) {
                   if (!map.cell_valid(layer, cell.column, cell.row)) continue;
                   show(pixel, height_at(map, layer, cell));
                 }
               });
}

/// Whether a place on a chart is surface by the asset's answers, and by that chart.
bool is_shown_by(const AssetView& asset, std::uint32_t chart, const Vector3& place) {
  const Leaf leaf = leaf_at(asset.octree, place);
  const std::uint32_t* words = words_at(asset.octree, leaf);
  if (leaf.kind != OctreeKind::map || words == nullptr) return false;
  const NamedMaps maps(words[0]);
  if (maps.first != chart && maps.second_from_one != chart + 1) return false;
  return std::abs(query_leaf(asset, leaf, place).distance) <= asset.tolerance;
}

void draw_chart(Canvas& canvas, const AssetView& asset, std::uint32_t number) {
  const HeightChart& chart = asset.charts[number];
  const SupportPlane& plane = asset.planes[chart.plane];
  const Extent of = extent_of(chart, plane);
  visit_pixels(
      canvas, of.left, of.bottom, of.right - of.left, of.top - of.bottom,
      [&](Height& pixel, double eta, double omega) {
        const Vector3 on_plane = support_plane_point(plane, eta, omega);
        MapContact contact;
        if (!contact_on(chart, on_plane, contact)) return;
        // S_SP is 0 on the plane.
        const Height height{-contact.penetration, contact.normal.dot(plane.u),
                            contact.normal.dot(plane.v)};
        if (!is_shown_by(asset, number, reconstructed_surface(plane, eta, omega, height.value)))
          return;
        show(pixel, height);
      });
}

/// Light on a surface of that slope, which comes from the upper left of the picture and above.
double shade(const Height& height) {
  const Vector3 normal = Vector3(height.d_eta, height.d_omega, 1).normalized();
  static const Vector3 light = Vector3(-1, 1, 2).normalized();
  return 0.35 + 0.65 * std::max(0.0, normal.dot(light));
}

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255));
}

void append_to(png_structp png, png_bytep data, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}

}  // namespace

namespace {

/// The surface nearest to the plane, pixel by pixel; `pitch` is 0 where there is none.
Canvas canvas_of(const AssetView& asset, std::size_t plane, std::uint32_t longest_side) {
  Canvas canvas;
  canvas.extent = extent_of(asset, plane);
  const double width = canvas.extent.right - canvas.extent.left;
  const double height = canvas.extent.top - canvas.extent.bottom;
  if (!(width > 0) || !(height > 0)) return canvas;
  canvas.pitch = std::max(width, height) / longest_side;
  canvas.width = std::max(1U, static_cast<std::uint32_t>(std::lround(width / canvas.pitch)));
  canvas.height = std::max(1U, static_cast<std::uint32_t>(std::lround(height / canvas.pitch)));
  Height none;
  none.value = std::numeric_limits<double>::infinity();
  canvas.heights.assign(std::size_t{canvas.width} * canvas.height, none);
  for (const DistanceMap& map : asset.maps) {
    if (map.plane == plane) draw_map(canvas, map);
  }
  for (std::uint32_t i = 0; i < asset.charts.size(); ++i) {
    const HeightChart& chart = asset.charts[i];
    // An offset surface is not what is felt.
    if (chart.plane == plane && chart.offset == 0) draw_chart(canvas, asset, i);
  }
  return canvas;
}

}  // namespace

PlaneRelief plane_relief(const AssetView& asset, std::size_t plane, std::uint32_t longest_side) {
  const Canvas canvas = canvas_of(asset, plane, longest_side);
  if (canvas.pitch == 0) return {{1, 1, {background, background, background}}};
  double nearest = std::numeric_limits<double>::infinity();
  double farthest = -nearest;
  for (const Height& pixel : canvas.heights) {
    if (!std::isfinite(pixel.value)) continue;
    nearest = std::min(nearest, pixel.value);
    farthest = std::max(farthest, pixel.value);
  }
  Picture picture{canvas.width, canvas.height, {}};
  picture.pixels.reserve(3 * canvas.heights.size());
  for (const Height& pixel : canvas.heights) {
    if (!std::isfinite(pixel.value)) {
      picture.pixels.insert(picture.pixels.end(), 3, background);
      continue;
    }
    const double depth = farthest > nearest ? (pixel.value - nearest) / (farthest - nearest) : 0;
    for (const double part : ramp_at(1 - depth))
      picture.pixels.push_back(to_byte(part * shade(pixel)));
  }
  if (nearest > farthest) nearest = farthest = 0;
  return {std::move(picture), nearest, farthest, canvas.pitch};
}

Picture plane_picture(const AssetView& asset, std::size_t plane, std::uint32_t longest_side) {
  return plane_relief(asset, plane, longest_side).picture;
}

Picture contact_sheet(std::span<const Picture> pictures, std::uint32_t side) {
  const auto columns =
      static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(pictures.size()))));
  const std::uint32_t pitch = side + 4;
  const auto rows = static_cast<std::uint32_t>((pictures.size() + columns - 1) / columns);
  Picture sheet{columns * pitch, rows * pitch, {}};
  sheet.pixels.assign(std::size_t{3} * sheet.width * sheet.height, background / 2);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Picture& picture = pictures[i];
    const std::uint32_t width = std::min(picture.width, side);
    const std::uint32_t x0 = static_cast<std::uint32_t>(i % columns) * pitch + (pitch - width) / 2;
    const std::uint32_t height = std::min(picture.height, side);
    const std::uint32_t y0 = static_cast<std::uint32_t>(i / columns) * pitch + (pitch - height) / 2;
    for (std::uint32_t y = 0; y < height; ++y) {
      const auto from = picture.pixels.begin() + std::ptrdiff_t{3} * y * picture.width;
      std::copy(
          from, from + std::ptrdiff_t{3} * width,
          sheet.pixels.begin() + std::ptrdiff_t{3} * (std::ptrdiff_t{y0 + y} * sheet.width + x0));
    }
  }
  return sheet;
}

Result<std::string> to_png(const Picture& picture) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return fail(ExitCode::internal, "the picture cannot be encoded as PNG");
  }
  png_set_write_fn(png, &bytes, append_to, nullptr);
  png_set_compression_level(png, Z_BEST_COMPRESSION);
  png_set_IHDR(png, info, picture.width, picture.height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    png_write_row(png, picture.pixels.data() + std::size_t{3} * y * picture.width);
  }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

}  // namespace spm::baker
