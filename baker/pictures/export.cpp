// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pictures/export.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "baker/pictures/grid_walk.hpp"
#include "baker/tiles/tile_cells.hpp"
#include "common/surface/distance_map.hpp"

namespace spm::baker {
namespace {

constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();

/// A place in a cell of a tile, measured from its middle, in cells.
using Corner = std::array<double, 2>;
/// The corners of a cell, anticlockwise seen from the plane's side, and their samples.
constexpr std::array<Corner, 4> square{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};
constexpr std::array<std::uint32_t, 4> square_samples{0, 1, tile_samples + 1, tile_samples};

/// The part of a cell on the valid side of a line: a convex polygon, or empty.
std::vector<Corner> clipped_square(const Clip& clip) {
  std::vector<Corner> corners;
  for (std::size_t k = 0; k < square.size(); ++k) {
    const Corner& from = square[k];
    const Corner& to = square[(k + 1) % square.size()];
    const double before = beyond_clip(clip, from[0], from[1]);
    const double after = beyond_clip(clip, to[0], to[1]);
    if (before <= 0) corners.push_back(from);
    if ((before < 0 && after > 0) || (before > 0 && after < 0)) {
      const double share = before / (before - after);
      corners.push_back({from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])});
    }
  }
  return corners;
}

class SurfaceBuilder {
 public:
  [[nodiscard]] std::uint32_t add_vertex(const Vector3& position) {
    surface_.vertices.push_back({static_cast<float>(position.x()), static_cast<float>(position.y()),
                                 static_cast<float>(position.z())});
    return static_cast<std::uint32_t>(surface_.vertices.size() - 1);
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool turned) {
    if (turned) std::swap(b, c);
    surface_.triangles.push_back({a, b, c});
  }

  /// The valid cells of one layer of a map.
  void add_layer(const SupportPlane& plane, const DistanceMap& map, std::uint32_t layer) {
    std::vector<std::uint32_t> ids(std::size_t{map.columns} * map.rows, unused);
    const auto id_at = [&](std::uint32_t column, std::uint32_t row) {
      std::uint32_t& id = ids[std::size_t{row} * map.columns + column];
      if (id == unused) {
        id = add_vertex(reconstructed_surface(plane, map.eta0 + column * map.spacing,
                                              map.omega0 + row * map.spacing,
                                              double{map.at(layer, column, row)}));
      }
      return id;
    };
    // Odd crossings are exits; their outside faces away from the plane.
    const bool turned = (map.first_layer + layer) % 2 == 1;
    for (std::uint32_t row = 0; row + 1 < map.rows; ++row) {
      for (std::uint32_t column = 0; column + 1 < map.columns; ++column) {
        const bool finite = std::isfinite(map.at(layer, column, row)) &&
                            std::isfinite(map.at(layer, column + 1, row)) &&
                            std::isfinite(map.at(layer, column, row + 1)) &&
                            std::isfinite(map.at(layer, column + 1, row + 1));
        if (!finite || !map.cell_valid(layer, column, row)) continue;
        const std::uint32_t a = id_at(column, row);
        const std::uint32_t b = id_at(column + 1, row);
        const std::uint32_t c = id_at(column + 1, row + 1);
        const std::uint32_t d = id_at(column, row + 1);
        add_triangle(a, b, c, turned);
        add_triangle(a, c, d, turned);
      }
    }
  }

