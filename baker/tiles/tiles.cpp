// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/tiles/tiles.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <span>
#include <utility>

#include "baker/base/cube_bins.hpp"
#include "baker/base/progress_counter.hpp"
#include "baker/cast/surface_points.hpp"
#include "baker/tiles/tile_cells.hpp"
#include "baker/tiles/tile_fit.hpp"
#include "common/surface/support_plane_mapping.hpp"

namespace spm::baker {

namespace {

/// How far normals may be off at the last level.
constexpr double last_angle = 0.5;
/// A place is tried only if at least this share of the surfels that a tile must cover face its
/// plane best. Otherwise the rest would belong to other planes.
constexpr double min_members = 0.5;
/// Tiles side by side are worth it only where they cover this many times the least that a tile must
/// cover. The gaps between them may take fewer tiles that are shifted.
constexpr double first_worth = 2;
/// Edge of the cubes by which surfels are found, as a share of the diagonal.
constexpr double bin_share = 1.0 / 90;

/// Assigns each point of the surface to the direction that faces its triangle best.
std::vector<Surfel> assign_surface(const Caster& caster, const std::vector<SupportPlane>& planes,
                                   const std::vector<SurfacePoint>& points) {
  std::vector<std::uint32_t> direction(caster.solid_count(), 0);
  for (std::uint32_t triangle = 0; triangle < direction.size(); ++triangle) {
    direction[triangle] =
        static_cast<std::uint32_t>(support_plane_mapping(planes, caster.normal(triangle)));
  }
  std::vector<Surfel> surfels;
  for (const SurfacePoint& sample : points) {
    const std::uint32_t which = direction[sample.triangle];
    const PlaneCoordinates place = project_on_plane(planes[which], sample.point);
    surfels.push_back({sample.point, sample.triangle, which, place.eta, place.omega, place.depth});
  }
  return surfels;
}

struct TileKey {
  std::uint32_t direction;
  std::int32_t column, row;
};

/// Surfels, listed by the cube of space in which they lie.
class SurfelBins {
 public:
  SurfelBins(const Caster& caster, const std::vector<Surfel>& surfels, double edge) {
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Surfel& surfel : surfels) {
      low = low.cwiseMin(surfel.point);
      high = high.cwiseMax(surfel.point);
    }
    grid_ = CubeGrid(low, high - low, edge);
    std::vector<CubeBins::Member> members;
    members.reserve(surfels.size());
    for (std::uint32_t i = 0; i < surfels.size(); ++i) {
      const auto [x, y, z] = grid_.nearest(surfels[i].point);
      members.emplace_back(grid_.number(x, y, z), i);
    }
    bins_ = CubeBins(grid_.cubes(), members);
    for (const std::uint32_t i : bins_.of(0, grid_.cubes() - 1)) {
      places_.push_back({i, surfels[i].point, caster.normal(surfels[i].triangle)});
    }
  }

  /// Where a surfel lies, and the normal there.
  struct Place {
    std::uint32_t surfel;
    Vector3 point, normal;
  };

  /// Calls `visit` with the places of the surfels in the cubes that a box meets.
  template <class Visit>
  void visit_box(const Vector3& low, const Vector3& high, const Visit& visit) const {
    const auto from = grid_.nearest(low), to = grid_.nearest(high);
    const std::uint32_t* const first = bins_.of(0, grid_.cubes() - 1).data();
    for (std::int64_t z = from[2]; z <= to[2]; ++z) {
      for (std::int64_t y = from[1]; y <= to[1]; ++y) {
        const auto row = bins_.of(grid_.number(from[0], y, z), grid_.number(to[0], y, z));
        const auto start = static_cast<std::size_t>(row.data() - first);
        for (const Place& there : std::span(places_).subspan(start, row.size())) visit(there);
      }
    }
  }

