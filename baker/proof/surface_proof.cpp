// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/proof/surface_proof.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "baker/base/progress_counter.hpp"
#include "baker/proof/tile_bins.hpp"
#include "baker/proof/worthwhile_tries.hpp"
#include "baker/tiles/closest_on_tile.hpp"

namespace spm::baker {

namespace {

/// A piece with edges shorter than this share of the bound that is still not proven never will be.
constexpr double smallest_share = 0.3;
/// A triangle that is not proven in this many pieces is not worth more; see worthwhile_tries.
constexpr int max_tries = 20000;
/// Pieces larger than this, in bounds, are cut before they are measured against single cells.
constexpr double close_bounds = 8;
/// Most samples along a side that the first test examines. A larger piece is cut first.
constexpr int max_samples = 10;

/// A cell near a piece covers it only where their normals are within this cosine, since the cell
/// must tell the side too.
constexpr double like_cosine = 0.5;

using Piece = std::array<Vector3, 3>;

double longest_edge(const Piece& piece) {
  return std::max(
      {(piece[1] - piece[0]).norm(), (piece[2] - piece[1]).norm(), (piece[0] - piece[2]).norm()});
}

std::array<Piece, 4> quarters(const Piece& piece) {
  const Vector3 ab = (piece[0] + piece[1]) / 2, bc = (piece[1] + piece[2]) / 2,
                ca = (piece[2] + piece[0]) / 2;
  return {{{piece[0], ab, ca}, {ab, piece[1], bc}, {ca, bc, piece[2]}, {ab, bc, ca}}};
}

/// Tests whether tiles cover pieces of the surface.
class SurfaceProof {
 public:
  SurfaceProof(const std::vector<SupportPlane>& planes, const std::vector<Tile>& tiles,
               double height_unit, double bound, double bin_edge)
      : planes_(planes),
        tiles_(tiles),
        height_unit_(static_cast<float>(height_unit)),
        bound_(bound),
        bins_(planes, tiles, height_unit_, bin_edge, bound) {
    heights_.resize(tiles.size());
    tbb::parallel_for(std::size_t{0}, tiles.size(),
                      [&](std::size_t i) { tile_heights(tiles[i], height_unit_, heights_[i]); });
  }

  /// A place of the piece that could not be proven; none where all of it lies near tiles, which are
  /// added to `uses`.
  std::optional<Vector3> open(const Piece& piece, const Vector3& normal, std::vector<TileUse>& uses,
                              int& tries) const {
    if (const std::optional<TileUse> use = stood_for(piece, normal)) {
      const auto same = std::find_if(uses.begin(), uses.end(),
                                     [&](const TileUse& one) { return one.tile == use->tile; });
      if (same == uses.end()) {
        uses.push_back(*use);
      } else {
        same->cells |= use->cells;
      }
      return std::nullopt;
    }
    if (longest_edge(piece) < smallest_share * bound_ || --tries < 0) {
      return (piece[0] + piece[1] + piece[2]) / 3;
    }
    for (const Piece& quarter : quarters(piece)) {
      if (const auto place = open(quarter, normal, uses, tries)) return place;
    }
    return std::nullopt;
  }

 private:
  const std::vector<SupportPlane>& planes_;
  const std::vector<Tile>& tiles_;
  float height_unit_;
  double bound_;
  TileBins bins_;
  std::vector<TileHeights> heights_;

  [[nodiscard]] std::optional<TileUse> stood_for(const Piece& piece, const Vector3& normal) const {
    const Vector3 middle = (piece[0] + piece[1] + piece[2]) / 3;
    const std::span<const std::uint32_t> near = bins_.near(middle);
    // A layer of surface that faces the other way is the other side of a thin wall.
    const auto faces_away = [&](std::uint32_t which) {
      return normal.dot(planes_[tiles_[which].plane].n) <= 0;
    };
    for (const std::uint32_t which : near) {
      if (faces_away(which)) continue;
      if (const std::uint64_t cells = lies_along(which, piece)) return TileUse{which, cells};
    }
    const double radius = std::max(
        {(piece[0] - middle).norm(), (piece[1] - middle).norm(), (piece[2] - middle).norm()});
    if (radius > close_bounds * bound_) return std::nullopt;
    for (const std::uint32_t which : near) {
      if (faces_away(which)) continue;
      if (const std::uint64_t cell = lies_by(which, piece, normal, middle, radius)) {
        return TileUse{which, cell};
      }
    }
    return std::nullopt;
  }

