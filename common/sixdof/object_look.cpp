// SPDX-License-Identifier: Apache-2.0
// The search for contacts, down to the finest samples.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/query/query.hpp"
#include "common/sixdof/object_contact.hpp"
#include "common/sixdof/sample_vectors.hpp"

namespace spm {

/// Adds a sample above the finest to `found` unless it, and everything below it, is clear of the
/// object. `above`: the sample above it. How far it and everything below it is from touching, m; 0
/// where they may touch, or be near.
double ObjectContact::look(std::uint32_t sample, std::uint32_t object, const Active& above,
                           std::vector<Active>& found, ObjectContactReport& report) noexcept {
  if (is_finest(sample)) return touch(sample, object, above, report);
  Pair& pair = pairs_[object];
  Active active;
  active.sample = sample;
  active.object = static_cast<std::uint16_t>(object);
  active.cluster = sample < clustered_ ? static_cast<std::uint16_t>(sample) : above.cluster;
  float& until = until_[std::size_t{object} * coarse_ + sample];
  const double way = way_of(pair, active.cluster);
  if (way + (until > 0 ? ahead_ : 0) < std::abs(static_cast<double>(until))) {
    const double left = static_cast<double>(until) - way;
    if (until > 0) return spare_of(pair, active.cluster, left);
    found.push_back(active);
    return 0;
  }
  until = 0;
  ++report.tested;
  const auto radius = static_cast<double>(tool_.places[sample].radius) + pair.lift;
  const auto let_go = [&](double spare) {
    until = pair.after(way, spare);
    return spare_of(pair, active.cluster, spare);
  };
  const double moved = above.known() ? from_above(sample, above.sample) : 0;
  // A field changes by at most the length of a step, so the sample above may tell enough.
  const double told = static_cast<double>(above.distance) - moved - pair.doubt;
  if (above.known() && told > radius + ahead_) return let_go(told - radius);
  if (above.known() && moved == 0) {
    active.distance = above.distance;
    active.normal = above.normal;
  } else {
    Vector3 normal;
    active.distance = static_cast<float>(ask(pair, place_of(pair, sample), normal, report));
    active.normal = floats_of(normal);
  }
  const double least = static_cast<double>(active.distance) - pair.doubt;
  if (least > radius + ahead_) return let_go(least - radius);
  // Before the pair has gone so far it is not clear: those below it are looked at without it.
  const double idle = radius + ahead_ - least;
  if (idle > 0) until = -pair.after(way, idle);
  found.push_back(active);
  return 0;
}

/// Presses a finest sample, if it touches. How far it is from touching, m; 0 where it is near.
double ObjectContact::touch(std::uint32_t sample, std::uint32_t object, const Active& above,
                            ObjectContactReport& report) noexcept {
  Pair& pair = pairs_[object];
  const std::uint32_t cluster = sample < clustered_ ? sample : above.cluster;
  float* const known = finest_until(object);
  const double way = way_of(pair, cluster);
  if (known != nullptr && way + ahead_ < static_cast<double>(known[sample])) {
    return spare_of(pair, cluster, static_cast<double>(known[sample]) - way);
  }
  const auto let_go = [&](double spare) {
    if (known != nullptr) known[sample] = pair.after(way, spare);
    return spare_of(pair, cluster, spare);
  };
  ++report.tested;
  const double moved = above.known() ? from_above(sample, above.sample) : 0;
  const double told = static_cast<double>(above.distance) - moved - pair.doubt;
  if (above.known() && told > pair.lift + ahead_) return let_go(told - pair.lift);
  const Vector3 place = place_of(pair, sample);
  Vector3 normal;
  double distance = 0;
  if (above.known() && moved == 0) {
    distance = static_cast<double>(above.distance);
    normal = vector_of(above.normal);
  } else {
    distance = ask(pair, place, normal, report);
  }
  const double spare = distance - pair.doubt - pair.lift;
  if (spare > ahead_) return let_go(spare);
  if (ahead_ > 0 && near_.size() < near_.capacity()) {
    Near& near = near_.emplace_back();
    near.sample = sample;
    near.object = static_cast<std::uint16_t>(object);
    near.cluster = static_cast<std::uint16_t>(cluster);
    take_plane(pair, way, place, distance, normal, near);
  }
  press_by(sample, object, cluster, place, distance, normal);
  return 0;
}

/// Tells a finest sample that is near.
void ObjectContact::note(const Pair& pair, std::uint32_t sample, const Vector3& place,
                         double distance, const Vector3& normal) noexcept {
  // A textured surface is no plane.
  if (contacts_.size() == contacts_.capacity() || pair.lift > 0) {
    near_known_ = false;
    return;
  }
  const Vector3 arm = place - pair.pose.translation();
  const double side = pair.mirrored ? -1 : 1;
  const Vector3 way = pair.to_world * normal, turn = side * (pair.to_world * arm.cross(normal));
  NearContact& near = contacts_.emplace_back();
  for (std::size_t k = 0; k < 3; ++k) {
    near.along[k] = static_cast<float>(way[static_cast<Eigen::Index>(k)]);
    near.along[3 + k] = static_cast<float>(turn[static_cast<Eigen::Index>(k)]);
  }
  near.distance = static_cast<float>(distance);
  near.spring = static_cast<float>(
      pair.stiffness * std::max(static_cast<double>(tool_.shares[sample].area), pair.least_area));
}

/// Presses a finest sample where it touches, and tells it where it is near.
void ObjectContact::press_by(std::uint32_t sample, std::uint32_t object, std::uint32_t cluster,
                             const Vector3& place, double distance,
                             const Vector3& normal) noexcept {
  Pair& pair = pairs_[object];
  const double spare = distance - pair.doubt - pair.lift;
  pair.spare = std::min(pair.spare, std::max(spare, 0.0));
  if (distance < near_reach_ + pair.lift && !normal.isZero(0))
    note(pair, sample, place, distance, normal);
  if (distance < pair.lift && !normal.isZero(0)) {
    press_finest(sample, object, cluster, place, distance, normal);
  }
}

/// Keeps that all samples below one are clear.
void ObjectContact::note_clear(const Active& above, double spare) noexcept {
  const Pair& pair = pairs_[above.object];
  until_[std::size_t{above.object} * coarse_ + above.sample] =
      pair.after(way_of(pair, above.cluster), spare);
}

/// Replaces the active samples by those below them. False where time or room ran out: then `next_`
/// has the finer ones that were reached, and the active ones from `left_` on represent the rest.
bool ObjectContact::refine(std::uint32_t level, const TickBudget& budget, WorkClock& clock,
                           std::size_t waiting, ObjectContactReport& report) noexcept {
  next_.clear();
  const bool lists = level + 1 < tool_.levels.size();
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Active& parent = active_[i];
    const SampleChildren& below = tool_.children[parent.sample];
    // A sample is either replaced completely by those below it, or kept.
    const bool full = lists && next_.size() + below.count > next_.capacity();
    const std::size_t to_press =
        budget.whole_levels ? active_.size() : next_.size() + active_.size() - i;
    const bool late = clock.over(report.asked, report.worked, to_press + waiting);
    if (full || late) {
      report.stopped = late;
      left_ = i;
      report.refined = static_cast<double>(i) / static_cast<double>(active_.size());
      report.degraded = true;
      return false;
    }
    report.worked += below.count;
    double spare = std::numeric_limits<double>::infinity();
    for (std::uint32_t k = 0; k < below.count; ++k) {
      spare = std::min(spare, look(below.first + k, parent.object, parent, next_, report));
    }
    if (spare > ahead_) note_clear(parent, spare);
  }
  std::swap(active_, next_);
  next_.clear();
  if (!lists) active_.clear();
  return true;
}