 private:
  CubeGrid grid_;
  CubeBins bins_;
  std::vector<Place> places_;  ///< in the order of the bins: side by side as they are read
};

/// A fitted tile and the surfels it covers.
struct Candidate {
  TileData data;
  std::vector<std::uint32_t> covers;
};

/// Chooses tiles level by level.
class TileChooser {
 public:
  TileChooser(const Caster& caster, const std::vector<SupportPlane>& planes,
              const TileSettings& settings, const std::vector<SurfacePoint>& points)
      : caster_(caster),
        planes_(planes),
        settings_(settings),
        surfels_(assign_surface(caster, planes, points)),
        bins_(caster, surfels_, bin_share * caster.diagonal()),
        covered_(surfels_.size(), 0) {
    double area = 0;
    for (std::uint32_t t = 0; t < caster.solid_count(); ++t) area += caster.area(t);
    const double each = area / std::max<double>(1, static_cast<double>(surfels_.size()));
    triangles_.reserve(surfels_.size());
    for (const Surfel& surfel : surfels_) {
      const double own = caster.area(surfel.triangle);
      triangles_.push_back(own > 0 ? each / own : 0);
    }
  }

  std::vector<TileData> tiles;

  /// Chooses tiles of a level that each cover `least` times what is worthwhile. They lie side by
  /// side. With `shifted` they may also be shifted by half a tile, for the gaps that others leave.
  void run_level(std::uint32_t level, bool shifted, const Progress& progress) {
    const double least = min_at(level) * (shifted ? 1 : first_worth);
    const double stride =
        std::ldexp(settings_.tile_spacing * tile_stride, -static_cast<int>(level));
    const std::vector<Place> places = places_of(stride, shifted);
    if (places.empty()) return;
    std::vector<std::vector<Candidate>> found(places.size());
    ProgressCounter counter(progress, "casting", found.size());
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
      found[i] = candidates_at(level, places[i].key, places[i].members);
      counter.done();
    });
    std::vector<Candidate> candidates;
    for (auto& one : found) std::move(one.begin(), one.end(), std::back_inserter(candidates));
    choose(candidates, least);
  }

 private:
  const Caster& caster_;
  const std::vector<SupportPlane>& planes_;
  const TileSettings& settings_;
  std::vector<Surfel> surfels_;
  SurfelBins bins_;
  std::vector<std::uint8_t> covered_;
  std::vector<double> triangles_;  ///< how many each surfel stands for

  /// Where a tile may lie, and the surfels of its plane there that no tile covers yet.
  struct Place {
    TileKey key;
    std::vector<std::uint32_t> members;
  };

  /// The places in which there are such surfels, in order.
  [[nodiscard]] std::vector<Place> places_of(double stride, bool shifted) const {
    std::array<std::int32_t, 2> low{}, high{};
    const auto column_of = [&](const Surfel& surfel) {
      return static_cast<std::int32_t>(std::floor(surfel.eta / stride));
    };
    const auto row_of = [&](const Surfel& surfel) {
      return static_cast<std::int32_t>(std::floor(surfel.omega / stride));
    };
    for (const Surfel& surfel : surfels_) {
      low = {std::min(low[0], column_of(surfel) - 1), std::min(low[1], row_of(surfel) - 1)};
      high = {std::max(high[0], column_of(surfel)), std::max(high[1], row_of(surfel))};
    }
    const std::uint64_t columns = static_cast<std::uint32_t>(high[0] - low[0]) + std::uint64_t{1};
    const std::uint64_t rows = static_cast<std::uint32_t>(high[1] - low[1]) + std::uint64_t{1};
    std::vector<CubeBins::Member> placed;
    for (std::uint32_t i = 0; i < surfels_.size(); ++i) {
      if (covered_[i] != 0) continue;
      const Surfel& surfel = surfels_[i];
      for (std::int32_t k = 0; k < 4; ++k) {
        const std::int32_t c = column_of(surfel) - k % 2, r = row_of(surfel) - k / 2;
        if (!shifted && ((c | r) & 1) != 0) continue;
        const auto column = static_cast<std::uint64_t>(c - low[0]);
        const auto row = static_cast<std::uint64_t>(r - low[1]);
        placed.emplace_back((surfel.direction * columns + column) * rows + row, i);
      }
    }
    const std::size_t count = planes_.size() * columns * rows;
    const CubeBins bins(count, placed);
    std::vector<Place> places;
    for (std::size_t n = 0; n < count; ++n) {
      const auto members = bins.of(n, n);
      if (members.empty()) continue;
      const TileKey key{static_cast<std::uint32_t>(n / rows / columns),
                        low[0] + static_cast<std::int32_t>(n / rows % columns),
                        low[1] + static_cast<std::int32_t>(n % rows)};
      places.push_back({key, {members.begin(), members.end()}});
    }
    return places;
  }

  /// How many triangles surfels stand for.
  [[nodiscard]] double triangles_of(const std::vector<std::uint32_t>& members) const {
    double triangles = 0;
    for (const std::uint32_t i : members) triangles += triangles_[i];
    return triangles;
  }

  [[nodiscard]] bool is_last(std::uint32_t level) const { return level + 1 == settings_.levels; }

  /// How many surfels a tile of a level must newly cover.
  [[nodiscard]] double min_at(std::uint32_t level) const {
    const double extent = std::ldexp(settings_.tile_spacing * tile_cells, -static_cast<int>(level));
    const double whole = std::max(1.0, std::pow(extent / settings_.surfel_spacing, 2));
    return whole * (is_last(level) ? settings_.last_worthwhile : settings_.worthwhile);
  }

  /// One candidate for each layer of surface on which the members of a place lie.
  [[nodiscard]] std::vector<Candidate> candidates_at(
      std::uint32_t level, const TileKey& key, const std::vector<std::uint32_t>& members) const {
    const bool any_angle = is_last(level);
    const SupportPlane& plane = planes_[key.direction];
    const TileSite site{
        plane,
        key.direction,
        level,
        key.column,
        key.row,
        std::ldexp(settings_.tile_spacing, -static_cast<int>(level)),
        settings_.height_unit,
        settings_.residual,
        any_angle ? last_angle : std::ldexp(settings_.angle, static_cast<int>(level)),
        any_angle ? last_angle : settings_.cell_angle,
        settings_.faceted};
    std::vector<Candidate> candidates;
    if (static_cast<double>(members.size()) < min_members * min_at(level) ||
        triangles_of(members) < settings_.least_triangles) {
      return candidates;
    }
    std::vector<bool> tried(members.size(), false);
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (tried[i]) continue;
      const Surfel& seed = surfels_[members[i]];
      std::optional<TileFit> fit = fit_tile(caster_, site, {seed.eta, seed.omega, seed.depth});
      tried[i] = true;
      if (!fit) continue;
      const Tile view = view_of(fit->data, settings_.tile_spacing, settings_.height_unit);
      for (std::size_t k = i + 1; k < members.size(); ++k) {
        if (!tried[k]) tried[k] = std::abs(height_over(view, surfels_[members[k]])) <= site.spacing;
      }
      if (!fit->good) continue;
      Candidate candidate{std::move(fit->data), covered_by(view)};
      if (static_cast<double>(candidate.covers.size()) >= min_at(level)) {
        candidates.push_back(std::move(candidate));
      }
    }
    return candidates;
  }

  /// How far a surfel lies below a tile's patch, m; for surfels of the tile's own plane only.
  [[nodiscard]] double height_over(const Tile& tile, const Surfel& surfel) const {
    const double s = static_cast<double>(tile.spacing);
    const double x = std::clamp((surfel.eta - tile.eta0) / s, 0.0, 7.999);
    const double y = std::clamp((surfel.omega - tile.omega0) / s, 0.0, 7.999);
    return surfel.depth - patch_height(tile, x, y);
  }

  [[nodiscard]] double patch_height(const Tile& tile, double x, double y) const {
    const auto column = static_cast<std::uint32_t>(x), row = static_cast<std::uint32_t>(y);
    const double fx = x - column, fy = y - row;
    const auto at = [&](std::uint32_t i, std::uint32_t j) {
      return static_cast<double>(half_to_float(tile.heights[j * tile_samples + i])) *
             settings_.height_unit;
    };
    const double residual = (1 - fy) * ((1 - fx) * at(column, row) + fx * at(column + 1, row)) +
                            fy * ((1 - fx) * at(column, row + 1) + fx * at(column + 1, row + 1));
    return tile.base + residual +
           static_cast<double>(tile.spacing) * (x * static_cast<double>(tile.slope_eta) +
                                                y * static_cast<double>(tile.slope_omega));
  }

  /// Surfels, of any direction, on the tile's valid cells that no chosen tile covers yet.
  [[nodiscard]] std::vector<std::uint32_t> covered_by(const Tile& tile) const {
    const SupportPlane& plane = planes_[tile.plane];
    const double s = static_cast<double>(tile.spacing), extent = s * tile_cells;
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (int corner = 0; corner < 8; ++corner) {
      const double x = (corner & 1) * extent, y = (corner >> 1 & 1) * extent;
      const double residual = static_cast<double>((corner & 4) != 0 ? tile.highest : tile.lowest);
      const double depth = tile.base + x * static_cast<double>(tile.slope_eta) +
                           y * static_cast<double>(tile.slope_omega) + residual;
      const Vector3 point =
          support_plane_point(plane, tile.eta0 + x, tile.omega0 + y) - depth * plane.n;
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    const Vector3 slack = Vector3::Constant(2 * settings_.residual);
    std::vector<std::uint32_t> found;
    bins_.visit_box(low - slack, high + slack, [&](const SurfelBins::Place& there) {
      if (covers(tile, plane, there)) found.push_back(there.surfel);
    });
    return found;
  }

  /// Whether a tile covers a surfel that none covers yet.
  [[nodiscard]] bool covers(const Tile& tile, const SupportPlane& plane,
                            const SurfelBins::Place& there) const {
    const PlaneCoordinates place = project_on_plane(plane, there.point);
    const double s = static_cast<double>(tile.spacing);
    const double x = (place.eta - tile.eta0) / s, y = (place.omega - tile.omega0) / s;
    if (!(x >= 0 && y >= 0 && x < tile_cells && y < tile_cells)) return false;
    const auto cell = static_cast<std::uint32_t>(y) * tile_cells + static_cast<std::uint32_t>(x);
    if (((tile.valid >> cell) & 1U) == 0 || covered_[there.surfel] != 0) return false;
    const double facing = there.normal.dot(plane.n);
    if (std::abs(patch_height(tile, x, y) - place.depth) * facing > 1.2 * settings_.residual ||
        facing <= 0) {
      return false;
    }
    if (((tile.clipped >> cell) & 1U) == 0) return true;
    const Clip clip = cell_clip(tile, cell);
    const double beyond = beyond_clip(clip, x - std::floor(x) - 0.5, y - std::floor(y) - 0.5);
    return beyond * s <= settings_.residual *
                             std::hypot(static_cast<double>(clip.a), static_cast<double>(clip.b));
  }

  /// Greedy cover: always takes the candidate that covers most of the surfels that are still
  /// uncovered.
  void choose(std::vector<Candidate>& candidates, double least) {
    struct Entry {
      std::size_t gain, index;
      bool operator<(const Entry& other) const {
        return gain != other.gain ? gain < other.gain : index > other.index;
      }
    };
    std::priority_queue<Entry> queue;
    for (std::size_t i = 0; i < candidates.size(); ++i)
      queue.push({candidates[i].covers.size(), i});
    while (!queue.empty()) {
      const Entry top = queue.top();
      queue.pop();
      std::vector<std::uint32_t>& covers = candidates[top.index].covers;
      std::erase_if(covers, [&](std::uint32_t i) { return covered_[i] != 0; });
      if (static_cast<double>(covers.size()) < least) continue;
      if (covers.size() < top.gain) {
        queue.push({covers.size(), top.index});
        continue;
      }
      for (const std::uint32_t i : covers) covered_[i] = 1;
      tiles.push_back(std::move(candidates[top.index].data));
    }
  }
};

}  // namespace

std::vector<TileData> cast_tiles(const Caster& caster, const std::vector<SupportPlane>& planes,
                                 const TileSettings& settings,
                                 const std::vector<SurfacePoint>& points,
                                 const Progress& progress) {
  TileChooser chooser(caster, planes, settings, points);
  for (std::uint32_t level = 0; level < settings.levels; ++level) {
    for (const bool shifted : {false, true}) chooser.run_level(level, shifted, progress);
  }
  return std::move(chooser.tiles);
}

}  // namespace spm::baker