  /// The cells around the piece, if the depths of all their samples are those of the triangle
  /// within the bound; otherwise none.
  [[nodiscard]] std::uint64_t lies_along(std::uint32_t which, const Piece& piece) const {
    const Tile& tile = tiles_[which];
    const SupportPlane& plane = planes_[tile.plane];
    const auto spacing = static_cast<double>(tile.spacing);
    std::array<Vector3, 3> local;  // in samples along eta and omega, and below the base in m
    for (std::size_t k = 0; k < 3; ++k) {
      const PlaneCoordinates place = project_on_plane(plane, piece[k]);
      local[k] = {(place.eta - tile.eta0) / spacing, (place.omega - tile.omega0) / spacing,
                  place.depth - tile.base};
    }
    const Vector3 low = local[0].cwiseMin(local[1]).cwiseMin(local[2]);
    const Vector3 high = local[0].cwiseMax(local[1]).cwiseMax(local[2]);
    if (!(low.x() >= 0 && low.y() >= 0 && high.x() <= tile_cells && high.y() <= tile_cells)) {
      return 0;
    }
    const int x0 = static_cast<int>(low.x()), y0 = static_cast<int>(low.y());
    const int x1 = std::max(x0 + 1, static_cast<int>(std::ceil(high.x())));
    const int y1 = std::max(y0 + 1, static_cast<int>(std::ceil(high.y())));
    if (x1 - x0 > max_samples || y1 - y0 > max_samples || x1 > 8 || y1 > 8) return 0;
    for (int y = y0; y < y1; ++y) {
      const std::uint64_t row = ((std::uint64_t{1} << (x1 - x0)) - 1) << (y * 8 + x0);
      if ((tile.valid & ~tile.clipped & row) != row) return 0;
    }
    const Vector3 across = (local[1] - local[0]).cross(local[2] - local[0]);
    if (!(std::abs(across.z()) > 1e-12)) return 0;
    const auto depth = [&](double x, double y) {
      return local[0].z() -
             (across.x() * (x - local[0].x()) + across.y() * (y - local[0].y())) / across.z();
    };
    const TileHeights& heights = heights_[which];
    const auto height = [&](int x, int y) {
      return static_cast<double>(
          heights[static_cast<std::size_t>(y) * tile_samples + static_cast<std::size_t>(x)]);
    };
    std::uint64_t cells = 0;
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) cells |= std::uint64_t{1} << (y * 8 + x);
    }
    if (x1 - x0 == 1 && y1 - y0 == 1) {
      // The plane minus the patch is bilinear, so it is largest at a corner of any rectangle.
      for (const double x : {low.x(), high.x()}) {
        for (const double y : {low.y(), high.y()}) {
          const double fx = x - x0, fy = y - y0;
          const double patch = (1 - fy) * ((1 - fx) * height(x0, y0) + fx * height(x1, y0)) +
                               fy * ((1 - fx) * height(x0, y1) + fx * height(x1, y1));
          if (!(std::abs(depth(x, y) - patch) <= bound_)) return 0;
        }
      }
      return cells;
    }
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        if (!(std::abs(depth(x, y) - height(x, y)) <= bound_)) return 0;
      }
    }
    return cells;
  }

  /// The cell that is nearest to the piece's middle, if the whole piece is within the bound of it,
  /// or if the middle is within the bound less the size of the piece; otherwise none.
  [[nodiscard]] std::uint64_t lies_by(std::uint32_t which, const Piece& piece,
                                      const Vector3& normal, const Vector3& middle,
                                      double radius) const {
    const Tile& tile = tiles_[which];
    const SupportPlane& plane = planes_[tile.plane];
    const TileClosestPoint closest_point =
        closest_on_tile(tile, height_unit_, plane, middle, static_cast<float>(bound_));
    if (!std::isfinite(closest_point.distance)) return 0;
    const Vector3 facing = surface_normal(plane, static_cast<double>(closest_point.slope_eta),
                                          static_cast<double>(closest_point.slope_omega));
    if (facing.normalized().dot(normal) < like_cosine) return 0;
    const std::uint32_t cell = closest_point.cell;
    const std::uint64_t bit = std::uint64_t{1} << cell;
    if (static_cast<double>(closest_point.distance) + radius <= bound_) {
      return bit;
    }
    const TileHeights& h = heights_[which];
    const std::size_t first = cell / tile_cells * tile_samples + cell % tile_cells;
    const double twist = std::abs(static_cast<double>(
        h[first] - h[first + 1] - h[first + tile_samples] + h[first + tile_samples + 1]));
    // A quarter of the twist in each direction for the patch against its mean plane, whose distance
    // is convex.
    const double allowed = bound_ - twist / 2;
    if (!(allowed > 0)) return 0;
    Tile one = tile;
    one.clips += std::popcount(tile.clipped & (bit - 1));
    one.valid = bit;
    one.clipped &= bit;
    const bool all = std::all_of(piece.begin(), piece.end(), [&](const Vector3& corner) {
      return std::isfinite(
          closest_on_tile(one, height_unit_, plane, corner, static_cast<float>(allowed)).distance);
    });
    return all ? bit : 0;
  }
};

}  // namespace

SurfaceCover prove_surface(const Caster& caster, const std::vector<SupportPlane>& planes,
                           const std::vector<Tile>& tiles, double height_unit, double bound,
                           const Progress& progress) {
  const SurfaceProof proof(planes, tiles, height_unit, bound, caster.diagonal() / 80);
  constexpr std::size_t batch = 64;
  const std::size_t batches = (caster.solid_count() + batch - 1) / batch;
  const double share = worthwhile_tries(bound, caster.diagonal());
  SurfaceCover cover;
  cover.uses.resize(caster.solid_count());
  cover.open.resize(caster.solid_count());
  ProgressCounter counter(progress, "proof of surface", batches);
  tbb::parallel_for(std::size_t{0}, batches, [&](std::size_t i) {
    const std::size_t end = std::min(caster.solid_count(), (i + 1) * batch);
    for (std::size_t k = i * batch; k < end; ++k) {
      const auto triangle = static_cast<std::uint32_t>(k);
      int tries = static_cast<int>(max_tries * share);
      cover.open[k] = proof.open(
          {caster.corner(triangle, 0), caster.corner(triangle, 1), caster.corner(triangle, 2)},
          caster.normal(triangle), cover.uses[k], tries);
    }
    counter.done();
  });
  return cover;
}

}  // namespace spm::baker
