// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/proof/tile_proof.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "baker/base/progress_counter.hpp"
#include "baker/proof/worthwhile_tries.hpp"
#include "baker/tiles/tile_cells.hpp"
#include "baker/tiles/tile_fit.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {

namespace {

/// A part smaller than this share of the bound that is still not proven never will be.
constexpr double smallest_share = 0.1;
/// A cell that is not proven in this many parts is not worth more; see worthwhile_tries.
constexpr int max_parts = 2000;
/// Share of the bound by which a clipped cell may be off the surface. Where such a cell juts over
/// an edge, it faces points whose side it must not tell.
constexpr double clipped_share = 0.7;
/// Two layers of surface that face away from each other are thin where they are nearer than this,
/// in bounds.
constexpr double thin_bounds = 2;
constexpr double opposite_cosine = -0.3;

/// A rectangle of a cell, in [-0.5, 0.5] from its middle.
struct Part {
  double x0, y0, x1, y1;
};

/// One cell's patch, and how far the surface is from it.
class CellProof {
 public:
  CellProof(const Caster& caster, const SupportPlane& plane, const Tile& tile,
            const TileHeights& heights, std::uint32_t cell, double bound)
      : caster_(caster),
        plane_(plane),
        spacing_(static_cast<double>(tile.spacing)),
        bound_(bound),
        full_bound_(bound) {
    const std::uint32_t column = cell % tile_cells, row = cell / tile_cells;
    const std::size_t first = row * tile_samples + column;
    h_ = {static_cast<double>(heights[first]), static_cast<double>(heights[first + 1]),
          static_cast<double>(heights[first + tile_samples]),
          static_cast<double>(heights[first + tile_samples + 1])};
    eta_ = tile.eta0 + (column + 0.5) * spacing_;
    omega_ = tile.omega0 + (row + 0.5) * spacing_;
    base_ = tile.base;
    const double share = worthwhile_tries(bound, caster.diagonal());
    parts_left_ = 10 + static_cast<int>(max_parts * share);
    clipped_ = ((tile.clipped >> cell) & 1U) != 0;
    if (clipped_) {
      bound_ *= clipped_share;
      clip_ = cell_clip(tile, cell);
    }
  }

  [[nodiscard]] bool proven() const { return proven({-0.5, -0.5, 0.5, 0.5}); }

  /// True where surface that faces the other way comes so near to the cell that two patches, each
  /// off by the bound, could change places: a thin wall, a crack or a knife edge.
  [[nodiscard]] bool is_thin() const {
    const double margin = thin_bounds * full_bound_;
    const Vector3 across =
        (point(0.5, 0.5) - point(-0.5, -0.5)).cross(point(-0.5, 0.5) - point(0.5, -0.5));
    const double radius = ((point(0.5, 0.5) - point(-0.5, -0.5)).norm() +
                           (point(-0.5, 0.5) - point(0.5, -0.5)).norm()) /
                          4;
    thread_local std::vector<std::uint32_t> near;
    near.clear();
    caster_.within(point(0, 0), radius + margin, near);
    return std::any_of(near.begin(), near.end(), [&](std::uint32_t triangle) {
      if (caster_.is_sheet(triangle) ||
          caster_.normal(triangle).dot(across) > opposite_cosine * across.norm()) {
        return false;
      }
      return comes_near(triangle, margin);
    });
  }

 private:
  const Caster& caster_;
  const SupportPlane& plane_;
  double spacing_, bound_, full_bound_;
  std::array<double, 4> h_{};
  double eta_, omega_, base_;
  bool clipped_ = false;
  Clip clip_;
  mutable int parts_left_;

  [[nodiscard]] Vector3 point(double x, double y) const {
    const double fx = x + 0.5, fy = y + 0.5;
    const double depth =
        base_ + (1 - fy) * ((1 - fx) * h_[0] + fx * h_[1]) + fy * ((1 - fx) * h_[2] + fx * h_[3]);
    return support_plane_point(plane_, eta_ + x * spacing_, omega_ + y * spacing_) -
           depth * plane_.n;
  }
  [[nodiscard]] double beyond(double x, double y) const { return beyond_clip(clip_, x, y); }

  /// True where a place of a triangle is that near to the cell, judged at a few places.
  [[nodiscard]] bool comes_near(std::uint32_t triangle, double margin) const {
    const double wide = 0.5 + margin / spacing_;
    for (int k = 0; k < 9; ++k) {
      const Vector3 closest_point = closest_on_triangle(
          point((k % 3 - 1) * 0.5, (k / 3 - 1) * 0.5), caster_.corner(triangle, 0),
          caster_.corner(triangle, 1), caster_.corner(triangle, 2));
      const PlaneCoordinates place = project_on_plane(plane_, closest_point);
      const double x = (place.eta - eta_) / spacing_, y = (place.omega - omega_) / spacing_;
      if (std::max(std::abs(x), std::abs(y)) > wide) continue;
      const double inner_x = std::clamp(x, -0.5, 0.5), inner_y = std::clamp(y, -0.5, 0.5);
      if (clipped_ && beyond(inner_x, inner_y) > std::abs(clip_.a) * margin / spacing_ +
                                                     std::abs(clip_.b) * margin / spacing_) {
        continue;
      }
      if ((closest_point - point(inner_x, inner_y)).norm() <= margin) return true;
    }
    return false;
  }

