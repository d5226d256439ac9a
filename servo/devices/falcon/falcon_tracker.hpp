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

/// m/s; a report of a faster hand is wrong. People move a tool at 1 m/s at most.
inline constexpr double falcon_fastest_hand = 3;

/// s; how late a report may come after several reports were held up.
inline constexpr double falcon_report_delay = 2e-3;

/// m, from the device's centre along any axis; its workspace ends at about 55 mm.
inline constexpr double falcon_farthest = 0.08;

// Users report that encoders stop counting, unverified here. A hand that holds against half of the
// device's force trembles by more than a count. So if none of the three counts changes for this
// long, they are stuck, or the tool lies at its stop, where the force only heats the motors.
inline constexpr double falcon_frozen_force = 4;  // N
inline constexpr std::chrono::seconds falcon_frozen_time{2};

/// After this time without a report nobody knows with which force the hand was pushed meanwhile.
inline constexpr std::chrono::milliseconds falcon_longest_gap{50};

/// Follows the position through a Falcon's reports, and detects reports that make no sense. No call
/// allocates or throws.
class FalconTracker {
 public:
  explicit FalconTracker(double home_angle) noexcept : home_angle_(home_angle) {}

  /// Forgets the position: the device was opened again.
  void restart() noexcept { followed_ = lost_home_ = false; }

  /// Takes a report that came at a time, now_ns(). The position is valid if the result is `ok`. It
  /// is `not_homed` until all three encoders know where they are, and the position is then followed
  /// from the start. It is `fault` if the position cannot be true, or jumped, or the encoders are
  /// stuck. After a jump of more than lost_home_jump it is `not_homed` until the device has homed
  /// again, or was opened again.
  [[nodiscard]] DeviceHealth follow(const FalconReport& report, std::int64_t came_ns) noexcept;

  /// Sets the force, N, with which the hand was last pushed.
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
  std::int64_t moved_ns_ = 0;  ///< since when the counts have not changed under a large force
  std::int64_t last_ns_ = 0;   ///< of the last report
  double pushed_ = 0;
  bool stuck_ = false;
  bool lost_home_ = false;  ///< an encoder slipped
};

}  // namespace spm::servo