  /// The valid cells of a tile, clipped ones up to their line.
  void add_tile(const SupportPlane& plane, const Tile& tile, float height_unit) {
    TileHeights heights;
    tile_heights(tile, height_unit, heights);
    const auto spacing = static_cast<double>(tile.spacing);
    const auto vertex = [&](std::uint32_t cell, const Corner& corner) {
      const std::uint32_t column = cell % tile_cells, row = cell / tile_cells;
      const double eta = tile.eta0 + (column + 0.5 + corner[0]) * spacing;
      const double omega = tile.omega0 + (row + 0.5 + corner[1]) * spacing;
      const double depth = height_at(tile, heights, cell, corner[0], corner[1]).value;
      return add_vertex(reconstructed_surface(plane, eta, omega, depth));
    };
    std::array<std::uint32_t, tile_sample_count> ids{};
    ids.fill(unused);
    for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
      if (((tile.valid >> cell) & 1U) == 0) continue;
      std::vector<std::uint32_t> outline;
      if (const std::optional<Clip> clip = clip_of(tile, cell)) {
        for (const Corner& corner : clipped_square(*clip)) outline.push_back(vertex(cell, corner));
      } else {
        const std::uint32_t first = cell / tile_cells * tile_samples + cell % tile_cells;
        for (std::size_t k = 0; k < square.size(); ++k) {
          std::uint32_t& id = ids[first + square_samples[k]];
          if (id == unused) id = vertex(cell, square[k]);
          outline.push_back(id);
        }
      }
      for (std::size_t k = 2; k < outline.size(); ++k) {
        add_triangle(outline[0], outline[k - 1], outline[k], false);
      }
    }
  }

  void add_triangle(const std::array<Vector3, 3>& corners) {
    const std::uint32_t a = add_vertex(corners[0]), b = add_vertex(corners[1]);
    add_triangle(a, b, add_vertex(corners[2]), false);
  }

  [[nodiscard]] KnownSurface take() { return std::move(surface_); }

 private:
  KnownSurface surface_;
};

/// Adds the triangles that lists of a `full` asset have.
void add_listed_triangles(const AssetView& asset, SurfaceBuilder& builder) {
  std::vector<bool> used(asset.triangles.size() / 9, false);
  visit_all_lists(asset.grid, [&used](const GridList& list) {
    for (std::uint32_t k = 0; k < list.triangles(); ++k) {
      const std::uint32_t triangle = list.triangle(k) >> 1U;
      if (triangle < used.size()) used[triangle] = true;
    }
  });
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const float* at = asset.triangles.data() + 9 * i;
    builder.add_triangle(
        {Vector3(at[0], at[1], at[2]), Vector3(at[3], at[4], at[5]), Vector3(at[6], at[7], at[8])});
  }
}

/// Adds the triangles of a `sparse` asset that no tile shows.
void add_bare_triangles(const AssetView& asset, SurfaceBuilder& builder) {
  for (std::size_t i = 0; i < asset.exact.size(); ++i) {
    if (traits_of(asset.exact, i).bare) builder.add_triangle(corners_of(asset.exact, i));
  }
}

template <class T>
void append_bytes(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little);
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

}  // namespace

KnownSurface known_surface(const AssetView& asset) {
  SurfaceBuilder builder;
  for (const DistanceMap& map : asset.maps) {
    if (map.plane >= asset.planes.size()) continue;
    for (std::uint32_t layer = 0; layer < map.layers; ++layer) {
      builder.add_layer(asset.planes[map.plane], map, layer);
    }
  }
  for (const Tile& tile : asset.tiles) {
    if (tile.plane >= asset.planes.size()) continue;
    builder.add_tile(asset.planes[tile.plane], tile, asset.height_unit);
  }
  if (asset.full) {
    add_listed_triangles(asset, builder);
  } else {
    add_bare_triangles(asset, builder);
  }
  return builder.take();
}

std::string to_ply(const KnownSurface& surface, bool text) {
  std::string ply = fmt::format(
      "ply\nformat {} 1.0\ncomment the surface as a baked asset knows it, metres\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      text ? "ascii" : "binary_little_endian", surface.vertices.size(), surface.triangles.size());
  for (const auto& [x, y, z] : surface.vertices) {
    if (text) {
      fmt::format_to(std::back_inserter(ply), "{} {} {}\n", x, y, z);
    } else {
      for (const float value : {x, y, z}) append_bytes(ply, value);
    }
  }
  for (const auto& [a, b, c] : surface.triangles) {
    if (text) {
      fmt::format_to(std::back_inserter(ply), "3 {} {} {}\n", a, b, c);
    } else {
      append_bytes(ply, static_cast<std::uint8_t>(3));
      for (const std::uint32_t index : {a, b, c})
        append_bytes(ply, static_cast<std::int32_t>(index));
    }
  }
  return ply;
}

}  // namespace spm::baker
