// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "baker/progress_counter.hpp"
#include "baker/stages.hpp"
#include "baker/surface_points.hpp"
#include "common/support_plane_mapping.hpp"

namespace spm::baker {

namespace {

constexpr std::uint32_t side = sparse_samples;
constexpr std::uint32_t cells = side - 1;
constexpr int levels = 5;                            ///< each halves the spacing
constexpr double coarsest_spacing_share = 1.0 / 64;  ///< of the diagonal
constexpr double surfel_spacing_share = 1.0 / 350;   ///< of the diagonal
/// Shares of the tolerance that a tile's own patches may use up.
constexpr double middle_share = 0.35;
constexpr double surfel_share = 0.5;
/// Neighbouring samples of one sheet differ by at most this slope.
constexpr double largest_slope = 2.0;
/// A tile must cover this share of the points that a whole tile would, or it is not worth its
/// bytes.
constexpr double worthwhile_share = 0.04;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// A sample point of the surface, in the frame of the direction that faces it best.
struct Surfel {
  std::uint32_t direction;
  double eta, omega, depth;
};

/// Depths of the entries of one ray; only entries face the plane.
using Entries = std::vector<double>;

struct TileRays {
  std::array<Entries, side * side> samples;
  std::array<Entries, cells * cells> middles;
};

/// One continuous sheet of surface under a tile.
struct Sheet {
  std::array<double, side * side> depth;
  std::array<bool, cells * cells> valid;
  std::uint32_t first_layer = 0;
};

struct TileKey {
  std::uint32_t direction;
  std::int64_t column, row;
  [[nodiscard]] auto tuple() const { return std::tie(direction, column, row); }
};

/// Gives each point of the surface to the direction that faces its triangle best.
std::vector<Surfel> assign_surface(const Caster& caster, const std::vector<SupportPlane>& planes,
                                   std::uint64_t seed) {
  std::vector<std::uint32_t> direction(caster.surface_count(), 0);
  for (std::uint32_t triangle = 0; triangle < direction.size(); ++triangle) {
    direction[triangle] =
        static_cast<std::uint32_t>(support_plane_mapping(planes, caster.normal(triangle)));
  }
  std::vector<Surfel> surfels;
  for (const SurfacePoint& sample :
       surface_points(caster, surfel_spacing_share * caster.diagonal(), 0, seed)) {
    const std::uint32_t which = direction[sample.triangle];
    const PlaneCoordinates place = project_on_plane(planes[which], sample.point);
    surfels.push_back({which, place.eta, place.omega, place.depth});
  }
  return surfels;
}

/// Builds the maps of one coarsest tile, splitting it where it is not accurate enough.
class Tiler {
 public:
  Tiler(const Caster& caster, const SupportPlane& plane, std::uint32_t which, double tolerance)
      : caster_(caster), plane_(plane), which_(which), tolerance_(tolerance) {}

  std::vector<MapData> maps;
  CastCounts counts;

  void tile(int level, std::int64_t column, std::int64_t row, std::vector<Surfel> surfels) {
    spacing_ = static_cast<float>(coarsest_spacing_share * caster_.diagonal() / (1 << level));
    // As the file stores them, so that the baker judges what the servo will read.
    eta0_ = static_cast<float>(static_cast<double>(column) * cells * spacing_);
    omega0_ = static_cast<float>(static_cast<double>(row) * cells * spacing_);
    cast_rays();
    std::vector<Sheet> tried;
    std::vector<Surfel> left;
    std::vector<bool> covered(surfels.size(), false);
    for (std::size_t i = 0; i < surfels.size(); ++i) {
      if (covered[i]) continue;
      if (!belongs_to_tried(tried, surfels[i])) try_sheet(surfels[i], surfels, covered, tried);
      if (!covered[i]) left.push_back(surfels[i]);
    }
    if (level + 1 == levels || left.empty()) return;
    split(level, column, row, left);
  }

 private:
  const Caster& caster_;
  const SupportPlane& plane_;
  std::uint32_t which_;
  double tolerance_;
  double spacing_ = 0, eta0_ = 0, omega0_ = 0;
  TileRays rays_;

  void split(int level, std::int64_t column, std::int64_t row, const std::vector<Surfel>& left) {
    std::array<std::vector<Surfel>, 4> quarters;
    const double half = spacing_ * cells / 2;
    const double eta0 = eta0_, omega0 = omega0_;
    for (const Surfel& surfel : left) {
      const std::size_t quarter =
          (surfel.eta >= eta0 + half ? 1U : 0U) + (surfel.omega >= omega0 + half ? 2U : 0U);
      quarters[quarter].push_back(surfel);
    }
    for (std::size_t quarter = 0; quarter < 4; ++quarter) {
      if (quarters[quarter].empty()) continue;
      tile(level + 1, 2 * column + static_cast<std::int64_t>(quarter & 1U),
           2 * row + static_cast<std::int64_t>(quarter >> 1U), std::move(quarters[quarter]));
    }
  }

