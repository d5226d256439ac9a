// SPDX-License-Identifier: Apache-2.0
// The search for contacts. What touches is pressed in object_press.cpp.
#include "common/sixdof/object_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/rigid_pose.hpp"
#include "common/query/query.hpp"
#include "common/sixdof/sample_vectors.hpp"

namespace spm {

namespace {

/// A level of at most this many samples may be the clusters of patches.
constexpr std::uint32_t max_clusters = 400;
constexpr std::size_t max_pressed_patches = 128;  ///< at most 256, as patch_at_ counts
constexpr std::size_t max_touches = 1024;
/// Objects of which the finest samples are remembered.
constexpr std::uint32_t max_slots = 8;
constexpr std::size_t max_whole = 1024, max_near = 8192, max_told = 1536;
constexpr std::size_t least_room = 1024;  ///< of active samples

}  // namespace

ObjectContact::ObjectContact(const SurfaceSamples& tool, const ObjectContactSettings& settings)
    : tool_(tool),
      settings_(settings),
      coarse_(tool.levels.empty() ? 0 : tool.levels.back().first),
      pairs_(settings.objects),
      grip_(tool.levels.empty() ? 0 : tool.levels.back().count, settings.objects),
      until_(std::size_t{settings.objects} * coarse_, 0.0F),
      slots_(std::min(settings.objects, max_slots), -1) {
  if (!tool.levels.empty()) finest_until_.assign(slots_.size() * tool.levels.back().count, 0.0F);
  // All of the level above the finest, with one object.
  const std::size_t above = tool.levels.size() > 1 ? tool.levels[tool.levels.size() - 2].count : 0;
  // The coarsest level with every object there may be always has room.
  const std::size_t coarsest =
      tool.levels.empty() ? 1 : std::size_t{settings.objects} * tool.levels.front().count;
  const std::size_t room =
      std::max(std::min<std::size_t>(settings.max_active, std::max(least_room, above)), coarsest);
  active_.reserve(room);
  next_.reserve(room);
  whole_.reserve(max_whole);
  near_.reserve(max_near);
  contacts_.reserve(max_told);
  kept_contacts_.reserve(max_told);
  room_.reserve(max_told + max_told / 2);
  patches_.reserve(max_pressed_patches);
  kept_.reserve(max_pressed_patches);
  touches_.reserve(max_touches);
  kept_touches_.reserve(max_touches);
  for (const SampleLevel& level : tool.levels) {
    if (level.count > max_clusters && clustered_ > 0) break;
    clustered_ = level.first + level.count;
    summed_level_ = static_cast<std::uint32_t>(&level - tool.levels.data());
  }
  ways_.assign(std::size_t{settings.objects} * clustered_, 0.0);
  // In each that presses a sample is active.
  clusters_.reserve(std::min(ways_.size(), next_.capacity()));
  spares_.assign(ways_.size(), 0.0F);
  patch_at_.assign(ways_.size(), 0);
}

std::size_t ObjectContact::bytes() const noexcept {
  return pairs_.capacity() * sizeof(Pair) + ways_.capacity() * sizeof(ways_[0]) +
         (until_.capacity() + finest_until_.capacity() + spares_.capacity()) * sizeof(until_[0]) +
         (active_.capacity() + next_.capacity()) * sizeof(Active) +
         (patches_.capacity() + kept_.capacity()) * sizeof(PressedPatch) + patch_at_.capacity() +
         (touches_.capacity() + kept_touches_.capacity()) * sizeof(Touch) +
         whole_.capacity() * sizeof(Whole) + near_.capacity() * sizeof(Near) +
         (contacts_.capacity() + kept_contacts_.capacity() + room_.capacity()) *
             sizeof(NearContact) +
         clusters_.bytes() + grip_.bytes();
}

void ObjectContact::forget(std::uint32_t object) noexcept {
  if (object >= pairs_.size()) return;
  pairs_[object].placed = pairs_[object].in_grip = false;
  grip_.forget(object);
}

void ObjectContact::forget() noexcept {
  for (std::uint32_t object = 0; object < pairs_.size(); ++object) forget(object);
  listed_ahead_ = 0;
  for (Pair& pair : pairs_) pair.slot = -1;
  std::fill(slots_.begin(), slots_.end(), -1);
  press_time_ = WorkClock::least_press_time;
  start_over();
  drop();
}

/// How far a sample is from the one above it, m.
double ObjectContact::from_above(std::uint32_t sample, std::uint32_t above) const noexcept {
  const auto &a = tool_.places[sample].position, &b = tool_.places[above].position;
  const double x = a[0] - double{b[0]}, y = a[1] - double{b[1]}, z = a[2] - double{b[2]};
  return std::sqrt(x * x + y * y + z * z);
}

/// Queries the field at a sample's position. The normal is zero where the distance, m of the world,
/// is a lower bound.
double ObjectContact::ask(Pair& pair, const Vector3& place, Vector3& normal,
                          ObjectContactReport& report) noexcept {
  ++report.asked;
  const Vector3 asked = pair.scale == 1 ? place : Vector3(place / pair.scale);
  const Answer answer = pair.cursor.query(asked);
  if (is_known(answer.status)) {
    normal = answer.normal;
    return pair.scale * answer.distance;
  }
  normal.setZero();
  return pair.scale * pair.cursor.clearance(asked);
}

/// Adds a sample above the finest to `found` unless it, and everything below it, is clear of the
/// object or was pressed whole. `above`: the sample above it.
void ObjectContact::look(std::uint32_t sample, std::uint32_t object, const Active& above,
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
    if (until > 0) spare_of(pair, active.cluster, static_cast<double>(until) - way);
    if (until < 0) found.push_back(active);
    return;
  }
  until = 0;
  ++report.tested;
  const auto radius = static_cast<double>(tool_.places[sample].radius) + pair.lift;
  const auto let_go = [&](double spare) {
    until = pair.after(way, spare);
    spare_of(pair, active.cluster, spare);
  };
  const double moved = above.known() ? from_above(sample, above.sample) : 0;
  // A field changes by at most the length of a step, so the sample above may tell enough.
  const double told = static_cast<double>(above.distance) - moved - pair.doubt;
  if (above.known() && told > radius + ahead_) return let_go(told - radius);
  const Vector3 place = place_of(pair, sample);
  if (above.known() && moved == 0) {
    active.distance = above.distance;
    active.normal = above.normal;
  } else {
    Vector3 normal;
    active.distance = static_cast<float>(ask(pair, place, normal, report));
    active.normal = floats_of(normal);
  }
  const auto distance = static_cast<double>(active.distance);
  const double least = distance - pair.doubt;
  if (least > radius + ahead_) return let_go(least - radius);
  if (settle_whole(active, place, until)) return;
  // Before the pair has gone so far it is not clear, nor inside and pressed whole: those below it
  // are looked at without it.
  double idle = radius + ahead_ - least;
  if (ahead_ == 0) idle = std::min(idle, distance - pair.lift);
  if (idle > 0) until = -pair.after(way, idle);
  found.push_back(active);
}

