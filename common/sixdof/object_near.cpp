// SPDX-License-Identifier: Apache-2.0
// Looks that follow one another within a short way: only samples that were near are looked at.
#include <algorithm>

#include "common/sixdof/object_contact.hpp"
#include "common/sixdof/sample_vectors.hpp"
#include "common/sixdof/tool_motion.hpp"

namespace spm {

namespace {

/// Of the way for which samples are listed, the part that is left when an object among others is
/// looked at anew, so that not all are in one tick.
constexpr double stale_share = 0.5;

}  // namespace

/// Which objects are to be looked at anew: those whose listed samples are not all that may touch.
/// Where there are none, and a tick begins, the one whose list is the oldest.
void ObjectContact::choose_looks(const TickBudget& budget) noexcept {
  // The finest samples alone are listed.
  const bool lists =
      budget.ahead > 0 && std::size_t{budget.finest_level} + 1 >= tool_.levels.size();
  if (!lists || budget.ahead != listed_ahead_) drop_lists();
  listed_ahead_ = budget.ahead;
  bool any = false, gone = false;
  std::size_t others = 0;
  Pair* oldest = nullptr;
  double least = stale_share * listed_ahead_;
  for (Pair& pair : pairs_) {
    if (!pair.present) {
      gone = gone || pair.listed;
      pair.listed = false;
      continue;
    }
    if (pair.listed) pair.spare = left_of_list(pair, listed_ahead_);
    // None of the samples of one that is asleep is listed, so none is told where it is near.
    pair.looked = !pair.listed || !(pair.spare > (pair.asleep ? near_reach_ : 0));
    any = any || pair.looked;
    if (pair.looked) continue;
    ++others;
    if (!(pair.spare < least)) continue;
    least = pair.spare;
    oldest = &pair;
  }
  if (!any && oldest != nullptr && others > 1 && !budget.same_levels) any = oldest->looked = true;
  if (!any && !gone) return;
  std::erase_if(near_, [this](const Near& near) {
    return !pairs_[near.object].present || pairs_[near.object].looked;
  });
}

void ObjectContact::drop_lists() noexcept {
  near_.clear();
  for (Pair& pair : pairs_) pair.listed = false;
}

/// The list of an object holds where all contact was resolved to the finest level. `first`: where
/// it begins.
void ObjectContact::end_list(Pair& pair, std::size_t first, bool resolved) noexcept {
  pair.listed = ahead_ > 0 && resolved && near_.size() < near_.capacity();
  if (!pair.listed) near_.erase(near_.begin() + static_cast<std::ptrdiff_t>(first), near_.end());
}

/// Keeps what a near sample met: until it may touch, that plane tells how far it is.
void ObjectContact::take_plane(const Pair& pair, double way, const Vector3& place, double distance,
                               const Vector3& normal, Near& near) const noexcept {
  const double spare = distance - pair.lift - pair.doubt;
  near.until = spare > 0 ? pair.after(way, spare) : 0;
  near.normal = floats_of(normal);
  near.offset = static_cast<float>(normal.dot(place) - distance);
}

/// Looks at the listed samples of the objects that are not looked at anew; with a clock, as long as
/// there is time.
void ObjectContact::look_near(WorkClock* clock, ObjectContactReport& report) noexcept {
  const Near* before = nullptr;
  for (Near& near : near_) {
    Pair& pair = pairs_[near.object];
    if (!pair.present || pair.looked) continue;
    if (clock != nullptr && clock->over(report.asked, report.worked, 0)) {
      report.stopped = report.degraded = true;
      return;
    }
    ++report.worked;
    if (before == nullptr || before->cluster != near.cluster || before->object != near.object) {
      pair.since = ToolMotion(pair.looked_at, pair.pose).of(tool_.places[near.cluster]);
    }
    before = &near;
    const double way = way_of(pair, near.cluster);
    const Vector3 place = place_of(pair, near.sample);
    Vector3 normal = vector_of(near.normal);
    if (way < static_cast<double>(near.until)) {
      pair.spare = std::min(pair.spare, static_cast<double>(near.until) - way);
      const double told = normal.dot(place) - static_cast<double>(near.offset);
      if (told < near_reach_ + pair.lift && !normal.isZero(0)) {
        note(pair, near.sample, place, std::max(told, 0.0), normal);
      }
      continue;
    }
    ++report.tested;
    const double distance = ask(pair, place, normal, report);
    take_plane(pair, way, place, distance, normal, near);
    press_by(near.sample, near.object, near.cluster, place, distance, normal);
  }
}

}  // namespace spm
