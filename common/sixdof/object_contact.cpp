// SPDX-License-Identifier: Apache-2.0
// The search for contacts. What touches is pressed in object_press.cpp.
#include "common/sixdof/object_contact.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/base/rigid_pose.hpp"
#include "common/query/query.hpp"
#include "common/sixdof/sample_vectors.hpp"

namespace spm {

namespace {

/// Reduction of a clearance by the errors of two field values, in tolerances: at the sample that
/// was queried, and at the one that is not.
constexpr double doubtful_tolerances = 2;
/// Ratio of the largest validity radius to the error that an answer may have when it is used again.
constexpr double reaches_an_error = 50;
/// A patch is not queried again before it has moved by this part of its radius. Until then the old
/// reading bounds its distance, and is used where no finer sample is reached.
constexpr double stale_share = 0.5;
/// m: clearances are kept in floats, so what was travelled is counted anew from time to time.
constexpr double longest_travel = 32;
/// What rounding to a float may add, as a factor.
constexpr double rounded_down = 1 - 0x1p-22;
/// A level of at most this many samples may be the clusters of patches.
constexpr std::uint32_t max_clusters = 400;
constexpr std::size_t max_pressed_patches = 128;
constexpr std::size_t max_touches = 1024;
constexpr std::size_t least_room = 1024;  ///< of active samples
constexpr double first_press_time = 100;  // ns
constexpr std::uint32_t sample_bits = 21;
constexpr std::uint32_t max_exchanges = (1U << (32 - sample_bits)) - 1;

/// Answers that a tool's memory has room for, where the number is not named.
std::uint32_t remembered_of(const SurfaceSamples& tool, std::uint32_t named) noexcept {
  if (named > 0) return named;
  const auto finest =
      static_cast<std::uint32_t>(tool.levels.empty() ? 0 : tool.levels.back().count);
  return std::clamp(std::bit_ceil(finest / 3 + 1), 1024U, 262144U);
}

}  // namespace

ObjectContact::ObjectContact(const SurfaceSamples& tool, const ObjectContactSettings& settings)
    : tool_(tool),
      settings_(settings),
      coarse_(tool.levels.empty() ? 0 : tool.levels.back().first),
      pairs_(settings.objects),
      memory_({settings.max_validity_radius, settings.max_validity_radius / reaches_an_error,
               remembered_of(tool, settings.remembered)}),
      grip_(tool.levels.empty() ? 0 : tool.levels.back().count, settings.objects),
      until_(std::size_t{settings.objects} * coarse_, 0.0F),
      press_time_(first_press_time) {
  // All of the level above the finest, with one object.
  const std::size_t above = tool.levels.size() > 1 ? tool.levels[tool.levels.size() - 2].count : 0;
  const std::size_t room =
      std::min<std::size_t>(settings.max_active, std::max<std::size_t>(least_room, above));
  active_.reserve(std::max<std::size_t>(room, 1));
  next_.reserve(std::max<std::size_t>(room, 1));
  patches_.reserve(max_pressed_patches);
  kept_.reserve(max_pressed_patches);
  touches_.reserve(max_touches);
  kept_touches_.reserve(max_touches);
  for (const SampleLevel& level : tool.levels) {
    if (level.count > max_clusters && clustered_ > 0) break;
    clustered_ = level.first + level.count;
  }
  for (Pair& pair : pairs_) renew(pair);
}

std::size_t ObjectContact::bytes() const noexcept {
  return pairs_.capacity() * sizeof(Pair) + until_.capacity() * sizeof(until_[0]) +
         (active_.capacity() + next_.capacity()) * sizeof(Active) +
         (patches_.capacity() + kept_.capacity()) * sizeof(PressedPatch) +
         (touches_.capacity() + kept_touches_.capacity()) * sizeof(Touch) + memory_.bytes() +
         grip_.bytes();
}

/// Gives a pair other numbers in the memory, so that what was known of it is not recalled.
void ObjectContact::renew(Pair& pair) noexcept {
  if (exchanges_ == max_exchanges) {
    memory_.forget();
    for (Pair& other : pairs_) other.placed = false;
    exchanges_ = 0;
  }
  pair.points = exchanges_++ << sample_bits;
}

void ObjectContact::forget(std::uint32_t object) noexcept {
  if (object >= pairs_.size()) return;
  pairs_[object].placed = pairs_[object].in_grip = false;
  grip_.forget(object);
}

void ObjectContact::forget() noexcept {
  for (std::uint32_t object = 0; object < pairs_.size(); ++object) forget(object);
  memory_.forget();
  exchanges_ = 0;
  press_time_ = first_press_time;
  start_over();
  drop();
}

/// Takes up where an object is in this tick.
void ObjectContact::set_out(const ContactObject& object, Pair& pair,
                            const Eigen::Isometry3d& tool) noexcept {
  const Eigen::Isometry3d pose = object.pose.inverse(Eigen::Isometry) * tool;
  pair.to_world = object.pose.linear();
  const bool same = pair.placed && pair.field == object.field && pair.scale == object.scale;
  if (same) {
    // A rotation by t moves a point at distance r from the axis by 2 r sin(t / 2).
    const double turn = (pose.linear() - pair.pose.linear()).norm() / std::sqrt(2.0);
    pair.travelled +=
        (pose * tool_.centre - pair.pose * tool_.centre).norm() + turn * tool_.radius * (1 + 1e-9);
  }
  if (!same || !(pair.travelled < longest_travel)) {
    const auto which = static_cast<std::ptrdiff_t>(&pair - pairs_.data());
    std::fill_n(until_.begin() + which * static_cast<std::ptrdiff_t>(coarse_), coarse_, 0.0F);
    pair.travelled = 0;
  }
  if (!same) renew(pair);
  pair.field = object.field;
  pair.scale = object.scale;
  pair.stiffness = object.stiffness > 0 ? object.stiffness : settings_.stiffness;
  pair.least_area = object.least_area;
  pair.doubt = doubtful_tolerances * object.scale * object.field->tolerance;
  pair.texture = object.texture;
  pair.lift = object.texture.amplitude > 0 ? object.texture.amplitude : 0;
  pair.grip = object.grip;
  pair.pose = pose;
  pair.placed = pair.present = true;
}

/// Queries the field at a sample's position.
FieldReading ObjectContact::read(const Pair& pair, std::uint32_t sample, const Vector3& place,
                                 ObjectContactReport& report) noexcept {
  FieldReading reading;
  reading.place = floats_of(place);
  ++report.asked;
  const Vector3 asked = pair.scale == 1 ? place : Vector3(place / pair.scale);
  const Answer answer = query_point(*pair.field, asked);
  if (answer.status == Status::exact || answer.status == Status::deep) {
    reading.distance = static_cast<float>(pair.scale * answer.distance);
    reading.normal = floats_of(answer.normal);
  } else {
    reading.distance = static_cast<float>(pair.scale * clearance(*pair.field, asked));
  }
  memory_.learn(pair.points | sample, reading);
  return reading;
}

/// Adds a sample above the finest to `found` unless it, and everything below it, is clear of the
/// object. `above`: the reading for the sample above it.
void ObjectContact::look(std::uint32_t sample, std::uint32_t object, std::uint32_t above_cluster,
                         const FieldReading& above, std::vector<Active>& found,
                         ObjectContactReport& report) noexcept {
  const std::uint32_t cluster = sample < clustered_ ? sample : above_cluster;
  if (is_finest(sample)) return touch(sample, object, cluster, above, report);
  const Pair& pair = pairs_[object];
  float& until = until_[std::size_t{object} * coarse_ + sample];
  if (pair.travelled < std::abs(static_cast<double>(until))) {
    const auto end = static_cast<double>(until);
    if (until > 0) report.clearance = std::min(report.clearance, end - pair.travelled);
    if (until < 0) found.push_back({sample, object, cluster, 0, {}});
    return;
  }
  until = 0;
  ++report.tested;
  const Vector3 place =
      turned(pair.pose.linear(), tool_.places[sample].position) + pair.pose.translation();
  const auto radius = static_cast<double>(tool_.places[sample].radius) + pair.lift;
  const auto let_go = [&](double spare) {
    until = static_cast<float>((pair.travelled + spare) * rounded_down);
    report.clearance = std::min(report.clearance, spare);
  };
  const FieldReading* reading = &above;
  FieldReading fresh;
  const auto add = [&](double distance) {
    Active& active = found.emplace_back();
    active.sample = sample;
    active.object = object;
    active.cluster = cluster;
    active.distance = static_cast<float>(distance);
    active.reading = *reading;
  };
  const bool same_place = above.known() && above.place == floats_of(place);
  if (!same_place && !above.stands_for(place)) {
    reading = &memory_.recall(pair.points | sample);
    if (reading->known() && !reading->stands_for(place)) {
      const double moved = reading->to(place).norm();
      const double least = static_cast<double>(reading->distance) - moved - pair.doubt;
      if (least > radius) return let_go(least - radius);
      if (moved < stale_share * radius) {
        add(reading->distance_at(place));
        return;
      }
    }
    if (!reading->stands_for(place)) {
      // A field changes by at most the length of a step, so the reading for the sample above may be
      // enough.
      const double least =
          static_cast<double>(above.distance) - above.to(place).norm() - pair.doubt;
      if (above.known() && least > radius) return let_go(least - radius);
      fresh = read(pair, sample, place, report);
      reading = &fresh;
    }
  }
  const double distance = reading->distance_at(place);
  const double least = distance - pair.doubt;
  if (least > radius) return let_go(least - radius);
  // How near the surface must be for the sample itself to touch. A patch so large that it extends
  // far from its sample says little about the contact.
  const SampleSpread& spread = tool_.spreads[sample];
  double own = least - pair.lift - length(spread.middle) - static_cast<double>(spread.spread);
  if (!reading->has_normal()) own = std::max(own, distance / 4);
  if (own > 0) until = -static_cast<float>((pair.travelled + own) * rounded_down);
  add(distance);
}

/// Presses a finest sample, if it touches.
void ObjectContact::touch(std::uint32_t sample, std::uint32_t object, std::uint32_t cluster,
                          const FieldReading& above, ObjectContactReport& report) noexcept {
  const Pair& pair = pairs_[object];
  ++report.tested;
  const Vector3 place =
      turned(pair.pose.linear(), tool_.places[sample].position) + pair.pose.translation();
  const FieldReading* reading = &above;
  FieldReading fresh;
  const auto clear = [&](const FieldReading& told) {
    const double least = static_cast<double>(told.distance) - told.to(place).norm() - pair.doubt;
    if (!told.known() || !(least > pair.lift)) return false;
    report.clearance = std::min(report.clearance, least - pair.lift);
    return true;
  };
  const bool same_place = above.known() && above.place == floats_of(place);
  if (!same_place && !above.stands_for(place)) {
    reading = &memory_.recall(pair.points | sample);
    if (!reading->stands_for(place)) {
      if (clear(*reading) || clear(above)) return;
      fresh = read(pair, sample, place, report);
      reading = &fresh;
    }
  }
  const double distance = reading->distance_at(place);
  const double spare = distance - pair.doubt - pair.lift;
  report.clearance = std::min(report.clearance, std::max(spare, 0.0));
  if (distance < pair.lift && reading->has_normal()) {
    press_finest(sample, object, cluster, place, distance, reading->outward());
  }
}

/// Replaces the active samples by those below them. False where time or room ran out: then `next_`
/// has the finer ones that were reached, and the active ones from `left_` on represent the rest.
bool ObjectContact::refine(std::uint32_t level, const TickBudget& budget, WorkClock& clock,
                           ObjectContactReport& report) noexcept {
  next_.clear();
  const bool lists = level + 1 < tool_.levels.size();
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Active& parent = active_[i];
    const SampleChildren& below = tool_.children[parent.sample];
    const std::size_t before = next_.size();
    const bool full = lists && before + below.count > next_.capacity();
    // A sample is either replaced completely by those below it, or kept.
    const bool late = clock.over(report.asked, report.worked, next_.size() + active_.size() - i);
    if (full || late) {
      report.stopped = late;
      left_ = i;
      report.refined = static_cast<double>(i) / static_cast<double>(active_.size());
      report.degraded = true;
      if (!budget.whole_levels) return false;
      left_ = 0;
      next_.clear();
      start_over();
      return false;
    }
    report.worked += below.count;
    for (std::uint32_t k = 0; k < below.count; ++k) {
      look(below.first + k, parent.object, parent.cluster, parent.reading, next_, report);
    }
  }
  report.level = level;
  std::swap(active_, next_);
  next_.clear();
  if (!lists) active_.clear();
  return true;
}

