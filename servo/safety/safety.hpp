// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/base/hand_pose.hpp"
#include "common/base/vector.hpp"
#include "common/base/wrench.hpp"

namespace spm::servo {

/// Why the force was zero in a tick. The names are part of the contract (`force_off`).
enum class ForceOff : std::uint8_t {
  none,
  starting,            ///< no asset has been handed over yet
  asset_lost,          ///< the asset's bytes were cut short or written over
  not_a_number,        ///< a pose or a wrench that is not finite, or an orientation that is none
  device_fault,        ///< the device answered what makes no sense, or could not be written to
  stopping,            ///< the last tick
  device_silent,       ///< no report came for longer than a report may take
  device_gone,         ///< the device was unplugged
  not_homed,           ///< the device's encoders do not know yet where they are
  jumped,              ///< the hand moved or turned farther since the last tick than any can
  clutched,            ///< an application, or a button of the device, let the hand move freely
  outside_workspace,   ///< the tool is where the device's maker says it cannot be
  application_silent,  ///< an application that moved objects no longer answers
  stalled,             ///< no tick ran for so long that the device was sent zero by others
  unacknowledged,      ///< a fault is over, and nobody has acknowledged it yet
  not_enabled,         ///< the enable switch is not held
  runaway,             ///< the hand sped up against the force, in step with it: the device pushes
                       ///< the wrong way
  unconfirmed,         ///< its user has not confirmed yet which way the device counts and pushes
};

inline constexpr std::size_t force_off_count = 18;

/// The number of ticks without force, for each cause.
using ForceOffTicks = std::array<std::uint64_t, force_off_count>;

[[nodiscard]] const char* to_string(ForceOff cause) noexcept;

/// What to do about a cause: a clause for the end of a sentence.
[[nodiscard]] const char* cure_of(ForceOff cause) noexcept;

/// Limits on the wrench of one device.
struct SafetySettings {
  double force_cap = 0;    ///< N; the magnitude is limited to it, the direction kept
  double slew_limit = 0;   ///< N a tick, limits growth and turning only
  double tick = 1e-3;      ///< s, above 0
  double torque_cap = 0;   ///< N m, as `force_cap`
  double torque_slew = 0;  ///< N m a tick, as `slew_limit`
};

/// A position is not believed if it is outside a device's workspace by more than this fraction of
/// it. Makers state outer figures, and a home position may be slightly off.
inline constexpr double workspace_margin = 0.25;

/// Whether a position in the device's frame, m, is outside its workspace. Half edges are 0 if they
/// are not known.
[[nodiscard]] bool is_outside(const Vector3& position, const Vector3& half_edges) noexcept;

/// Largest difference of an orientation's length from 1.
inline constexpr double orientation_slack = 1e-6;

/// Whether a pose is one: finite, and its orientation of unit length.
[[nodiscard]] bool is_pose(const HandPose& pose) noexcept;

/// Faster than a hand moves a tool: quick reaches peak at about 3 m/s. A position that moved faster
/// is not true; an encoder slipped or a report was lost.
inline constexpr double fastest_motion = 10;  // m/s
/// Faster than a hand turns a tool: a wrist that is flicked peaks at about 25 rad/s.
inline constexpr double fastest_turning = 50;  // rad/s

/// Detects poses that no hand can have reached since the last tick.
class JumpGate {
 public:
  explicit JumpGate(double rate_hz) noexcept
      : max_a_tick_(fastest_motion / rate_hz), max_turn_(fastest_turning / rate_hz) {}

  /// Whether the pose of a tick (its index on the grid) is too far from the last one that was
  /// passed in, in place or in turn. The next pose is compared with this one.
  [[nodiscard]] bool jumped(const HandPose& pose, std::uint64_t tick) noexcept;

  /// Call it when a device was away: its next pose is then accepted as it is.
  void forget() noexcept { is_known_ = false; }

