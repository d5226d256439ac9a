// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/side_trials.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "baker/band_trials.hpp"
#include "baker/border_trials.hpp"
#include "baker/random.hpp"
#include "common/closest_element.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t trials = 400'000;
/// One trial of so many lies at a tile's border.
constexpr std::uint64_t border_every = 4;
constexpr std::uint64_t trials_about_failure = 64;
constexpr std::uint64_t trials_about_close = 8;
constexpr std::uint64_t passes = 16;
/// Claims that differ by less than this are close.
constexpr double close_margin = 0.25;
/// How far about a failure and about a close place more trials lie, in tolerances.
constexpr double about_reach = 4;
constexpr double close_reach = 1;
constexpr std::uint64_t seed = 0x3E9D;

enum class Outcome : std::uint8_t { clear, close, wrong };

/// Asks for the distance of a point; where a cube tells the side it cannot be wrong.
Outcome outcome_at(const AssetView& view, const Caster& caster, double tolerance,
                   const Vector3& point) {
  if (space_at(view.space, point) != SpaceKind::told) return Outcome::clear;
  const ElementReading reading = read_elements(view, point, SpaceKind::told);
  const ClosestPoint closest = caster.closest(point);
  // By a cap nothing is promised.
  if (closest.clear < std::min(tolerance, std::abs(closest.distance))) return Outcome::clear;
  if (std::abs(signed_distance(view, reading, SpaceKind::told) - closest.distance) > tolerance) {
    return Outcome::wrong;
  }
  return reading.sides.margin() < close_margin ? Outcome::close : Outcome::clear;
}

std::vector<Outcome> outcomes(const AssetView& view, const Caster& caster, double tolerance,
                              const std::vector<Vector3>& points) {
  std::vector<Outcome> result(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    result[i] = outcome_at(view, caster, tolerance, points[i]);
  });
  return result;
}

/// Adds places about one to those of the next pass.
void look_about(const Vector3& point, std::uint64_t count, double reach, std::uint64_t pass,
                std::vector<Vector3>& more) {
  for (std::uint64_t k = 0; k < count && more.size() < trials; ++k) {
    const std::uint64_t index = 3 * more.size();
    const Vector3 away(random_unit(seed + 1 + pass, index), random_unit(seed + 1 + pass, index + 1),
                       random_unit(seed + 1 + pass, index + 2));
    more.push_back(point + reach * (2 * away - Vector3::Constant(1)));
  }
}

void count_cells(const AssetView& view, const Caster& caster, const SpaceBuilder& space,
                 SideTrials& result) {
  space.visit_leaves([&](const SpaceNode& leaf) {
    if (leaf.kind == SpaceKind::far || leaf.kind == SpaceKind::pruned) return;
    const double distance = caster.closest(leaf.middle).distance;
    if (distance + std::sqrt(3.0) / 2 * leaf.edge < -view.band.max_depth) return;
    ++result.cells;
    const ElementReading reading = read_elements(view, leaf.middle, SpaceKind::inside);
    result.fallback_cells += reading.nearest.tile == nullptr ? 1 : 0;
  });
}

}  // namespace

SideTrials try_sides(Asset& asset, const Caster& caster, SpaceBuilder& space,
                     const Progress& progress) {
  SideTrials result;
  const double tolerance = *asset.metadata.tolerance;
  const BandTrials band(caster, asset.metadata.band, tolerance, seed);
  // Only the space changes from pass to pass.
  const AssetTables tables = tables_of(asset);
  AssetView view = tables.view();
  const BorderTrials borders(view, seed);
  std::vector<Vector3> more;
  std::uint64_t drawn = 0;
  bool clean = false;
  for (std::uint64_t pass = 0; pass < passes && !clean; ++pass) {
    const SpaceData now = space.data();
    view.space = {now.origin, now.edge, now.words};
    std::vector<Vector3> points = std::exchange(more, {});
    const bool whole_round = points.empty();
    for (std::uint64_t i = 0; whole_round && i < trials; ++i, ++drawn) {
      const bool at_border = drawn % border_every == 0 && !borders.empty();
      points.push_back(at_border ? borders.point(drawn) : band.point(drawn));
    }
    const std::vector<Outcome> found = outcomes(view, caster, tolerance, points);
    result.wrong = 0;
    clean = whole_round;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (found[i] == Outcome::clear) continue;
      if (found[i] == Outcome::close) {
        if (whole_round)
          look_about(points[i], trials_about_close, close_reach * tolerance, pass, more);
        continue;
      }
      clean = false;
      // An earlier failure's division may have mended this one as well.
      if (space.mend(points[i])) {
        ++result.mended;
      } else if (space.place(points[i]) == SpaceKind::told) {
        ++result.wrong;
      }
      look_about(points[i], trials_about_failure, about_reach * tolerance, pass, more);
    }
    // Where the answer was close, the places about it are looked at before a round counts as clean.
    clean = clean && (more.empty() || pass > 0);
    if (progress) {
      progress("sides", static_cast<double>(pass + 1) / static_cast<double>(passes));
    }
  }
  asset.space = space.data();
  count_cells(view, caster, space, result);
  return result;
}

}  // namespace spm::baker