ObjectContactReport ObjectContact::tick(const Eigen::Isometry3d& tool_pose,
                                        std::span<const ContactObject> objects,
                                        const TickBudget& budget) noexcept {
  ObjectContactReport report;
  WorkClock clock(budget, press_time_);
  active_.clear();
  next_.clear();
  start_over();
  left_ = 0;
  if (tool_.levels.empty() || !keeps_lengths(tool_pose)) return report;
  const std::size_t count = std::min(objects.size(), pairs_.size());
  const SampleLevel& coarsest = tool_.levels.front();
  for (Pair& pair : pairs_) pair.present = false;
  for (std::uint32_t object = 0; object < count; ++object) {
    if (objects[object].field == nullptr || !keeps_lengths(objects[object].pose) ||
        !(objects[object].scale > 0)) {
      continue;
    }
    set_out(objects[object], pairs_[object], tool_pose);
    for (std::uint32_t k = 0; k < coarsest.count && active_.size() < active_.capacity(); ++k) {
      look(coarsest.first + k, object, 0, {}, active_, report);
    }
  }
  const auto levels = static_cast<std::uint32_t>(tool_.levels.size());
  for (std::uint32_t level = 1; level < levels && level <= budget.finest_level; ++level) {
    if (active_.empty()) {
      // Nothing can touch, and that holds down to the finest level.
      report.level = levels - 1;
      break;
    }
    if (!refine(level, budget, clock, report)) break;
  }
  const std::span<const Active> left = std::span(active_).subspan(left_);
  press_time_ = clock.time_of(next_.size() + left.size(), [&] {
    for (const Active& active : next_) press_coarse(active);
    for (const Active& active : left) press_coarse(active);
  });
  sum_up(report);
  // Samples that were not resolved to the finest level may touch.
  if (report.degraded || report.level + 1 < levels) report.clearance = 0;
  return report;
}

}  // namespace spm
