// SPDX-License-Identifier: Apache-2.0
// Where finer levels would hardly change what presses, and need not be looked at.
#include <algorithm>
#include <cmath>

#include "common/sixdof/object_contact.hpp"

namespace spm {

namespace {

// Chosen with the numbers of object_quadrature.cpp.

/// A sum over fewer contacts says nothing of its own error; from twice as many on it is believed.
constexpr double few_contacts = 16;
/// From so many contacts on a sum begins to be good enough whatever it changed by, from twice as
/// many on it is: what is left of forces that cancel out is a small part of them.
constexpr double many_contacts = 256;
/// Of the sum of all sizes of forces, what is left of them where they cancel out.
constexpr double least_left = 0.05;
/// From so many contacts on, clusters in which nothing presses begin to be looked at no finer; from
/// twice as many on they are not.
constexpr double silent_contacts = 4;

}  // namespace

/// What an object's sum tells of its own error, by how it differs from that of the level above.
ObjectContact::Settling ObjectContact::settling_of(const Pair& pair, std::uint32_t level,
                                                   double accuracy) const noexcept {
  const LevelSum &sum = pair.level_sum, &before = pair.sum_before;
  Settling made;
  if (level <= summed_level_ || !(sum.pressing > 0)) return made;
  made.per_force = 1 / std::max(sum.force.norm(), least_left * sum.pressing);
  made.per_torque = 1 / std::max(sum.torque.norm(), least_left * sum.pressing * tool_.radius);
  const double change = std::max((sum.force - before.force).norm() * made.per_force,
                                 (sum.torque - before.torque).norm() * made.per_torque);
  const double many = 2 - sum.contacts / many_contacts;
  made.few = std::clamp(2 - sum.contacts / few_contacts, 0.0, 1.0);
  made.silent = std::clamp(2 - sum.contacts / silent_contacts, 0.0, 1.0);
  made.most = std::clamp(std::min(change / accuracy - 1, many), 0.0, 1.0);
  return made;
}

/// How much of a cluster finer levels are to tell: 1 all, 0 nothing. In between the forces of both
/// count, so that they do not jump where levels change. Null: nothing presses in it.
float ObjectContact::left_to_refine(const Settling& settling, const ClusterChange* change,
                                    double accuracy) noexcept {
  if (change == nullptr) return static_cast<float>(settling.silent);
  // Each of as many clusters as there are in effect may be off by the same part of the accuracy.
  const double alike = settling.changes / std::sqrt(settling.squares);
  const double own = settling.squares > 0 ? settling.change(*change) * alike / accuracy - 1 : 0;
  return static_cast<float>(std::max(settling.few, std::min(own, settling.most)));
}

/// Settles what need not be refined. False where nothing is left.
bool ObjectContact::settle_level(std::uint32_t level, double accuracy) noexcept {
  clusters_.end_level();
  for (Pair& pair : pairs_) {
    if (!pair.present) continue;
    pair.settling = settling_of(pair, level, accuracy);
    pair.sum_before = pair.level_sum;
    pair.level_sum = {};
  }
  if (level <= summed_level_) return !active_.empty();
  for (const ClusterChange& each : clusters_.changes()) {
    Settling& settling = pairs_[each.key >> 16U].settling;
    const double change = settling.change(each);
    settling.changes += change;
    settling.squares += change * change;
  }
  std::size_t kept = 0;
  auto at = clusters_.changes().begin();
  const auto end = clusters_.changes().end();
  std::uint32_t key = ~0U;
  float left = 1;
  for (Active& active : active_) {
    Pair& pair = pairs_[active.object];
    if (key_of(active) != key) {
      key = key_of(active);
      while (at != end && at->key < key) ++at;
      const bool presses = at != end && at->key == key;
      left = left_to_refine(pair.settling, presses ? &*at : nullptr, accuracy);
      if (left < 1) pair.spare = 0;
    }
    const float before = active.weight;
    if (left < 1) press(active, before * (1 - left));
    if (!(left > 0)) continue;
    active.weight = before * left;
    if (&active != &active_[kept]) active_[kept] = active;
    ++kept;
  }
  active_.resize(kept);
  return kept > 0;
}

}  // namespace spm
