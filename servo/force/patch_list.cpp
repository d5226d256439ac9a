// SPDX-License-Identifier: Apache-2.0
#include "servo/force/patch_list.hpp"

#include <algorithm>

namespace spm {

namespace {

/// The cosine of the angle within which two clusters face the same way: 25 degrees.
constexpr double same_way = 0.9;

}  // namespace

void PatchList::add(const PressedPatch& pressed, const Eigen::Isometry3d& pose,
                    const Eigen::Isometry3d& device, double share) noexcept {
  if (!(pressed.pressing > 0) || !(share > 0)) return;
  Entry made;
  made.pressing = share * pressed.pressing;
  ContactPatch& patch = made.patch;
  patch.object = pressed.object;
  patch.force = share * pressed.force;
  patch.normal = pressed.pressure.normalized();
  const Vector3 arm = pressed.moment / pressed.pressing;
  patch.place = pose.translation() + arm;
  // How deep the place would be if the tool were where the hand wants it.
  const Vector3 wanted = device * (pose.linear().transpose() * arm);
  patch.depth = std::max(pressed.depth, pressed.depth + patch.normal.dot(patch.place - wanted));
  for (Entry& entry : std::span(entries_).first(count_)) {
    ContactPatch& other = entry.patch;
    if (other.object != patch.object || other.normal.dot(patch.normal) < same_way ||
        (other.place - patch.place).norm() > near_) {
      continue;
    }
    const double whole = entry.pressing + made.pressing;
    other.place = (entry.pressing * other.place + made.pressing * patch.place) / whole;
    other.normal = (entry.pressing * other.normal + made.pressing * patch.normal).normalized();
    other.force += patch.force;
    other.depth = std::max(other.depth, patch.depth);
    entry.pressing = whole;
    return;
  }
  put(made);
}

void PatchList::add(const ContactPatch& patch) noexcept { put({patch, patch.force.norm()}); }

/// Puts an entry at the end, or in the place of the weakest.
void PatchList::put(const Entry& made) noexcept {
  if (count_ < room) {
    entries_[count_++] = made;
    return;
  }
  Entry& weakest =
      *std::min_element(entries_.begin(), entries_.end(),
                        [](const Entry& a, const Entry& b) { return a.pressing < b.pressing; });
  if (weakest.pressing < made.pressing) weakest = made;
}

void PatchList::write(ToolTick& tick) const noexcept {
  std::array<std::size_t, room> order{};
  for (std::size_t i = 0; i < count_; ++i) order[i] = i;
  // By number where two press alike, so that the order is always the same.
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count_),
            [this](std::size_t a, std::size_t b) {
              const double first = entries_[a].pressing, second = entries_[b].pressing;
              return first != second ? first > second : a < b;
            });
  tick.patch_count = std::min(count_, max_patches);
  for (std::size_t i = 0; i < tick.patch_count; ++i) tick.patches[i] = entries_[order[i]].patch;
}

double PatchList::pressing() const noexcept {
  double sum = 0;
  for (const Entry& entry : std::span(entries_).first(count_)) sum += entry.pressing;
  return sum;
}

}  // namespace spm
