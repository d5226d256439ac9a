// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/border_jumps.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "baker/verify/outcome.hpp"
#include "common/base/random.hpp"
#include "common/field/octree_leaves.hpp"
#include "common/query/query.hpp"

namespace spm::baker {
namespace {

constexpr double apart = 1e-9;  // m, from one place that is asked to the other
constexpr std::uint64_t max_draws = 64;
constexpr std::uint64_t numbers = 4;  // random, for each draw

/// What was found at one place of a border.
struct Jump {
  bool drawn = false;                              ///< a place where both sides answer was found
  bool contested = false;                          ///< close to the medial axis
  std::pair<std::uint32_t, std::uint32_t> leaves;  ///< their words, the lower first
  double distance = 0;                             ///< m
  double direction = -1;                           ///< rad; negative where none is defined
  Vector3 place = Vector3::Zero();
};

/// Leaves that may answer `exact`. Each has words of its own, so the place of the first names it.
std::vector<Leaf> answering_leaves(const DistanceOctree& octree) {
  std::vector<Leaf> leaves;
  visit_leaves(octree, [&leaves](const Leaf& leaf) {
    if (has_answers(leaf.kind)) leaves.push_back(leaf);
  });
  return leaves;
}

/// Draws a place on a face of a leaf, and compares the answers on its two sides.
Jump draw(const JumpSetting& setting, const std::vector<Leaf>& leaves, std::uint64_t index) {
  const auto random = [&](std::uint64_t which) {
    return random_unit(setting.seed, numbers * index + which);
  };
  const auto which = static_cast<std::size_t>(random(0) * static_cast<double>(leaves.size()));
  const Leaf& leaf = leaves[std::min(which, leaves.size() - 1)];
  const int face = std::min(static_cast<int>(6 * random(1)), 5);
  const int axis = face / 2;
  Vector3 across = Vector3::Zero();
  across[axis] = face % 2 == 0 ? -1 : 1;
  Jump jump;
  jump.place = leaf.middle + leaf.half * across;
  jump.place[(axis + 1) % 3] += leaf.half * (2 * random(2) - 1);
  jump.place[(axis + 2) % 3] += leaf.half * (2 * random(3) - 1);
  const Vector3 here = jump.place - apart / 2 * across, there = jump.place + apart / 2 * across;
  const Answer from = query_point(setting.view, here), to = query_point(setting.view, there);
  jump.drawn = from.status == Status::exact && to.status == Status::exact &&
               std::min(from.distance, to.distance) >= -setting.band.max_depth;
  if (!jump.drawn) return jump;
  jump.leaves = std::minmax(leaf.word, leaf_at(setting.view.octree, there).word);
  jump.distance = std::abs(from.distance - to.distance);
  jump.direction = std::atan2(from.normal.cross(to.normal).norm(), from.normal.dot(to.normal));
  return jump;
}

Jump measure(const JumpSetting& setting, const std::vector<Leaf>& leaves, std::uint64_t index) {
  Jump jump;
  for (std::uint64_t attempt = 0; attempt < max_draws && !jump.drawn; ++attempt) {
    jump = draw(setting, leaves, index * max_draws + attempt);
  }
  if (!jump.drawn) return jump;
  if (index >= most_directions) {
    jump.direction = -1;
    return jump;
  }
  const SurfacePoint closest = setting.surface.closest(jump.place);
  if ((jump.place - closest.position).norm() < min_distance_of_direction) {
    jump.direction = -1;
  } else {
    jump.contested = setting.surface.contested(jump.place, closest, 2 * setting.tolerance);
  }
  return jump;
}

DirectionSummary summarise_directions(std::vector<double> angles) {
  const ErrorSummary all = summarise(std::move(angles));
  return {all.p50, all.p99, all.max};
}

}  // namespace

JumpReport border_jumps(const JumpSetting& setting, std::uint64_t count) {
  JumpReport report;
  report.allowed = allowed_jump(setting.tolerance);
  const std::vector<Leaf> leaves = answering_leaves(setting.view.octree);
  if (setting.view.full || leaves.empty()) return report;
  std::vector<Jump> jumps(count);
  tbb::parallel_for(std::size_t{0}, jumps.size(),
                    [&](std::size_t i) { jumps[i] = measure(setting, leaves, i); });
  std::vector<double> distances, clear, contested;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> borders;
  double worst = -1;
  for (const Jump& jump : jumps) {
    if (!jump.drawn) continue;
    ++report.places;
    borders.push_back(jump.leaves);
    distances.push_back(jump.distance);
    // A distance that is not a number is no less bad than one that is too far off.
    report.beyond += jump.distance <= report.allowed ? 0 : 1;
    if (jump.direction >= 0) (jump.contested ? contested : clear).push_back(jump.direction);
    if (jump.distance <= worst) continue;
    worst = jump.distance;
    report.worst_point = jump.place;
  }
  std::sort(borders.begin(), borders.end());
  report.borders =
      static_cast<std::uint64_t>(std::unique(borders.begin(), borders.end()) - borders.begin());
  report.contested = contested.size();
  report.distance = summarise(std::move(distances));
  report.direction = summarise_directions(std::move(clear));
  report.contested_direction = summarise_directions(std::move(contested));
  return report;
}

}  // namespace spm::baker