  void cast_one(double eta, double omega, Entries& entries) {
    thread_local Column column;
    caster_.cast(plane_, eta, omega, column);
    ++counts.rays;
    counts.inconsistent += column.consistent ? 0 : 1;
    counts.layers_max =
        std::max(counts.layers_max, static_cast<std::uint32_t>(column.crossings.size()));
    entries.clear();
    for (const Crossing& crossing : column.crossings) {
      if (crossing.entry) entries.push_back(crossing.depth);
    }
  }

  void cast_rays() {
    for (std::uint32_t row = 0; row < side; ++row) {
      for (std::uint32_t column = 0; column < side; ++column) {
        cast_one(eta0_ + column * spacing_, omega0_ + row * spacing_,
                 rays_.samples[row * side + column]);
        if (column == cells || row == cells) continue;
        cast_one(eta0_ + (column + 0.5) * spacing_, omega0_ + (row + 0.5) * spacing_,
                 rays_.middles[row * cells + column]);
      }
    }
  }

  [[nodiscard]] std::uint32_t cell_of(const Surfel& surfel) const {
    const auto index = [&](double offset) {
      return static_cast<std::uint32_t>(std::clamp(offset / spacing_, 0.0, cells - 1e-9));
    };
    return index(surfel.omega - omega0_) * cells + index(surfel.eta - eta0_);
  }

  /// Height of a sheet's patch at a surfel; NaN where the cell has a sample missing.
  [[nodiscard]] double patch_at(const Sheet& sheet, const Surfel& surfel) const {
    const std::uint32_t cell = cell_of(surfel);
    const std::uint32_t first = cell / cells * side + cell % cells;
    const double fx = (surfel.eta - eta0_) / spacing_ - cell % cells;
    const double fy = (surfel.omega - omega0_) / spacing_ - cell / cells;
    return (1 - fy) * ((1 - fx) * sheet.depth[first] + fx * sheet.depth[first + 1]) +
           fy * ((1 - fx) * sheet.depth[first + side] + fx * sheet.depth[first + side + 1]);
  }

  [[nodiscard]] bool belongs_to_tried(const std::vector<Sheet>& tried, const Surfel& surfel) const {
    return std::any_of(tried.begin(), tried.end(), [&](const Sheet& sheet) {
      return std::abs(patch_at(sheet, surfel) - surfel.depth) <= spacing_;
    });
  }

  static std::size_t nearest_entry(const Entries& entries, double depth) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < entries.size(); ++i) {
      if (std::abs(entries[i] - depth) < std::abs(entries[best] - depth)) best = i;
    }
    return best;
  }

  /// Follows the surface from a surfel's cell over the tile, sample by sample.
  [[nodiscard]] Sheet trace(const Surfel& seed) const {
    Sheet sheet;
    sheet.depth.fill(missing);
    sheet.valid.fill(false);
    const std::uint32_t cell = cell_of(seed);
    const std::uint32_t first = cell / cells * side + cell % cells;
    std::vector<std::uint32_t> open;
    const auto reach = [&](std::uint32_t sample, double from, double allowed) {
      if (!std::isnan(sheet.depth[sample]) || rays_.samples[sample].empty()) return;
      const std::size_t entry = nearest_entry(rays_.samples[sample], from);
      const double depth = rays_.samples[sample][entry];
      if (std::abs(depth - from) > allowed) return;
      if (open.empty()) sheet.first_layer = static_cast<std::uint32_t>(2 * entry);
      sheet.depth[sample] = static_cast<float>(depth);
      open.push_back(sample);
    };
    for (const std::uint32_t sample : {first, first + 1, first + side, first + side + 1}) {
      reach(sample, seed.depth, largest_slope * spacing_);
    }
    for (std::size_t next = 0; next < open.size(); ++next) {
      const std::uint32_t sample = open[next];
      const double from = sheet.depth[sample];
      if (sample % side > 0) reach(sample - 1, from, largest_slope * spacing_);
      if (sample % side < cells) reach(sample + 1, from, largest_slope * spacing_);
      if (sample / side > 0) reach(sample - side, from, largest_slope * spacing_);
      if (sample / side < cells) reach(sample + side, from, largest_slope * spacing_);
    }
    validate(sheet);
    return sheet;
  }

  void validate(Sheet& sheet) const {
    for (std::uint32_t cell = 0; cell < cells * cells; ++cell) {
      const std::uint32_t first = cell / cells * side + cell % cells;
      const double patch = (sheet.depth[first] + sheet.depth[first + 1] +
                            sheet.depth[first + side] + sheet.depth[first + side + 1]) /
                           4;
      const Entries& middle = rays_.middles[cell];
      sheet.valid[cell] =
          !std::isnan(patch) && !middle.empty() &&
          std::abs(middle[nearest_entry(middle, patch)] - patch) <= middle_share * tolerance_;
    }
  }

