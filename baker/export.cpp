// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/export.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include "baker/grid_walk.hpp"
#include "common/distance_map.hpp"

namespace spm::baker {
namespace {

constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();

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
    // Odd crossings are exits, whose outside looks away from the plane.
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

  void add_exact_triangle(std::span<const float> corners) {
    std::array<std::uint32_t, 3> ids{};
    for (std::size_t i = 0; i < 3; ++i) {
      ids[i] = add_vertex({corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]});
    }
    add_triangle(ids[0], ids[1], ids[2], false);
  }

  [[nodiscard]] KnownSurface take() { return std::move(surface_); }

 private:
  KnownSurface surface_;
};

/// Which of the asset's triangles some record uses for distances, not only for the side.
std::vector<bool> triangles_with_distance(const AssetView& asset) {
  std::vector<bool> used(asset.triangles.size() / 9, false);
  const auto& records = asset.grid.records;
  visit_all_records(asset.grid, [&](std::size_t start) {
    const std::size_t maps = records[start] & 0xFFFFU;
    const std::size_t count = records[start] >> 16U;
    for (std::size_t i = start + 1 + maps; i < start + 1 + maps + count && i < records.size();
         ++i) {
      const bool cap = (records[i] >> 31U) != 0;
      const std::size_t triangle = records[i] & 0x7FFFFFFFU;
      if (!cap && triangle < used.size()) used[triangle] = true;
    }
  });
  return used;
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
  const std::vector<bool> used = triangles_with_distance(asset);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) builder.add_exact_triangle(asset.triangles.subspan(9 * i, 9));
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
