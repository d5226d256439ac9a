// SPDX-License-Identifier: Apache-2.0
// Looks that follow one another within a short way: only samples that were near are looked at.
#include <algorithm>

#include "common/sixdof/object_contact.hpp"
#include "common/sixdof/sample_vectors.hpp"
#include "common/sixdof/tool_motion.hpp"

namespace spm {

/// Whether the listed samples are all that can touch.
bool ObjectContact::has_list(double ahead) noexcept {
  if (!(ahead > 0) || !(listed_ahead_ > 0)) return false;
  return std::all_of(pairs_.begin(), pairs_.end(), [this](Pair& pair) {
    if (!pair.present) return true;
    if (pair.listed) pair.spare = left_of_list(pair, listed_ahead_);
    return pair.listed && pair.spare > 0;
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
  }
}

void ObjectContact::look_near(ObjectContactReport& report) noexcept {
  const Near* before = nullptr;
  for (const Near& near : near_) {
    Pair& pair = pairs_[near.object];
    if (!pair.present) continue;
    if (before == nullptr || before->cluster != near.cluster || before->object != near.object) {
      pair.since = ToolMotion(pair.looked_at, pair.pose).of(tool_.places[near.cluster]);
    }
    before = &near;
    float* const known = finest_until(near.object);
    const double way = way_of(pair, near.cluster);
    if (known != nullptr && way < static_cast<double>(known[near.sample])) {
      pair.spare = std::min(pair.spare, static_cast<double>(known[near.sample]) - way);
      continue;
    }
    ++report.tested;
    const Vector3 place = place_of(pair, near.sample);
    Vector3 normal;
    const double distance = ask(pair, place, normal, report);
    if (known != nullptr) known[near.sample] = until_near(pair, way, distance);
    press_by(near.sample, near.object, near.cluster, place, distance, normal);
  }
  for (const Pair& pair : pairs_) {
    if (pair.present) report.clearance = std::min(report.clearance, pair.spare);
  }
  report.worked = static_cast<std::uint32_t>(near_.size());
  report.level = static_cast<std::uint32_t>(tool_.levels.size()) - 1;
}

}  // namespace spm
