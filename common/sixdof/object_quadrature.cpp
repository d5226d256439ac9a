// SPDX-License-Identifier: Apache-2.0
// The penalty as an integral over the tool's surface, by levels of samples that are refined until
// that changes the sum no more.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "common/sixdof/coarse_press.hpp"
#include "common/sixdof/object_contact.hpp"
#include "common/sixdof/sample_vectors.hpp"

namespace spm {

namespace {

// The numbers were chosen on a duck that slides over a fan disk, and on a rocker arm over a cow,
// not on the drill and the teeth that spm-bench judges by.

/// How far parts of a finest sample are from its middle, over the root of its area.
constexpr double square_reach = 0.5;
/// m: a bound of a distance that is longer than this beyond a sample's radius is not sought.
constexpr double useful_way = 5e-4;
/// m: how far a sample is from touching is told by those below it.
constexpr double kept_for_below = std::numeric_limits<double>::infinity();

/// m: by how much a patch is farther from an object on the average than at its middle, since the
/// field bends: by the trace of that, 1/m, and the patch's half-extent, m. Along each of its two
/// directions the patch's variance is a third of the square. A bend that turns the normal too far
/// within the patch is not that of all of it.
double bent_away(float bend, float spread) noexcept {
  const double half = static_cast<double>(spread), turns = static_cast<double>(bend) * half;
  return std::abs(turns) < 1 ? turns * half / 3 * (1 - std::abs(turns)) : 0;
}

}  // namespace

/// m: how far parts of a sample are from it.
double ObjectContact::reach_of(std::uint32_t sample) const noexcept {
  return is_finest(sample)
             ? square_reach * std::sqrt(static_cast<double>(tool_.shares[sample].area))
             : static_cast<double>(tool_.places[sample].radius);
}

bool ObjectContact::can_settle(const TickBudget& budget) const noexcept {
  // Each sample counts for itself where it has a bristle, a texture or a least area.
  return budget.accuracy > 0 && !(budget.ahead > 0) && !(budget.near > 0) && !budget.whole_levels &&
         std::all_of(pairs_.begin(), pairs_.end(), [](const Pair& pair) {
           return !pair.present || (!pair.grip.on() && !(pair.lift > 0) && !(pair.least_area > 0));
         });
}

/// How far parts of a sample's patch are deeper or higher than its middle, and what it adds to the
/// sum of its level.
void ObjectContact::weigh(Active& active, Pair& pair) noexcept {
  const SampleSpread& spread = tool_.spreads[active.sample];
  const Arm along = arm_of(active.normal), middle = arm_of(spread.middle);
  const double depth = -static_cast<double>(active.distance) - along.dot(middle) -
                       bent_away(active.bend, spread.spread);
  const auto most = static_cast<double>(spread.spread);
  if (!(depth > -most)) return;
  const SampleShare& share = tool_.shares[active.sample];
  double pressed = depth, part = 1;
  // Deeper, all of it presses, whatever its normal is.
  if (depth < most) {
    const double sine = sine_between(along.x, along.y, along.z, share.packed_normal);
    active.half = static_cast<float>(most * sine);
    const CoarsePress press = coarse_press(depth, static_cast<double>(active.half));
    pressed = press.depth;
    part = press.share;
  }
  const double force = static_cast<double>(share.area) * pressed;
  if (!(force > 0)) return;
  const Arm arm = arm_of(tool_.places[active.sample].position) + middle;
  LevelSum& sum = pair.level_sum;
  const double x = force * along.x, y = force * along.y, z = force * along.z;
  const std::array<double, 3> forces{x, y, z};
  const std::array<double, 3> torques{arm.y * z - arm.z * y, arm.z * x - arm.x * z,
                                      arm.x * y - arm.y * x};
  for (std::size_t k = 0; k < 3; ++k) {
    sum.force[static_cast<Eigen::Index>(k)] += forces[k];
    sum.torque[static_cast<Eigen::Index>(k)] += torques[k];
  }
  clusters_.add(key_of(active), forces, torques);
  sum.pressing += force;
  sum.contacts += part;
}

/// Adds a part of the spring of a sample's patch. All in the tool's axes.
void ObjectContact::press(const Active& active, float weight) noexcept {
  if (!active.has_normal()) return;
  Arm arm = arm_of(tool_.places[active.sample].position);
  const Arm along = arm_of(active.normal);
  auto depth = -static_cast<double>(active.distance);
  if (!is_finest(active.sample)) {
    const SampleSpread& spread = tool_.spreads[active.sample];
    const Arm middle = arm_of(spread.middle);
    depth -= along.dot(middle) + bent_away(active.bend, spread.spread);
    arm = arm + middle;
  }
  const CoarsePress press = coarse_press(depth, static_cast<double>(active.half));
  if (!(press.depth > 0)) return;
  const Pair& pair = pairs_[active.object];
  const double spring = static_cast<double>(weight) * pair.stiffness *
                        static_cast<double>(tool_.shares[active.sample].area);
  press_part(active, spring, press, {along.x, along.y, along.z}, {arm.x, arm.y, arm.z});
}

/// Takes up a sample unless it, and everything below it, is clear. How far it is from touching, m;
/// kept_for_below where those below it tell that.
double ObjectContact::meet(Active& active, Pair& pair, double way, float* until,
                           ObjectContactReport& report) noexcept {
  const double least = static_cast<double>(active.distance) - pair.doubt;
  const double spare = least - reach_of(active.sample);
  if (spare > 0) {
    if (until != nullptr) *until = pair.after(way, spare);
    return spare;
  }
  if (is_finest(active.sample)) {
    if (until != nullptr) *until = 0;
    press_finest_square(active, report);
    return 0;
  }
  if (active.distance > 0 && is_by_plane(active.sample) && active.has_normal()) {
    if (const double clear = above_plane(active); clear > 0) {
      if (until != nullptr) *until = pair.after(way, clear);
      return 0;
    }
  }
  // Before it is clear, or adds to a sum, those below it are looked at without it.
  double idle = -spare;
  if (is_summed(active.sample)) {
    if (active.has_normal()) weigh(active, pair);
    // Beyond the band there is no normal, and without one no force.
    const SampleSpread& spread = tool_.spreads[active.sample];
    const double reach =
        std::min(length(spread.middle) + static_cast<double>(spread.spread), pair.field_ends);
    idle = std::min(idle, least - reach);
  }
  if (until != nullptr) *until = idle > 0 ? -pair.after(way, idle) : 0;
  return kept_for_below;
}

/// Queries the field at a place of the tool, and tells where that is, in the object's frame and
/// unit of length.
QueriedDistance ObjectContact::query_at(Pair& pair, const Arm& at, Vector3& place,
                                        ObjectContactReport& report) noexcept {
  ++report.asked;
  const Eigen::Matrix3d& turn = pair.pose.linear();
  for (int k = 0; k < 3; ++k) {
    const double world =
        turn(k, 0) * at.x + turn(k, 1) * at.y + turn(k, 2) * at.z + pair.pose.translation()[k];
    place[k] = pair.scale == 1 ? world : world / pair.scale;
  }
  return pair.cursor.distance(place);
}

/// How far all that presses below a sample is above the object, m, if the field is a plane's about
/// it; 0 or below where it may press. A plane is no bound: what is nearer beside the plane, as in a
/// corner, is found by the samples there.
double ObjectContact::above_plane(const Active& active) const noexcept {
  const Arm along = arm_of(active.normal);
  const double sine =
      sine_between(along.x, along.y, along.z, tool_.shares[active.sample].packed_normal);
  const double cosine = std::sqrt(std::max(0.0, 1 - sine * sine));
  return static_cast<double>(active.distance) - extent(active.sample, cosine, sine) -
         square_half * tool_.levels.back().spacing * sine;
}

/// Whether any of what a sample represents can press at its distance, whatever its normal is, or a
/// plane may part it.
bool ObjectContact::needs_normal(const Active& active) const noexcept {
  const auto distance = static_cast<double>(active.distance);
  if (is_finest(active.sample)) {
    const auto area = static_cast<double>(tool_.shares[active.sample].area);
    return distance < 0 || distance * distance < square_half * square_half * area;
  }
  if (is_by_plane(active.sample)) return distance < reach_of(active.sample);
  const SampleSpread& spread = tool_.spreads[active.sample];
  const double beyond = distance - static_cast<double>(spread.spread);
  const Arm middle = arm_of(spread.middle);
  return beyond < 0 || beyond * beyond < middle.dot(middle);
}

/// Queries the field at a sample.
void ObjectContact::ask_of(Active& active, Pair& pair, ObjectContactReport& report) noexcept {
  const SamplePlace& sample = tool_.places[active.sample];
  Vector3 place;
  const QueriedDistance found = query_at(pair, arm_of(sample.position), place, report);
  if (!found.known()) {
    const double useful = static_cast<double>(sample.radius) + useful_way;
    active.distance =
        static_cast<float>(pair.scale * pair.cursor.clearance(place, useful / pair.scale));
    return;
  }
  active.distance = static_cast<float>(pair.scale * found.distance);
  active.bend = 0;
  if (!needs_normal(active)) return;
  active.bend = static_cast<float>(pair.cursor.bend() / pair.scale);
  // The pose of a mirrored object mirrors too, and its transpose back.
  const Eigen::Matrix3d& turn = pair.pose.linear();
  const Vector3& normal = pair.cursor.normal();
  const double x = normal[0], y = normal[1], z = normal[2];
  for (unsigned k = 0; k < 3; ++k) {
    active.normal[k] = static_cast<float>(turn(0, k) * x + turn(1, k) * y + turn(2, k) * z);
  }
}

/// Looks at a sample below another one. How far it is from touching, as `meet`.
double ObjectContact::look_at(Active& active, Pair& pair, double way, float* until,
                              const Active& above, ObjectContactReport& report) noexcept {
  ++report.tested;
  if (above.known()) {
    // A field changes by at most the length of a step, so the sample above may tell enough.
    const double least = static_cast<double>(above.distance) - pair.doubt;
    if (active.sample == tool_.children[above.sample].first) {
      // At the same place.
      active.distance = above.distance;
      active.normal = above.normal;
      active.bend = above.bend;
      if (!active.exact() || active.has_normal() || !needs_normal(active)) {
        return meet(active, pair, way, until, report);
      }
    }
    const double left = least - reach_of(active.sample);
    if (left > 0) {
      const double spare = left - from_above(active.sample, above.sample);
      if (spare > 0) {
        if (until != nullptr) *until = pair.after(way, spare);
        return spare;
      }
    }
  }
  ask_of(active, pair, report);
  return meet(active, pair, way, until, report);
}

/// Looks at samples that lie below one, or at the coarsest of all: then `above` tells their object
/// alone. How far all of them are from touching, m; 0 where that is not known of each.
double ObjectContact::look_over(std::uint32_t first, std::uint32_t count, const Active& above,
                                ObjectContactReport& report) noexcept {
  Pair& pair = pairs_[above.object];
  float* const until =
      is_finest(first) ? finest_until(above.object) : &until_[std::size_t{above.object} * coarse_];
  const bool clusters = first < clustered_;
  std::uint32_t cluster = above.cluster;
  double way = clusters ? 0 : way_of(pair, cluster);
  double least = kept_for_below;
  const std::size_t before = next_.size();
  for (std::uint32_t sample = first; sample < first + count; ++sample) {
    if (clusters) {
      if (sample > first) spare_of(pair, cluster, least);
      least = kept_for_below;
      cluster = sample;
      way = way_of(pair, cluster);
    }
    float* const own = until != nullptr ? until + sample : nullptr;
    const double until_then = own != nullptr ? static_cast<double>(*own) : 0;
    if (way < until_then) {
      // It, and everything below it, is clear.
      least = std::min(least, until_then - way);
      continue;
    }
    // Written in its place: a copy of what was written piece by piece would stall.
    Active& active = next_.emplace_back();
    active.sample = sample;
    active.object = above.object;
    active.cluster = static_cast<std::uint16_t>(cluster);
    active.weight = above.weight;
    // It would tell nothing yet.
    if (way < -until_then) continue;
    const double spare = look_at(active, pair, way, own, above, report);
    if (spare < kept_for_below) {
      next_.pop_back();
      least = std::min(least, spare);
    }
  }
  // What planes part is not certain to be clear.
  const bool certain = !is_by_plane(first);
  spare_of(pair, cluster, certain ? least : 0);
  const bool all_clear = next_.size() == before;
  // The sample above says no more than that of itself; and clusters' ways are not its own.
  const bool holds_above = !clusters && (certain || is_by_plane(above.sample));
  return all_clear && holds_above ? least : 0;
}

/// Looks level by level, as long as there is time and finer levels may change the sum.
void ObjectContact::look_by_levels(const TickBudget& budget, WorkClock& clock,
                                   ObjectContactReport& report) noexcept {
  const auto levels = static_cast<std::uint32_t>(tool_.levels.size());
  const SampleLevel& coarsest = tool_.levels.front();
  active_.clear();
  next_.clear();
  clusters_.begin();
  for (std::uint32_t object = 0; object < pairs_.size(); ++object) {
    Pair& pair = pairs_[object];
    pair.level_sum = pair.sum_before = {};
    if (!pair.present || !look_at_all(pair)) continue;
    Active all;
    all.object = static_cast<std::uint16_t>(object);
    look_over(coarsest.first, coarsest.count, all, report);
  }
  std::swap(active_, next_);
  next_.clear();
  std::size_t done = 0;
  while (!report.degraded && report.level < std::min(levels - 1, budget.finest_level)) {
    if (!settle_level(report.level, budget.accuracy)) {
      report.level = levels - 1;
      break;
    }
    const bool lists = report.level + 2 < levels;
    for (done = 0; done < active_.size(); ++done) {
      const Active& above = active_[done];
      const SampleChildren& below = tool_.children[above.sample];
      const bool full = lists && next_.size() + below.count > next_.capacity();
      report.stopped =
          clock.over(report.asked, report.worked, next_.size() + active_.size() - done);
      report.degraded = full || report.stopped;
      if (report.degraded) break;
      report.worked += below.count;
      const double spare = look_over(below.first, below.count, above, report);
      if (spare > 0) note_clear(above, spare);
    }
    if (report.degraded) {
      report.refined = static_cast<double>(done) / static_cast<double>(active_.size());
      break;
    }
    ++report.level;
    std::swap(active_, next_);
    next_.clear();
    done = 0;
  }
  const std::span<Active> rest = std::span(active_).subspan(done);
  press_time_ = clock.time_of(next_.size() + rest.size(), [&] {
    for (const Active& active : next_) press(active, active.weight);
    for (const Active& active : rest) press(active, active.weight);
  });
}

}  // namespace spm