  /// Corners of the part of a part that the clip line leaves, at most five, in the cell's own
  /// coordinates.
  [[nodiscard]] std::size_t polygon(const Part& part,
                                    std::array<std::array<double, 2>, 5>& corners) const {
    const std::array<std::array<double, 2>, 4> box{
        {{part.x0, part.y0}, {part.x1, part.y0}, {part.x1, part.y1}, {part.x0, part.y1}}};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto& a = box[k];
      const auto& b = box[(k + 1) % 4];
      const double outside_a = clipped_ ? beyond(a[0], a[1]) : -1;
      const double outside_b = clipped_ ? beyond(b[0], b[1]) : -1;
      if (outside_a <= 0) corners[count++] = a;
      if ((outside_a <= 0) != (outside_b <= 0) && count < corners.size()) {
        const double t = outside_a / (outside_a - outside_b);
        corners[count++] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
      }
    }
    return count;
  }

  [[nodiscard]] bool proven(const Part& part) const {
    if (--parts_left_ < 0) return false;
    std::array<std::array<double, 2>, 5> corners{};
    const std::size_t count = polygon(part, corners);
    if (count == 0) return true;
    double x = 0, y = 0;
    for (std::size_t k = 0; k < count; ++k) {
      x += corners[k][0] / static_cast<double>(count);
      y += corners[k][1] / static_cast<double>(count);
    }
    const Vector3 middle = point(x, y);
    const ClosestPoint closest = caster_.closest(middle);
    const double distance = std::abs(closest.distance);
    if (distance > bound_) return false;
    // The slanting side of a clipped part is no straight line of the patch. The patch's twist
    // bounds the difference.
    const double twist = count == 4 && !clipped_
                             ? 0
                             : std::abs(h_[0] - h_[1] - h_[2] + h_[3]) * (part.x1 - part.x0) *
                                   (part.y1 - part.y0) / 4;
    double radius = 0, farthest = 0;
    const Vector3& a = caster_.corner(closest.triangle, 0);
    const Vector3& b = caster_.corner(closest.triangle, 1);
    const Vector3& c = caster_.corner(closest.triangle, 2);
    for (std::size_t k = 0; k < count; ++k) {
      const Vector3 corner = point(corners[k][0], corners[k][1]);
      radius = std::max(radius, (corner - middle).norm());
      farthest = std::max(farthest, (closest_on_triangle(corner, a, b, c) - corner).norm());
    }
    if (farthest + twist <= bound_ || distance + radius + twist <= bound_) return true;
    if (radius < smallest_share * bound_) return false;
    const double xm = (part.x0 + part.x1) / 2, ym = (part.y0 + part.y1) / 2;
    return proven({part.x0, part.y0, xm, ym}) && proven({xm, part.y0, part.x1, ym}) &&
           proven({part.x0, ym, xm, part.y1}) && proven({xm, ym, part.x1, part.y1});
  }
};

/// Removes a cell, together with its clip line.
void remove_cell(TileData& data, std::uint32_t cell) {
  const std::uint64_t bit = std::uint64_t{1} << cell;
  if ((data.clipped & bit) != 0) {
    data.clips.erase(data.clips.begin() + std::popcount(data.clipped & (bit - 1)));
    data.clipped &= ~bit;
  }
  data.valid &= ~bit;
}

}  // namespace

void prove_tiles(const Caster& caster, const std::vector<SupportPlane>& planes,
                 std::vector<TileData>& tiles, double tile_spacing, double height_unit,
                 double bound, const Progress& progress, ProofCounts& counts) {
  std::atomic<std::uint64_t> cells = 0, refused = 0;
  ProgressCounter counter(progress, "proof of tiles", tiles.size());
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
    TileData& data = tiles[i];
    const TileData before = data;
    const Tile tile = view_of(before, tile_spacing, height_unit);
    TileHeights heights;
    tile_heights(tile, static_cast<float>(height_unit), heights);
    for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
      if (((before.valid >> cell) & 1U) == 0) continue;
      ++cells;
      const CellProof proof(caster, planes[data.plane], tile, heights, cell, bound);
      if (proof.proven() && !proof.is_thin()) continue;
      ++refused;
      remove_cell(data, cell);
    }
    counter.done();
  });
  std::erase_if(tiles, [](const TileData& data) { return data.valid == 0; });
  counts.cells += cells;
  counts.refused_cells += refused;
}

void trim_tiles(std::vector<TileData>& tiles, const std::vector<std::uint64_t>& used) {
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    // A tile with all its cells has no mask, which is fewer bytes.
    if (used[i] != 0 && ~tiles[i].valid == 0 && tiles[i].clipped == 0) continue;
    for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
      const std::uint64_t bit = std::uint64_t{1} << cell;
      if ((tiles[i].valid & bit) != 0 && (used[i] & bit) == 0) remove_cell(tiles[i], cell);
    }
  }
  std::erase_if(tiles, [](const TileData& data) { return data.valid == 0; });
}

}  // namespace spm::baker