 private:
  double max_a_tick_, max_turn_;  ///< m, rad
  HandPose last_;
  std::uint64_t last_tick_ = 0;
  bool is_known_ = false;
};

/// How far a force may grow in a tick, N, at a stiffness (N/m) and rate (Hz). This is twice what
/// the stiffness gives a hand at 1 m/s, faster than people press. It therefore only limits steps
/// that no motion makes.
[[nodiscard]] double slew_limit(double stiffness, double rate_hz) noexcept;

/// The shortest arm, m, at which forces are taken to turn a hand: that of a pen's tip.
inline constexpr double shortest_arm = 0.01;

/// How far a torque may grow in a tick, N m, where a force may grow by `slew` (N): as far as that
/// force turns the hand at the tool's farthest place, at `arm` (m of the hand) or `shortest_arm`.
[[nodiscard]] double torque_slew_limit(double slew, double arm) noexcept;

/// Limits for a device at a stiffness (N/m) and rate (Hz). Caps in N and N m. The torque's slew
/// limit is that of the shortest arm.
[[nodiscard]] SafetySettings safety_settings(double force_cap, double stiffness, double rate_hz,
                                             double torque_cap = 0) noexcept;

/// A wrench that may be sent.
struct SafeWrench {
  Vector3 force = Vector3::Zero();   ///< N
  Vector3 torque = Vector3::Zero();  ///< N m
  ForceOff cause = ForceOff::none;   ///< why both are zero, if they were set to zero
  bool capped = false;               ///< the force met its cap
  bool slewed = false;               ///< the force met its slew limit
  bool torque_capped = false;        ///< the torque met its cap
  bool torque_slewed = false;        ///< the torque met its slew limit

  [[nodiscard]] Wrench wrench() const noexcept { return {force, torque}; }
};

/// Why a wrench fades to zero although nothing is wrong with the device.
enum class Fade : std::uint8_t {
  none,
  clutch,  ///< somebody takes the clutch: in change_seconds
  silent,  ///< an application that moved objects no longer answers: in silent_fade_seconds
};

/// Slow enough that a hand that leans on a surface can follow it, s.
inline constexpr double silent_fade_seconds = 0.5;

/// The stage between the force law and a device. It holds the state of the soft start and of the
/// slew limits. Force and torque are limited each by itself, because a device has motors of their
/// own for them; soft start, fade and causes hold for both alike.
///
/// Soft start and fade are a share of the wanted wrench that depends on time alone: what is sent is
/// at each moment the gradient of a share of the potential that is felt. A start that lagged behind
/// the hand would give it energy. No call allocates or throws.
class SafetyStage {
 public:
  explicit SafetyStage(const SafetySettings& settings) noexcept
      : settings_(settings), force_cap_(settings.force_cap) {}

  /// The wrench to send, when the force law wants `wanted`, N and N m, `ticks` after the last call.
  /// A cause other than `none` gives zero, and so does a wrench that is not finite. After a tick
  /// without force it comes in change_seconds, and no faster than change_rate.
  ///
  /// `fade`: the wanted wrench fades to zero; of `silent` the cause is then `application_silent`,
  /// of `clutch` it is `clutched`. Afterwards it comes from where it was.
  [[nodiscard]] SafeWrench apply(const Wrench& wanted, ForceOff cause, Fade fade = Fade::none,
                                 std::uint64_t ticks = 1) noexcept;

  /// Whether nothing is sent, as after a fade or a cause.
  [[nodiscard]] bool is_off() const noexcept { return share_ == 0; }

  /// Sets the force cap, N. It goes there from the next tick on, by change_rate.
  void set_force_cap(double cap) noexcept { settings_.force_cap = cap; }
  [[nodiscard]] double force_cap() const noexcept { return force_cap_; }
  [[nodiscard]] double torque_cap() const noexcept { return settings_.torque_cap; }

  /// Sets the slew limits, N and N m a tick, from the next tick on. For a change of the stiffness
  /// that is felt, or of the tool.
  void set_slew_limits(double force, double torque) noexcept {
    settings_.slew_limit = force;
    settings_.torque_slew = torque;
  }

 private:
  void step_share(const Wrench& wanted, Fade fade, std::uint64_t ticks) noexcept;

  SafetySettings settings_;
  double force_cap_;                       ///< N, on its way to that of the settings
  double share_ = 0;                       ///< of what is wanted, 0 to 1
  Vector3 last_force_ = Vector3::Zero();   ///< N, as sent
  Vector3 last_torque_ = Vector3::Zero();  ///< N m, as sent
};

}  // namespace spm::servo
