// SPDX-License-Identifier: Apache-2.0
// Begin and end of a look. How samples are looked at stands in object_look.cpp, what those that
// touch push with in object_press.cpp.
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
/// Levels above the finest whose patches the field's planes part from it where levels are settled.
constexpr std::size_t plane_levels = 2;
constexpr std::size_t max_pressed_patches = 128;  ///< at most 256, as patch_at_ counts
constexpr std::size_t max_touches = 1024;
/// Objects of which the finest samples are remembered.
constexpr std::uint32_t max_slots = 8;
constexpr std::size_t max_near = 6144, max_told = 1536;
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
  by_plane_ = clustered_;
  if (tool.levels.size() > plane_levels) {
    by_plane_ = std::max(by_plane_, tool.levels[tool.levels.size() - 1 - plane_levels].first);
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
         near_.capacity() * sizeof(Near) +
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

ObjectContactReport ObjectContact::tick(const Eigen::Isometry3d& tool_pose,
                                        std::span<const ContactObject> objects,
                                        const TickBudget& budget) noexcept {
  ObjectContactReport report;
  WorkClock clock(budget, press_time_);
  contacts_.clear();
  near_reach_ = budget.near;
  near_known_ = budget.near > 0;
  as_points_ = budget.as_points;
  start_over();
  if (tool_.levels.empty() || !keeps_lengths(tool_pose)) return report;
  const std::size_t count = std::min(objects.size(), pairs_.size());
  const auto levels = static_cast<std::uint32_t>(tool_.levels.size());
  for (Pair& pair : pairs_) pair.present = pair.presses = false;
  for (const PressedPatch& patch : kept_) pairs_[patch.object].presses = true;
  for (std::uint32_t object = 0; object < count; ++object) {
    if (objects[object].field == nullptr || !keeps_lengths(objects[object].pose) ||
        !(objects[object].scale > 0)) {
      continue;
    }
    set_out(objects[object], pairs_[object], tool_pose);
  }
  choose_looks(budget);
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
    // A tick's first look has to know them all.
    look_near(budget.same_levels ? &clock : nullptr, report);
    clock.grant(budget.anew);
    ahead_ = budget.ahead;
    look_to_finest(count, budget, clock, report);
  }
  sum_up(report.sum);
  // Samples that were not resolved to the finest level may touch.
  const bool all = !report.degraded && report.level + 1 == levels;
  // Not all samples were looked at.
  if (report.stopped && budget.same_levels) near_known_ = false;
  for (Pair& pair : pairs_) {
    if (!pair.present) continue;
    if (!all && pair.settles && !pair.asleep) pair.spare = 0;
    if (pair.looked && !pair.asleep) pair.clear = pair.spare;
    report.clearance = std::min(report.clearance, pair.spare);
  }
  ahead_ = 0;
  return report;
}

}  // namespace spm
