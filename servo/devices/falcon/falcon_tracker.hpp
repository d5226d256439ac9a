// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include "common/base/vector.hpp"
#include "servo/devices/base/device.hpp"
#include "servo/devices/falcon/falcon_kinematics.hpp"
#include "servo/devices/falcon/falcon_packet.hpp"

namespace spm::servo {

/// m/s; a report that tells of a faster hand is wrong. People move a tool at 1 m/s at most.
inline constexpr double falcon_fastest_hand = 3;

/// s; how much later than it was true a report may come, of several that were held up.
inline constexpr double falcon_report_delay = 2e-3;

/// m, from the device's centre along any axis; its workspace ends at 55 mm or so.
inline constexpr double falcon_farthest = 0.08;

// Users tell of encoders that stop counting, unverified here. A hand that holds against half of
// what the device can give trembles by more than a count: where none of three counts changes for so
// long, they are stuck, or the tool lies at its stop, where the force only heats the motors.
inline constexpr double falcon_frozen_force = 4;  // N
inline constexpr std::chrono::seconds falcon_frozen_time{2};

/// After so long without a report nobody knows what the hand was pushed with meanwhile.
inline constexpr std::chrono::milliseconds falcon_longest_gap{50};

/// Follows the position through a Falcon's reports, and says when they make no sense. Nothing of it
/// allocates or throws.
class FalconTracker {
 public:
  explicit FalconTracker(double home_angle) noexcept : home_angle_(home_angle) {}

  /// Forgets the position: the device was opened again.
  void restart() noexcept { followed_ = false; }

  /// Takes a report that came at a time, now_ns(). The position is valid when it says `ok`;
  /// `not_homed` until all three encoders know where they are, which begins afresh; `fault` where
  /// the position cannot be, or jumped, or the encoders are stuck.
  [[nodiscard]] DeviceHealth follow(const FalconReport& report, std::int64_t came_ns) noexcept;

  /// What the hand was last pushed with, N.
  void pushed(double force) noexcept { pushed_ = force; }

  [[nodiscard]] const Vector3& position() const noexcept { return position_; }  ///< m
  [[nodiscard]] const Vector3& angles() const noexcept { return angles_; }      ///< rad, thighs

 private:
  [[nodiscard]] bool frozen(const FalconReport& report, std::int64_t came_ns) noexcept;

  double home_angle_;
  bool followed_ = false;  ///< whether there is a last position
  Vector3 position_ = Vector3::Zero(), angles_ = Vector3::Zero();
  std::int64_t position_ns_ = 0;
  std::array<std::int16_t, 3> counts_{};
  std::int64_t moved_ns_ = 0;  ///< since when the counts are the same under a large force
  std::int64_t last_ns_ = 0;   ///< of the last report
  double pushed_ = 0;
  bool stuck_ = false;
};

}  // namespace spm::servo