  void try_sheet(const Surfel& seed, const std::vector<Surfel>& surfels, std::vector<bool>& covered,
                 std::vector<Sheet>& tried) {
    const Sheet sheet = trace(seed);
    std::vector<std::size_t> answered;
    for (std::size_t i = 0; i < surfels.size(); ++i) {
      if (!covered[i] && sheet.valid[cell_of(surfels[i])] &&
          std::abs(patch_at(sheet, surfels[i]) - surfels[i].depth) <= surfel_share * tolerance_) {
        answered.push_back(i);
      }
    }
    tried.push_back(sheet);
    const double whole =
        std::pow(spacing_ * cells / (surfel_spacing_share * caster_.diagonal()), 2);
    if (answered.empty() || static_cast<double>(answered.size()) < worthwhile_share * whole) return;
    for (const std::size_t i : answered) covered[i] = true;
    maps.push_back(as_map(sheet));
  }

  [[nodiscard]] MapData as_map(const Sheet& sheet) const {
    MapData map;
    map.plane = which_;
    map.columns = map.rows = side;
    map.layers = 1;
    map.first_layer = sheet.first_layer;
    map.eta0 = eta0_;
    map.omega0 = omega0_;
    map.spacing = spacing_;
    map.mask.assign(mask_words(side, side, 1), 0);
    for (std::uint32_t cell = 0; cell < cells * cells; ++cell) {
      if (sheet.valid[cell]) map.mask[cell >> 5U] |= 1U << (cell & 31U);
    }
    map.samples.resize(side * side);
    std::array<double, side* side> depth = sheet.depth;
    extend_over_missing(depth);
    std::transform(depth.begin(), depth.end(), map.samples.begin(),
                   [](double height) { return static_cast<float>(height); });
    return map;
  }

  /// Samples without surface take their neighbours' mean, so that a picture of the tile is smooth.
  static void extend_over_missing(std::array<double, side * side>& depth) {
    for (std::uint32_t pass = 0; pass < 2 * side; ++pass) {
      const std::array<double, side* side> before = depth;
      for (std::uint32_t i = 0; i < side * side; ++i) {
        if (!std::isnan(before[i])) continue;
        double sum = 0;
        int count = 0;
        const auto add = [&](std::uint32_t neighbour) {
          if (std::isnan(before[neighbour])) return;
          sum += before[neighbour];
          ++count;
        };
        if (i % side > 0) add(i - 1);
        if (i % side < cells) add(i + 1);
        if (i / side > 0) add(i - side);
        if (i / side < cells) add(i + side);
        if (count > 0) depth[i] = sum / count;
      }
    }
  }
};

}  // namespace

std::vector<MapData> cast_sparse_maps(const Caster& caster, const std::vector<SupportPlane>& planes,
                                      double tolerance, std::uint64_t seed,
                                      const Progress& progress, CastCounts& counts) {
  const double extent =
      static_cast<double>(static_cast<float>(coarsest_spacing_share * caster.diagonal())) * cells;
  std::vector<std::pair<TileKey, Surfel>> placed;
  for (const Surfel& surfel : assign_surface(caster, planes, seed)) {
    placed.push_back({{surfel.direction, static_cast<std::int64_t>(std::floor(surfel.eta / extent)),
                       static_cast<std::int64_t>(std::floor(surfel.omega / extent))},
                      surfel});
  }
  std::stable_sort(placed.begin(), placed.end(),
                   [](const auto& a, const auto& b) { return a.first.tuple() < b.first.tuple(); });
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (i == 0 || placed[i].first.tuple() != placed[i - 1].first.tuple()) starts.push_back(i);
  }
  starts.push_back(placed.size());

  std::vector<std::vector<MapData>> found(starts.size() - 1);
  std::vector<CastCounts> each(found.size());
  ProgressCounter counter(progress, "casting", found.size());
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
    const TileKey& key = placed[starts[i]].first;
    std::vector<Surfel> surfels;
    for (std::size_t k = starts[i]; k < starts[i + 1]; ++k) surfels.push_back(placed[k].second);
    Tiler tiler(caster, planes[key.direction], key.direction, tolerance);
    tiler.tile(0, key.column, key.row, std::move(surfels));
    found[i] = std::move(tiler.maps);
    each[i] = tiler.counts;
    counter.done();
  });

  std::vector<MapData> maps;
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::move(found[i].begin(), found[i].end(), std::back_inserter(maps));
    counts.rays += each[i].rays;
    counts.inconsistent += each[i].inconsistent;
    counts.layers_max = std::max(counts.layers_max, each[i].layers_max);
  }
  return maps;
}

}  // namespace spm::baker
