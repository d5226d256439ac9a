// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/placement.hpp"
#include "common/base/vector.hpp"

namespace spm::servo {

/// How the poses of an application become motion.
struct PoseInterpolatorSettings {
  /// m/s, above 0, of every place of the object: faster than people push; limits the kick of any
  /// pose
  double max_speed = 1.0;
  double max_turn = 10.0;         ///< rad/s, above 0
  double first_period = 1. / 60;  ///< s, until a period was measured, if the application gives none
};

/// An object's pose in a tick, and how it moves, world frame.
struct InterpolatedPose {
  Placement pose;
  Vector3 velocity = Vector3::Zero();          ///< m/s
  Vector3 angular_velocity = Vector3::Zero();  ///< rad/s
  double silent = 0;                           ///< s since the last pose; 0 if there was none
  bool driven = false;                         ///< a pose was given
};

/// Moves one object between the poses that an application sends at its own 60 to 120 Hz. The object
/// moves evenly from where it is to the newest pose, over the measured time between poses and a
/// quarter more. It therefore lags by that quarter; in return it does not stand still, and no step
/// is felt, when a pose comes some ms late. No place of it moves faster than the caps allow; it
/// then arrives later. If no new pose comes it stays at the last one. A pure function of its calls;
/// no call allocates or throws.
class PoseInterpolator {
 public:
  /// Times between poses are measured within these bounds, s. A shorter time is the same frame sent
  /// twice; a longer one is an application that had fallen silent.
  static constexpr double shortest_period = 0.001;
  static constexpr double longest_period = 0.25;
  /// m/s and rad/s: what poses tell to be slower stands still, as people see and feel it.
  static constexpr double still_speed = 0.02, still_turn = 0.2;
  /// How long the motion to a pose takes, as a multiple of the measured period.
  static constexpr double stretch = 1.25;

  PoseInterpolator(const PoseInterpolatorSettings& settings, const Placement& start) noexcept;

  /// Takes the newest pose, finite and with a unit quaternion, at a time of CLOCK_MONOTONIC that
  /// never goes back. `period`, s, is the time between poses according to the application, 0 if it
  /// does not say; it is used until one was measured. The scale stays as it was at the start.
  void give(const Placement& pose, double period, std::int64_t now_ns) noexcept;

  /// Tells how far the object's farthest place is from its origin, m, 0 or more (0 until the first
  /// call). What is under way goes on from where it is, as fast as is allowed now.
  void set_reach(double reach, std::int64_t now_ns) noexcept;

  /// Sets the largest speed, m/s, above 0, from the next pose on.
  void set_max_speed(double speed) noexcept { settings_.max_speed = speed; }

  /// The pose at a time that is not before the time of the last call.
  [[nodiscard]] InterpolatedPose at(std::int64_t now_ns) const noexcept;

  /// Whether several poses came one after the other, as from an application that moves the object.
  [[nodiscard]] bool is_streamed() const noexcept { return measured_; }

  /// Whether the last pose was on a way: it came within longest_period after another one, and went
  /// on from there faster than `still_speed` or `still_turn`. One who stops an object gives its
  /// last pose twice, or slows down.
  [[nodiscard]] bool ended_amid_motion() const noexcept { return goes_on_; }

  /// The estimated time between poses, s.
  [[nodiscard]] double period() const noexcept { return period_; }

 private:
  void measure(double period, std::int64_t now_ns) noexcept;
  [[nodiscard]] bool goes_on_to(const Placement& pose, std::int64_t now_ns) const noexcept;
  void begin_from_here(std::int64_t now_ns) noexcept;
  [[nodiscard]] double least_duration() const noexcept;

  PoseInterpolatorSettings settings_;
  Placement from_, to_;
  Vector3 turn_ = Vector3::Zero();  ///< rad, axis times angle from `from_` to `to_`; world frame
  std::int64_t begun_ns_ = 0;       ///< when the motion from `from_` began
  std::int64_t given_ns_ = 0;       ///< when the last pose was given
  double duration_ = 0;             ///< s, of the motion from `from_` to `to_`
  double reach_ = 0;                ///< m, of the object's farthest place from its origin
  double period_;
  bool driven_ = false, measured_ = false;
  bool goes_on_ = false;  ///< the last pose was on a way
};

}  // namespace spm::servo