/// Looks at all samples of one object that may touch, level by level, as long as there is time.
/// `waiting`: samples of other objects that are still to be looked at.
void ObjectContact::look_at_object(std::uint32_t object, const TickBudget& budget, WorkClock& clock,
                                   std::size_t waiting, ObjectContactReport& report) noexcept {
  Pair& pair = pairs_[object];
  const auto levels = static_cast<std::uint32_t>(tool_.levels.size());
  const SampleLevel& coarsest = tool_.levels.front();
  const std::size_t listed = near_.size();
  active_.clear();
  next_.clear();
  left_ = 0;
  clock.go_on();
  for (std::uint32_t k = 0; k < coarsest.count; ++k) {
    look(coarsest.first + k, object, {}, active_, report);
  }
  const std::uint32_t finest =
      budget.same_levels ? pair.level : std::min(budget.finest_level, levels - 1);
  std::uint32_t level = 0;
  while (!active_.empty() && level < finest && !report.stopped) {
    const std::size_t patches = patches_.size(), touches = touches_.size();
    if (refine(level + 1, budget, clock, waiting, report)) {
      ++level;
      continue;
    }
    if (!budget.whole_levels) break;
    // As if that level had not been begun.
    left_ = 0;
    next_.clear();
    start_over(pair, patches, touches);
    break;
  }
  // Nothing else can touch, and that holds down to the finest level.
  if (active_.empty()) level = levels - 1;
  if (!budget.same_levels) pair.level = level;
  report.level = std::min(report.level, level);
  end_list(pair, listed, level + 1 == levels);
  press_coarser(pair, clock, report);
}

/// Presses what was not resolved to the finest level of an object.
void ObjectContact::press_coarser(Pair& pair, WorkClock& clock,
                                  ObjectContactReport& report) noexcept {
  const std::span<Active> left = std::span(active_).subspan(left_);
  if (next_.empty() && left.empty()) return;
  report.unresolved += report.stopped ? 1 : 0;
  pair.spare = 0;
  press_time_ = clock.time_of(next_.size() + left.size(), [&] {
    for (Active& active : next_) press_coarse(active, report);
    for (Active& active : left) press_coarse(active, report);
  });
}

/// Looks at all samples that may touch, object by object: where time ends, what was found of those
/// before holds on, and the next ticks need less time for them. Those that press the tool come
/// first.
void ObjectContact::look_to_finest(std::size_t count, const TickBudget& budget, WorkClock& clock,
                                   ObjectContactReport& report) noexcept {
  const auto finest = static_cast<std::uint32_t>(tool_.levels.size()) - 1;
  std::size_t waiting = 0;
  const auto looks = [](const Pair& pair) { return pair.present && pair.looked && !pair.asleep; };
  for (std::uint32_t object = 0; object < count; ++object) {
    Pair& pair = pairs_[object];
    if (!pair.present || !pair.looked) continue;
    pair.listed = !look_at_all(pair) && ahead_ > 0;
    if (pair.asleep) pair.level = finest;
    if (looks(pair)) waiting += tool_.levels.front().count;
  }
  report.level = finest;
  for (const bool presses : {true, false}) {
    for (std::uint32_t object = 0; object < count; ++object) {
      if (!looks(pairs_[object]) || pairs_[object].presses != presses) continue;
      waiting -= tool_.levels.front().count;
      look_at_object(object, budget, clock, waiting, report);
    }
  }
  if (!report.degraded) press_time_ = clock.time_of(0, [] {});
}

}  // namespace spm
