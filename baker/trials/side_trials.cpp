// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trials/side_trials.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "baker/trials/band_trials.hpp"
#include "baker/trials/border_trials.hpp"
#include "common/base/random.hpp"
#include "common/query/closest_element.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t trials = 400'000;
/// One of this many trials lies at a tile's border.
constexpr std::uint64_t border_every = 4;
constexpr std::uint64_t trials_about_failure = 64;
constexpr std::uint64_t trials_about_close = 8;
constexpr std::uint64_t trials_about_near = 16;
constexpr std::uint64_t passes = 24;
/// Votes that differ by less than this are close.
constexpr double close_margin = 0.25;
/// How far from a failure and from a close place the additional trials lie, in tolerances.
constexpr double about_radius = 4;
constexpr double close_radius = 1;
/// An error above this share of the tolerance is nearly a failure. Places around it are tried, then
/// places around the worst of those. With each step the threshold rises and the places lie nearer.
constexpr double near_share = 0.65;
constexpr double near_step = 0.07;
constexpr double near_radius = 0.6;
constexpr double nearer = 0.7;
constexpr std::uint64_t seed = 0x3E9D;

/// The outcome of a trial.
struct Outcome {
  double error = 0;    ///< share of the tolerance; above 1 the answer is wrong
  bool close = false;  ///< the votes for the two sides hardly differ
};

/// Queries the distance of a point. Where a cube gives the side, the side cannot be wrong.
Outcome outcome_at(const AssetView& view, const Caster& caster, double tolerance,
                   const Vector3& point) {
  if (sign_at(view.sign_octree, point) != SignKind::boundary) return {};
  const ElementReading reading = read_elements(view, point, CubeKind::boundary);
  const ClosestPoint closest = caster.closest(point);
  // Near a cap nothing is promised.
  if (closest.clearance < std::min(tolerance, std::abs(closest.distance))) return {};
  const double error = signed_distance(view, reading) - closest.distance;
  return {std::abs(error) / tolerance, reading.sides.margin() < close_margin};
}

std::vector<Outcome> outcomes(const AssetView& view, const Caster& caster, double tolerance,
                              const std::vector<Vector3>& points) {
  std::vector<Outcome> result(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    result[i] = outcome_at(view, caster, tolerance, points[i]);
  });
  return result;
}

/// Evaluates the trials of a pass: resolves what is wrong, and finds the places of the next pass.
class Followed {
 public:
  Followed(SignOctreeBuilder& sign_octree, double tolerance, SideTrials& counts)
      : sign_octree_(sign_octree), tolerance_(tolerance), counts_(counts) {}

  /// The places to try next, around those with a bad outcome. Empty where there are none left.
  [[nodiscard]] std::vector<Vector3> take() { return std::exchange(more_, {}); }
  [[nodiscard]] bool done() const { return more_.empty(); }

  /// Evaluates a pass. `step` is 0 for places all over; each pass around other places adds one.
  /// True if no answer was wrong.
  bool follow(const std::vector<Vector3>& points, const std::vector<Outcome>& found, int step,
              std::uint64_t pass) {
    bool right = true;
    counts_.wrong = 0;
    const double near = near_share + near_step * step;
    const double nearer_by = std::pow(nearer, step);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (found[i].error > 1) {
        right = false;
        resolve(points[i]);
        look_about(points[i], trials_about_failure, about_radius, pass);
      } else if (found[i].error > near) {
        look_about(points[i], trials_about_near, near_radius * nearer_by, pass);
      } else if (found[i].close && step == 0) {
        look_about(points[i], trials_about_close, close_radius, pass);
      }
    }
    return right;
  }

 private:
  SignOctreeBuilder& sign_octree_;
  double tolerance_;
  SideTrials& counts_;
  std::vector<Vector3> more_;

  void resolve(const Vector3& point) {
    // The division for an earlier failure may have resolved this one as well.
    if (sign_octree_.resolve(point)) {
      ++counts_.resolved;
    } else if (sign_octree_.place(point) == SignKind::boundary) {
      ++counts_.wrong;
    }
  }

  /// Adds places around one to those of the next pass, at most so many tolerances away.
  void look_about(const Vector3& point, std::uint64_t count, double tolerances,
                  std::uint64_t pass) {
    const double radius = tolerances * tolerance_;
    for (std::uint64_t k = 0; k < count && more_.size() < trials; ++k) {
      const std::uint64_t index = 3 * more_.size();
      const auto random = [&](std::uint64_t n) { return random_unit(seed + 1 + pass, index + n); };
      const Vector3 away(random(0), random(1), random(2));
      more_.push_back(point + radius * (2 * away - Vector3::Constant(1)));
    }
  }
};

void count_cells(const AssetView& view, const Caster& caster, const SignOctreeBuilder& sign_octree,
                 SideTrials& result) {
  sign_octree.visit_leaves([&](const SignOctreeNode& leaf) {
    if (leaf.kind == SignKind::far || leaf.kind == SignKind::pruned) return;
    const double distance = caster.closest(leaf.middle).distance;
    if (distance + std::sqrt(3.0) / 2 * leaf.edge < -view.band.max_depth) return;
    ++result.cells;
    const ElementReading reading = read_elements(view, leaf.middle, CubeKind::inside);
    result.fallback_cells += reading.nearest.tile == nullptr ? 1 : 0;
  });
}

}  // namespace

SideTrials try_sides(Asset& asset, const Caster& caster, SignOctreeBuilder& sign_octree,
                     const Progress& progress) {
  SideTrials result;
  const double tolerance = *asset.metadata.tolerance;
  const BandTrials band(caster, asset.metadata.band, tolerance, seed);
  // Only the space changes from pass to pass.
  const AssetTables tables = tables_of(asset);
  AssetView view = tables.view();
  const BorderTrials borders(view, seed);
  Followed followed(sign_octree, tolerance, result);
  std::uint64_t drawn = 0;
  bool clean = false, right = true;
  int step = 0;
  // A round, and all passes that follow from it, must find no failure.
  for (std::uint64_t pass = 0; pass < passes && !clean; ++pass) {
    const SignOctreeData now = sign_octree.data();
    view.sign_octree = {now.origin, now.edge, now.words};
    std::vector<Vector3> points = followed.take();
    step = points.empty() ? 0 : step + 1;
    for (std::uint64_t i = 0; step == 0 && i < trials; ++i, ++drawn) {
      const bool at_border = drawn % border_every == 0 && !borders.empty();
      points.push_back(at_border ? borders.point(drawn) : band.point(drawn));
    }
    const std::vector<Outcome> found = outcomes(view, caster, tolerance, points);
    right = followed.follow(points, found, step, pass) && (right || step == 0);
    clean = right && followed.done();
    if (progress) {
      progress("sides", static_cast<double>(pass + 1) / static_cast<double>(passes));
    }
  }
  asset.sign_octree = sign_octree.data();
  count_cells(view, caster, sign_octree, result);
  return result;
}

}  // namespace spm::baker
