// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "servo/devices/base/device.hpp"
#include "servo/devices/base/encoder_unwrap.hpp"
#include "servo/devices/wooden/motor_heat.hpp"
#include "servo/devices/wooden/wooden_kinematics.hpp"
#include "servo/devices/wooden/wooden_options.hpp"
#include "servo/devices/wooden/wooden_reports.hpp"

namespace spm::servo {

/// The board counts as silent if its newest report is older than this, ns. It is meant to send one
/// each millisecond; the public hosts restart it after this time.
inline constexpr std::int64_t wooden_silent_ns = 10'000'000;

/// No hand moves the tool faster, m/s: a faster motion is a wrong report, or a board that was
/// reset.
inline constexpr double wooden_fastest = 3;

/// Reports that a late thread collected arrive with less time between them than the motion in them
/// took, s.
inline constexpr double wooden_min_interval = 2e-3;

/// Turns reports into a state, and wrenches into commands: homing, unwrapping, kinematics, and the
/// test for implausible reports. Pure: times are arguments, nothing is sent.
///
/// Homing: counters begin at 0 where the arm stood when its board got power. Force needs either the
/// user's confirmation that this was the home pose (WoodenHome) or, with V2 and V3, the calibration
/// button pressed while the arm is held at home; the counters are then set to 0. A press from
/// before the board was opened is cleared and does not count, since the arm may have moved after
/// it. After a jump of more than lost_home_jump the arm is not homed any more, whatever was
/// confirmed: by the button, or by opening the board again. The counters cannot have wrapped
/// unnoticed: 16 bits cover more than the joints' range.
class WoodenTracker {
 public:
  explicit WoodenTracker(const WoodenOptions& options) noexcept : options_(options) {}

  /// Takes a report that came at a time, ns of any steady clock.
  void take(const WoodenReport& report, std::int64_t came_ns) noexcept;

  /// The device was lost: nothing can be trusted until the next report.
  void lose() noexcept { came_ns_ = 0; }

  /// Whether the newest report can be trusted at a time.
  [[nodiscard]] DeviceHealth health(std::int64_t at_ns) const noexcept;

  /// The state by the newest report; world frame.
  [[nodiscard]] const DeviceState& state() const noexcept { return state_; }

  /// What to send at a time for a wrench, whose torque no motor can give: either currents, which
  /// are zero unless the health is ok, or new counters. False if nothing is to be sent because new
  /// counters are on their way.
  [[nodiscard]] bool command(const Wrench& wrench, std::int64_t at_ns,
                             WoodenCommand& command) noexcept;

  /// How many commands were lowered because a winding was near its limit. Without the motors' data
  /// none is.
  [[nodiscard]] std::uint64_t limited_commands() const noexcept { return limited_commands_; }
  /// The highest estimated temperature of a winding so far, degrees Celsius.
  [[nodiscard]] double hottest() const noexcept;

 private:
  enum class Homing : std::uint8_t {
    wanted,    ///< waits for the calibration button
    clearing,  ///< clears a press from before
    setting,   ///< sets the counters to 0 after a press
    done
  };

  void begin(const WoodenReport& report) noexcept;
  void follow_button(const WoodenReport& report) noexcept;
  void measure(const WoodenReport& report, std::int64_t came_ns) noexcept;
  void forget_counts() noexcept;
  [[nodiscard]] bool decide(const Wrench& wrench, std::int64_t at_ns,
                            WoodenCommand& command) noexcept;
  void warm_up_to(std::int64_t at_ns) noexcept;
  void spare_motors(WoodenCommand& command) noexcept;

  WoodenOptions options_;
  WoodenCalibration calibration_;
  std::array<EncoderUnwrap, 3> unwrap_;
  WoodenReport last_;
  Vector3 angles_ = Vector3::Zero();
  DeviceState state_;
  std::int64_t came_ns_ = 0;
  std::int64_t set_ns_ = 0;  ///< when new counters were last sent
  std::uint32_t connections_ = 0;
  Homing homing_ = Homing::wanted;
  std::array<MotorHeat, 3> heat_;
  std::array<std::int16_t, 3> flowing_{};  ///< mA, by the last command
  std::int64_t warm_ns_ = 0;               ///< up to when heat_ counts
  std::uint64_t limited_commands_ = 0;
  bool position_known_ = false;  ///< whether there is a last position, to detect a jump
  bool plausible_ = true;
  bool set_sent_ = false;
};

}  // namespace spm::servo
