// SPDX-License-Identifier: Apache-2.0
// Looks that follow one another within a short way: only samples that were near are looked at.
#include <algorithm>

#include "common/sixdof/object_contact.hpp"
#include "common/sixdof/sample_vectors.hpp"

namespace spm {

/// Whether the listed samples are all that can touch.
bool ObjectContact::has_list(double ahead) const noexcept {
  if (!(ahead > 0) || !(listed_ahead_ > 0)) return false;
  return std::all_of(pairs_.begin(), pairs_.end(), [this](const Pair& pair) {
    if (!pair.present) return true;
    const double since = pair.travelled - pair.listed_at;
    return pair.listed && pair.lift == pair.listed_lift && since >= 0 && since < listed_ahead_;
  });
}

void ObjectContact::begin_list(double ahead) noexcept {
  near_.clear();
  ahead_ = listed_ahead_ = ahead;
  for (Pair& pair : pairs_) pair.listed = false;
}

/// The list holds where all contact was resolved to the finest level.
void ObjectContact::end_list(const ObjectContactReport& report) noexcept {
  ahead_ = 0;
  if (report.degraded || report.level + 1 < tool_.levels.size()) listed_ahead_ = 0;
  if (!(listed_ahead_ > 0)) return;
  for (Pair& pair : pairs_) {
    pair.listed = pair.present;
    pair.listed_at = pair.travelled;
    pair.listed_lift = pair.lift;
  }
}

void ObjectContact::look_near(ObjectContactReport& report) noexcept {
  for (const Pair& pair : pairs_) {
    if (!pair.present) continue;
    const double left = listed_ahead_ - (pair.travelled - pair.listed_at);
    report.clearance = std::min(report.clearance, left);
  }
  for (const Near& near : near_) {
    Pair& pair = pairs_[near.object];
    if (!pair.present) continue;
    ++report.tested;
    const Vector3 place =
        turned(pair.pose.linear(), tool_.places[near.sample].position) + pair.pose.translation();
    Vector3 normal;
    const double distance = ask(pair, place, normal, report);
    press_by(near.sample, near.object, near.cluster, place, distance, normal, report);
  }
  report.worked = static_cast<std::uint32_t>(near_.size());
  report.level = static_cast<std::uint32_t>(tool_.levels.size()) - 1;
}

}  // namespace spm