/// Where one polynomial is the field about all samples below one, they are clear or pressed
/// together. False where they are not.
bool ObjectContact::settle_whole(const Active& active, const Vector3& place,
                                 float& until) noexcept {
  Pair& pair = pairs_[active.object];
  const SamplePlace& own = tool_.places[active.sample];
  const auto radius = static_cast<double>(own.radius);
  const Vector3 asked = pair.scale == 1 ? place : Vector3(place / pair.scale);
  // The cursor may be elsewhere: a sample at the place of the one above was not queried.
  if (!active.has_normal() || !pair.cursor.is_quadric(asked, radius / pair.scale)) return false;
  LocalQuadric field = pair.cursor.quadric(asked);
  field.distance *= pair.scale;
  field.bend /= pair.scale;
  const SampleMoments& moments = tool_.moments[active.sample];
  const double slope = field.slope.norm();
  const double along =
      std::abs(field.slope.dot(pair.pose.linear() * tool_.shares[active.sample].normal()));
  constexpr double one = std::numeric_limits<std::uint16_t>::max();
  const double across = std::sqrt(std::max(0.0, slope * slope - along * along));
  const double extent = radius * std::min(slope, along * moments.thickness / one + across) +
                        field.bend.norm() * radius * radius;
  const double clear = field.distance - extent - pair.lift;
  if (clear > (ahead_ > 0 ? ahead_ + pair.doubt : 0)) {
    const double spare = std::max(0.0, clear - pair.doubt);
    if (spare > 0) until = pair.after(way_of(pair, active.cluster), spare);
    spare_of(pair, active.cluster, spare);
    return true;
  }
  // Each sample counts for itself where it has a bristle, a texture or a least area.
  const bool alike = !pair.grip.on() && !(pair.lift > 0) && !(pair.least_area > 0) && ahead_ == 0;
  const bool pressed = field.distance + extent < 0 &&
                       field.distance - extent >= -pair.scale * pair.field->band.max_depth;
  if (!alike || !pressed || moments.count == 0 || whole_.size() == whole_.capacity()) return false;
  pair.spare = 0;
  whole_.push_back({active.sample, active.object, active.cluster, field});
  return true;
}

/// Presses a finest sample, if it touches.
void ObjectContact::touch(std::uint32_t sample, std::uint32_t object, const Active& above,
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
    spare_of(pair, cluster, spare);
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
  if (known != nullptr) known[sample] = until_near(pair, way, distance);
  press_by(sample, object, cluster, place, distance, normal);
}

