// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "servo/shared/shared_layout.h"

namespace spm::servo {

/// How far applications lowered each device's force cap. The lowest holds; each leaves with its
/// application. Belongs to the loop.
class AppForceCaps {
 public:
  AppForceCaps() noexcept {
    for (auto& of_device : caps_) of_device.fill(none);
  }

  /// An application, by its place (below SPM_MAX_CLIENTS), wants no more than `newtons` of a device
  /// (below SPM_MAX_DEVICES).
  void set(std::uint32_t device, std::uint32_t client, double newtons) noexcept {
    caps_[device][client] = newtons;
  }
  /// The application at that place is gone.
  void leave(std::uint32_t client) noexcept {
    for (auto& of_device : caps_) of_device[client] = none;
  }
  /// N; infinity if no application lowered it.
  [[nodiscard]] double of(std::uint32_t device) const noexcept {
    if (device >= caps_.size()) return none;
    return *std::min_element(caps_[device].begin(), caps_[device].end());
  }

 private:
  static constexpr double none = std::numeric_limits<double>::infinity();
  std::array<std::array<double, SPM_MAX_CLIENTS>, SPM_MAX_DEVICES> caps_;
};

}  // namespace spm::servo
