// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/side_trials.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "baker/band_trials.hpp"
#include "baker/random.hpp"
#include "common/closest_element.hpp"
#include "common/query.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t trials = 300'000;
constexpr std::uint64_t trials_about_failure = 64;
constexpr std::uint64_t trials_beside = 30'000;  ///< while failures are looked closer at
constexpr std::uint64_t passes = 24;
/// How far about a failure more trials lie, in tolerances.
constexpr double about_tolerances = 4;
constexpr std::uint64_t seed = 0x3E9D;

/// True where an asset tells the side of a point so wrong that its answer is off by more than the
/// tolerance.
bool is_wrong(const AssetView& view, const Caster& caster, double tolerance, const Vector3& point) {
  const Answer answer = query_point(view, point);
  if (answer.status == Status::pruned) return false;
  const ClosestPoint closest = caster.closest(point);
  // By a cap nothing is promised.
  if (closest.clear < std::min(tolerance, std::abs(closest.distance))) return false;
  const double truth = closest.distance;
  if (answer.status == Status::far) return truth < -tolerance;
  return (answer.distance < 0) != (truth < 0) && std::abs(answer.distance - truth) > tolerance;
}

/// The points at which the asset is wrong.
std::vector<Vector3> failures(const AssetView& view, const Caster& caster, double tolerance,
                              const std::vector<Vector3>& points) {
  std::vector<std::uint8_t> wrong(points.size(), 0);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    wrong[i] = is_wrong(view, caster, tolerance, points[i]) ? 1 : 0;
  });
  std::vector<Vector3> found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (wrong[i] != 0) found.push_back(points[i]);
  }
  return found;
}

void count_cells(const Asset& asset, const Caster& caster, const SpaceBuilder& space,
                 SideTrials& result) {
  const AssetTables tables = tables_of(asset);
  const Band& band = asset.metadata.band;
  space.visit_leaves([&](const SpaceNode& leaf) {
    if (leaf.kind == SpaceKind::far || leaf.kind == SpaceKind::pruned) return;
    const double distance = caster.closest(leaf.middle).distance;
    if (distance + std::sqrt(3.0) / 2 * leaf.edge < -band.max_depth) return;
    ++result.cells;
    const ElementReading reading = read_elements(tables.view(), leaf.middle, SpaceKind::inside);
    result.fallback_cells += reading.nearest.tile == nullptr ? 1 : 0;
  });
}

}  // namespace

SideTrials try_sides(Asset& asset, const Caster& caster, SpaceBuilder& space,
                     const Progress& progress) {
  SideTrials result;
  const double tolerance = *asset.metadata.tolerance;
  const BandTrials band(caster, asset.metadata.band, tolerance, seed);
  std::vector<Vector3> more;
  std::uint64_t drawn = 0;
  for (std::uint64_t pass = 0; pass < passes; ++pass) {
    asset.space = space.data();
    const AssetTables tables = tables_of(asset);
    std::vector<Vector3> points = std::move(more);
    const std::uint64_t fresh = points.empty() ? trials : trials_beside;
    for (std::uint64_t i = 0; i < fresh; ++i) points.push_back(band.point(drawn++));
    const std::vector<Vector3> wrong = failures(tables.view(), caster, tolerance, points);
    result.wrong = 0;
    more.clear();
    for (std::size_t i = 0; i < wrong.size(); ++i) {
      // An earlier failure's division may have mended this one as well.
      if (space.mend(wrong[i])) {
        ++result.mended;
      } else if (space.place(wrong[i]) == SpaceKind::told) {
        ++result.wrong;
      }
      for (std::uint64_t k = 0; k < trials_about_failure && more.size() < trials; ++k) {
        const std::uint64_t index = 3 * (i * trials_about_failure + k);
        const Vector3 away(random_unit(seed + 1 + pass, index),
                           random_unit(seed + 1 + pass, index + 1),
                           random_unit(seed + 1 + pass, index + 2));
        more.push_back(wrong[i] + about_tolerances * tolerance * (2 * away - Vector3::Constant(1)));
      }
    }
    if (progress) {
      progress("sides", static_cast<double>(pass + 1) / static_cast<double>(passes));
    }
    if (wrong.empty() && fresh == trials) break;
  }
  asset.space = space.data();
  count_cells(asset, caster, space, result);
  return result;
}

}  // namespace spm::baker