/// When a finest sample at a distance, m, is to be asked again: before it touches, or is near.
float ObjectContact::until_near(Pair& pair, double way, double distance) const noexcept {
  const double spare = distance - pair.lift - std::max(pair.doubt, near_reach_);
  return spare > 0 ? pair.after(way, spare) : 0;
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

/// Presses a finest sample where it touches, and lists it where it is near.
void ObjectContact::press_by(std::uint32_t sample, std::uint32_t object, std::uint32_t cluster,
                             const Vector3& place, double distance,
                             const Vector3& normal) noexcept {
  Pair& pair = pairs_[object];
  const double spare = distance - pair.doubt - pair.lift;
  pair.spare = std::min(pair.spare, std::max(spare, 0.0));
  if (ahead_ > 0 && spare < ahead_) {
    if (near_.size() < near_.capacity()) {
      near_.push_back({sample, object, cluster});
    } else {
      listed_ahead_ = -1;
    }
  }
  if (distance < near_reach_ + pair.lift && !normal.isZero(0))
    note(pair, sample, place, distance, normal);
  if (distance < pair.lift && !normal.isZero(0)) {
    press_finest(sample, object, cluster, place, distance, normal);
  }
}

/// Replaces the active samples by those below them. False where time or room ran out: then `next_`
/// has the finer ones that were reached, and the active ones from `left_` on represent the rest.
bool ObjectContact::refine(std::uint32_t level, const TickBudget& budget, WorkClock& clock,
                           ObjectContactReport& report) noexcept {
  next_.clear();
  const std::size_t whole_before = whole_.size();
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
      whole_.erase(whole_.begin() + static_cast<std::ptrdiff_t>(whole_before), whole_.end());
      start_over();
      return false;
    }
    report.worked += below.count;
    for (std::uint32_t k = 0; k < below.count; ++k) {
      look(below.first + k, parent.object, parent, next_, report);
    }
  }
  report.level = level;
  std::swap(active_, next_);
  next_.clear();
  if (!lists) active_.clear();
  return true;
}

/// Looks at all samples that may touch, level by level, as long as there is time.
void ObjectContact::look_to_finest(std::size_t count, const TickBudget& budget, WorkClock& clock,
                                   ObjectContactReport& report) noexcept {
  const auto levels = static_cast<std::uint32_t>(tool_.levels.size());
  const SampleLevel& coarsest = tool_.levels.front();
  for (std::uint32_t object = 0; object < count; ++object) {
    if (!pairs_[object].present || !look_at_all(pairs_[object])) continue;
    for (std::uint32_t k = 0; k < coarsest.count; ++k) {
      look(coarsest.first + k, object, {}, active_, report);
    }
  }
  for (std::uint32_t level = 1; level < levels && level <= budget.finest_level; ++level) {
    if (active_.empty()) {
      // Nothing else can touch, and that holds down to the finest level.
      report.level = levels - 1;
      break;
    }
    if (!refine(level, budget, clock, report)) break;
  }
  const std::span<Active> left = std::span(active_).subspan(left_);
  for (const Whole& whole : whole_) press_whole(whole);
  press_time_ = clock.time_of(next_.size() + left.size(), [&] {
    for (Active& active : next_) press_coarse(active, report);
    for (Active& active : left) press_coarse(active, report);
  });
}

ObjectContactReport ObjectContact::tick(const Eigen::Isometry3d& tool_pose,
                                        std::span<const ContactObject> objects,
                                        const TickBudget& budget) noexcept {
  ObjectContactReport report;
  WorkClock clock(budget, press_time_);
  active_.clear();
  next_.clear();
  whole_.clear();
  contacts_.clear();
  near_reach_ = budget.near;
  near_known_ = budget.near > 0;
  start_over();
  left_ = 0;
  if (tool_.levels.empty() || !keeps_lengths(tool_pose)) return report;
  const std::size_t count = std::min(objects.size(), pairs_.size());
  const auto levels = static_cast<std::uint32_t>(tool_.levels.size());
  for (Pair& pair : pairs_) pair.present = false;
  for (std::uint32_t object = 0; object < count; ++object) {
    if (objects[object].field == nullptr || !keeps_lengths(objects[object].pose) ||
        !(objects[object].scale > 0)) {
      continue;
    }
    set_out(objects[object], pairs_[object], tool_pose);
  }
  if (budget.finest_level >= levels - 1 && has_list(budget.ahead)) {
    look_near(report);
    sum_up(report);
    return report;
  }
  begin_list(budget.ahead);
  const bool settles = can_settle(budget);
  for (Pair& pair : pairs_) {
    if (!pair.present) continue;
    // What is clear as a point may touch as a square.
    if (pair.settles != settles) {
      begin_travel(pair);
      pair.clear = 0;
    }
    pair.settles = settles;
    if (!settles) continue;
    // The sums are of the tool's axes.
    pair.axes = tool_pose.linear();
    pair.side = tool_pose.linear().determinant() < 0 ? -1 : 1;
  }
  if (settles) {
    look_by_levels(budget, clock, report);
  } else {
    look_to_finest(count, budget, clock, report);
  }
  sum_up(report);
  // Samples that were not resolved to the finest level may touch.
  const bool all = !report.degraded && report.level + 1 == levels;
  if (!all) near_known_ = false;
  for (Pair& pair : pairs_) {
    if (!pair.present) continue;
    if (!all && !pair.asleep) pair.spare = 0;
    if (!pair.asleep) pair.clear = pair.spare;
    report.clearance = std::min(report.clearance, pair.spare);
  }
  end_list(report);
  return report;
}

}  // namespace spm
