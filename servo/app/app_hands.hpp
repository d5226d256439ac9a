// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "common/base/hand_pose.hpp"
#include "servo/shared/app_command.hpp"
#include "servo/shared/shared_layout.h"

namespace spm::servo {

/// Which application leads the hand of each simulated device, and where to. A hand belongs to the
/// first that leads it, until it lets go, falls silent or leaves. Belongs to the loop.
class AppHands {
 public:
  /// Before the loop runs: whether applications may lead a device's hand.
  void know_device(std::uint32_t device, bool led) noexcept {
    if (device < hands_.size()) hands_[device].may_be_led = led;
  }
  /// Follows a command. Not even a supervisor takes a hand from another application: two would pull
  /// at it.
  [[nodiscard]] Refusal lead(const AppCommand& command, std::int64_t now_ns) noexcept {
    Hand& hand = hands_[command.index];
    if (!hand.may_be_led) return Refusal::not_led;
    const bool held = now_ns < hand.until_ns && hand.connection != command.connection;
    if (held) return Refusal::hand_held;
    if (command.on) {
      hand.connection = command.connection;
      hand.until_ns = now_ns + static_cast<std::int64_t>(command.hold * 1e9);
      hand.pose = {command.pose.position, command.pose.rotation};
    } else {
      hand.until_ns = 0;
    }
    return Refusal::none;
  }
  /// An application is gone.
  void leave(std::uint32_t connection) noexcept {
    for (Hand& hand : hands_) {
      if (hand.connection == connection) hand.until_ns = 0;
    }
  }
  /// Where a device's hand is led to, world frame; null while nobody leads it.
  [[nodiscard]] const HandPose* of(std::uint32_t device, std::int64_t now_ns) const noexcept {
    const bool led = device < hands_.size() && now_ns < hands_[device].until_ns;
    return led ? &hands_[device].pose : nullptr;
  }

 private:
  struct Hand {
    bool may_be_led = false;
    std::uint32_t connection = 0;  ///< of who led it last
    std::int64_t until_ns = 0;     ///< of CLOCK_MONOTONIC; in the past: nobody leads it
    HandPose pose;
  };
  std::array<Hand, SPM_MAX_DEVICES> hands_{};
};

}  // namespace spm::servo
