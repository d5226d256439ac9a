// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/surface_patches.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "common/sixdof/surface_elements.hpp"
#include "common/surface/distance_map.hpp"

namespace spm {

namespace {

/// Two elements describe the same place where their surfaces are no farther apart than this, in
/// tolerances: each may be off by one.
constexpr double same_place_tolerances = 2;
/// And where their normals differ by less than 60 degrees: beyond a sharp edge there is another
/// face.
constexpr double same_place_cosine = 0.5;
/// Least number of parts along a side of a cell that a clip line crosses.
constexpr int clipped_parts = 6;
constexpr int max_parts = 256;
/// Most patches, besides one for each cell of an element: 0.5 GB.
constexpr std::size_t most_patches = std::size_t{1} << 24U;

std::array<float, 3> to_floats(const Vector3& v) noexcept {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// The bilinear sheet of a tile's cell: depth below the plane at (x, y) in [-0.5, 0.5] cells from
/// its middle, and slopes.
class CellSurface {
 public:
  CellSurface(const Tile& tile, float height_unit, std::uint32_t cell) noexcept
      : spacing_(static_cast<double>(tile.spacing)) {
    const std::uint32_t column = cell % tile_cells, row = cell / tile_cells;
    const auto depth = [&](std::uint32_t i, std::uint32_t j) {
      const auto residual =
          static_cast<double>(half_to_float(tile.heights[j * tile_samples + i]) * height_unit);
      return tile.base + residual +
             spacing_ * (static_cast<double>(tile.slope_eta) * i +
                         static_cast<double>(tile.slope_omega) * j);
    };
    const double h00 = depth(column, row), h10 = depth(column + 1, row);
    const double h01 = depth(column, row + 1), h11 = depth(column + 1, row + 1);
    middle_ = (h00 + h10 + h01 + h11) / 4;
    per_x_ = (h10 - h00 + h11 - h01) / 2;
    per_y_ = (h01 - h00 + h11 - h10) / 2;
    twist_ = h00 - h10 - h01 + h11;
  }
  [[nodiscard]] double depth(double x, double y) const noexcept {
    return middle_ + per_x_ * x + per_y_ * y + twist_ * x * y;
  }
  /// Its length is the ratio of the surface to its projection.
  [[nodiscard]] Vector3 normal(const SupportPlane& plane, double x, double y) const noexcept {
    return surface_normal(plane, (per_x_ + twist_ * y) / spacing_,
                          (per_y_ + twist_ * x) / spacing_);
  }

 private:
  double spacing_, middle_ = 0, per_x_ = 0, per_y_ = 0, twist_ = 0;
};

bool cut_off(const Tile& tile, std::uint32_t cell, double x, double y) noexcept {
  if (((tile.clipped >> cell) & 1U) == 0) return false;
  const Clip clip = cell_clip(tile, cell);
  return static_cast<double>(clip.a) * x + static_cast<double>(clip.b) * y >
         static_cast<double>(clip.c);
}

/// Cuts an asset's elements into patches, and keeps those that each owns.
class PatchMaker {
 public:
  PatchMaker(const AssetView& asset, double step)
      : asset_(asset),
        elements_(asset),
        step_(step),
        slack_(same_place_tolerances * asset.tolerance),
        left_(most_patches + std::size_t{tile_cell_count} * elements_.size()) {}

  std::vector<SurfacePatch> patches;

  /// False where there are too many; those that others show already count too.
  [[nodiscard]] bool add_all() {
    for (std::uint32_t which = 0; which < elements_.size() && left_ > 0; ++which) {
      const SurfaceElement& element = elements_[which];
      if (element.is_tile) {
        add_tile(which, element.number);
      } else {
        add_triangle(element.corners, which);
      }
    }
    return left_ > 0;
  }

 private:
  using Corners = std::array<Vector3, 3>;
  const AssetView& asset_;
  SurfaceElements elements_;
  double step_;
  double slack_;
  std::size_t left_;  ///< patches that may still be made

  void add_tile(std::uint32_t rank, std::uint32_t which) {
    const Tile& tile = asset_.tiles[which];
    if (tile.plane >= asset_.planes.size()) return;
    for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
      if (((tile.valid >> cell) & 1U) != 0) add_cell(rank, which, cell);
    }
  }

  void add_cell(std::uint32_t rank, std::uint32_t which, std::uint32_t cell) {
    const Tile& tile = asset_.tiles[which];
    const SupportPlane& plane = asset_.planes[tile.plane];
    const CellSurface surface(tile, asset_.height_unit, cell);
    const auto spacing = static_cast<double>(tile.spacing);
    const double stretch = surface.normal(plane, 0, 0).norm();
    const bool clipped = ((tile.clipped >> cell) & 1U) != 0;
    const int parts = std::max(
        clipped ? clipped_parts : 1,
        static_cast<int>(std::min<double>(max_parts, std::ceil(spacing * stretch / step_))));
    const auto column = cell % tile_cells, row = cell / tile_cells;
    for (int j = 0; j < parts && left_ > 0; ++j) {
      for (int i = 0; i < parts; ++i) {
        const double x = (i + 0.5) / parts - 0.5, y = (j + 0.5) / parts - 0.5;
        if (cut_off(tile, cell, x, y)) continue;
        const double eta = tile.eta0 + (column + 0.5 + x) * spacing;
        const double omega = tile.omega0 + (row + 0.5 + y) * spacing;
        const Vector3 across = surface.normal(plane, x, y);
        const double side = spacing / parts;
        keep(reconstructed_surface(plane, eta, omega, surface.depth(x, y)), across.normalized(),
             across.norm() * side * side, rank);
      }
    }
  }

  /// Halves a triangle across its longest edge until no edge is longer than the step.
  void add_triangle(const Corners& corners, std::uint32_t rank) {
    const Vector3 across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const double size = across.norm();
    if (!(size > 0)) return;
    // A patch has less than half the square of the step: too many are told before they are made.
    if (!(size <= step_ * step_ * static_cast<double>(left_))) {
      left_ = 0;
      return;
    }
    const Vector3 normal = across / size;
    std::vector<Corners> left{corners};
    while (!left.empty() && left_ > 0) {
      const Corners c = left.back();
      left.pop_back();
      std::size_t longest = 0;
      for (std::size_t k = 1; k < 3; ++k) {
        if (edge(c, k) > edge(c, longest)) longest = k;
      }
      if (edge(c, longest) > step_ * step_) {
        const Vector3 &a = c[longest], &b = c[(longest + 1) % 3], &d = c[(longest + 2) % 3];
        const Vector3 middle = (a + b) / 2;
        left.push_back({middle, b, d});
        left.push_back({a, middle, d});
        continue;
      }
      const double area = (c[1] - c[0]).cross(c[2] - c[0]).norm() / 2;
      keep((c[0] + c[1] + c[2]) / 3, normal, area, rank);
    }
  }

  static double edge(const Corners& c, std::size_t k) noexcept {
    return (c[(k + 1) % 3] - c[k]).squaredNorm();
  }

  /// Keeps a patch unless an element with a lower number than `rank` shows the place already.
  void keep(const Vector3& position, const Vector3& normal, double area, std::uint32_t rank) {
    if (left_ == 0) return;
    --left_;
    const bool owned = elements_.none_near(position, slack_, [&](std::uint32_t which) {
      if (which >= rank) return false;
      const SurfaceElement& element = elements_[which];
      return element.is_tile ? covered_by_tile(element.number, position, normal)
                             : covered_by_triangle(element.corners, position, normal);
    });
    if (owned) {
      patches.push_back({to_floats(position), to_floats(normal), static_cast<float>(area)});
    }
  }

  [[nodiscard]] bool covered_by_tile(std::uint32_t which, const Vector3& position,
                                     const Vector3& normal) const noexcept {
    const Tile& tile = asset_.tiles[which];
    if (tile.plane >= asset_.planes.size()) return false;
    const SupportPlane& plane = asset_.planes[tile.plane];
    const PlaneCoordinates place = project_on_plane(plane, position);
    const double column = (place.eta - tile.eta0) / static_cast<double>(tile.spacing);
    const double row = (place.omega - tile.omega0) / static_cast<double>(tile.spacing);
    if (!(column >= 0 && column < tile_cells && row >= 0 && row < tile_cells)) return false;
    const std::uint32_t cell =
        static_cast<std::uint32_t>(row) * tile_cells + static_cast<std::uint32_t>(column);
    if (((tile.valid >> cell) & 1U) == 0) return false;
    const double x = column - std::floor(column) - 0.5, y = row - std::floor(row) - 0.5;
    if (cut_off(tile, cell, x, y)) return false;
    const CellSurface surface(tile, asset_.height_unit, cell);
    const Vector3 across = surface.normal(plane, x, y);
    const double stretch = across.norm();
    return std::abs(place.depth - surface.depth(x, y)) <= slack_ * stretch &&
           across.dot(normal) > same_place_cosine * stretch;
  }

  [[nodiscard]] bool covered_by_triangle(const Corners& c, const Vector3& position,
                                         const Vector3& normal) const noexcept {
    const Vector3 across = (c[1] - c[0]).cross(c[2] - c[0]);
    const double size = across.norm();
    const Vector3 off = position - c[0];
    if (!(size > 0) || std::abs(across.dot(off)) > slack_ * size ||
        !(across.dot(normal) > same_place_cosine * size)) {
      return false;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3 along = c[(k + 1) % 3] - c[k];
      if (!(along.cross(position - c[k]).dot(across) > 0)) return false;
    }
    return true;
  }
};

}  // namespace

Result<std::vector<SurfacePatch>> surface_patches(const AssetView& asset, double step) {
  if (asset.full) {
    return fail(ExitCode::invalid_input,
                "surface samples: the asset is `full`, whose maps show a place many times; bake "
                "the mesh with --form sparse");
  }
  if (!(step > 0)) {
    return fail(ExitCode::usage, "surface samples: the step must be above 0; give a length in m");
  }
  if (asset.tiles_left_out) {
    return fail(ExitCode::usage,
                "surface samples: the asset was opened without its tiles, which show its surface; "
                "open it with them");
  }
  PatchMaker maker(asset, step);
  if (!maker.add_all()) {
    return fail(ExitCode::invalid_input,
                "surface samples: the surface would take more than " +
                    std::to_string(most_patches) +
                    " pieces of this size; give a larger spacing, or bake the mesh again where its "
                    "surface is not as large");
  }
  if (maker.patches.empty()) {
    return fail(ExitCode::invalid_input,
                "surface samples: the asset has no surface; bake a mesh that bounds a solid");
  }
  return std::move(maker.patches);
}

}  // namespace spm
