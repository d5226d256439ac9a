// SPDX-License-Identifier: Apache-2.0
#include "common/contour/line_crossings.hpp"

#include <algorithm>
#include <cmath>

#include "common/contour/surface_box.hpp"
#include "common/query/octree_query.hpp"

namespace spm {

namespace {

constexpr double most_lines = 1U << 20U;  ///< side by side
/// Answers are off by a tolerance each, so two answers agree on a way that is shorter by two.
constexpr double slack_tolerances = 2;
/// Steps are no shorter than this share of the octree, whatever the tolerance.
constexpr double least_share = 1e-6;
/// Crossings are found to this share of the shortest step.
constexpr double exact_share = 1e-3;
constexpr int most_halvings = 30;
/// Crossings that contradict each other lie within so many shortest steps.
constexpr double same_steps = 8;

}  // namespace

LineLattice line_lattice(const AssetView& asset, double step) noexcept {
  const auto [low, size] = surface_box(asset);
  LineLattice lattice;
  lattice.low = low;
  for (int axis = 0; axis < 3; ++axis) {
    const double count = std::clamp(std::ceil(size[axis] / step), 1.0, most_lines);
    lattice.count[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(count);
    lattice.step[axis] = size[axis] / count;
  }
  return lattice;
}

CrossingSearch::CrossingSearch(const AssetView& asset, std::size_t most_queries)
    : asset_(asset),
      slack_(slack_tolerances * asset.tolerance),
      least_step_(std::max(asset.tolerance, least_share * extent_of(asset).size.maxCoeff())),
      left_(most_queries) {}

CrossingSearch::Place CrossingSearch::ask(const Leaf& leaf, const Vector3& place) noexcept {
  Place told{place, Vector3::Zero(), 0, Side::unknown};
  if (left_ == 0) return told;
  --left_;
  const Answer answer = query_leaf(asset_, leaf, place);
  if (answer.status != Status::exact || !std::isfinite(answer.distance)) return told;
  told.normal = answer.normal;
  told.distance = answer.distance;
  told.side = answer.distance < 0 ? Side::inside : Side::outside;
  return told;
}

/// The crossing between two places of one leaf that lie on different sides.
CrossingSearch::Place CrossingSearch::between(const Leaf& leaf, int axis, Place before,
                                              Place after) noexcept {
  const double enough = exact_share * least_step_;
  Place middle = before;
  for (int i = 0; i < most_halvings && after.at[axis] - before.at[axis] > enough; ++i) {
    // Where it would be if distances were linear, and in the middle by turns, so that it ends.
    const double share =
        i % 2 == 0 ? std::clamp(before.distance / (before.distance - after.distance), 0.01, 0.99)
                   : 0.5;
    Vector3 at = before.at;
    at[axis] += share * (after.at[axis] - before.at[axis]);
    middle = ask(leaf, at);
    if (middle.side == Side::unknown || std::abs(middle.distance) <= enough) return middle;
    (middle.side == before.side ? before : after) = middle;
  }
  return middle;
}

/// Goes on to the end of a leaf that has answers.
void CrossingSearch::walk_leaf(const Leaf& leaf, int axis, double end, Place& last) {
  Vector3 at = last.at;
  bool entry = true;
  while (left_ > 0) {
    const Place next = ask(leaf, at);
    if (next.side != Side::unknown && last.side != Side::unknown && next.side != last.side) {
      meet(axis, entry ? next : between(leaf, axis, last, next), next.side == Side::inside);
    }
    last = next;
    entry = false;
    if (at[axis] >= end) return;
    const double away = std::abs(next.distance) - slack_;
    at[axis] = std::min(end, at[axis] + std::max(away, least_step_));
  }
}

void CrossingSearch::meet(int axis, const Place& at, bool enters) {
  if (at.normal == Vector3::Zero()) return;
  if (enters == (at.normal[axis] < 0)) {
    found_.push_back({at.at, at.normal});
    return;
  }
  // Two cubes tell the surface on different sides of their border: it was met there already.
  if (!found_.empty() && at.at[axis] - found_.back().place[axis] <= same_steps * least_step_) {
    found_.pop_back();
  }
}

const std::vector<SurfaceCrossing>& CrossingSearch::along(int axis, const Vector3& through) {
  found_.clear();
  const Extent extent = extent_of(asset_);
  Place last{through, Vector3::Zero(), 0, Side::outside};
  last.at[axis] = extent.low[axis];
  const double end = extent.low[axis] + extent.size[axis];
  const double nudge = 1e-6 * least_step_;
  while (left_ > 0 && last.at[axis] < end) {
    --left_;
    const Leaf leaf = leaf_at(asset_.octree, last.at);
    if (leaf.level < 0) break;
    const double next = std::clamp(leaf.middle[axis] + leaf.half, last.at[axis] + nudge, end);
    switch (leaf.kind) {
      case OctreeKind::far:
        last.side = Side::outside;
        break;
      case OctreeKind::deep:
        last.side = Side::inside;
        break;
      case OctreeKind::pruned:
        last.side = Side::unknown;
        break;
      default:
        walk_leaf(leaf, axis, next, last);
        break;
    }
    last.at[axis] = next;
  }
  if (left_ == 0) found_.clear();
  return found_;
}

}  // namespace spm
