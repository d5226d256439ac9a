// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/placement.hpp"
#include "common/base/vector.hpp"

namespace spm::servo {

/// How poses of an application become motion.
struct PoseInterpolatorSettings {
  double most_speed = 1.0;        ///< m/s, above 0: faster than people push, so that no pose kicks
  double most_turn = 10.0;        ///< rad/s, above 0
  double first_period = 1. / 60;  ///< s, until a period was measured and where none is hinted
};

/// An object's pose in a tick, and how it moves, world frame.
struct InterpolatedPose {
  Placement pose;
  Vector3 velocity = Vector3::Zero();          ///< m/s
  Vector3 angular_velocity = Vector3::Zero();  ///< rad/s
  double silent = 0;    ///< s since the last pose was given; 0 where none ever was
  bool driven = false;  ///< a pose was given
};

/// Moves one object between the poses that an application gives at its own 60 to 120 Hz: from where
/// it is to the newest pose, evenly, over a quarter more than the measured time between poses. So
/// it lags by that quarter, and hence does not stand still, and is not felt to step, where a pose
/// comes some ms late. Faster than the caps allow it does not move; it then arrives later. Where no
/// new pose comes it stays at the last. A pure function of its calls; nothing in it allocates or
/// throws.
class PoseInterpolator {
 public:
  /// Times between poses are measured within these bounds, s: what is shorter is the same frame
  /// told twice, what is longer is an application that had fallen silent.
  static constexpr double shortest_period = 0.001;
  static constexpr double longest_period = 0.25;
  /// Of the measured period: how long the way to a pose takes.
  static constexpr double stretch = 1.25;

  PoseInterpolator(const PoseInterpolatorSettings& settings, const Placement& start) noexcept;

  /// Takes the newest pose, finite and with a unit quaternion, at a time of CLOCK_MONOTONIC that
  /// never goes back. `period` in s is what the application says of the time between its poses, 0
  /// where it does not; it stands until one was measured. The scale stays as it was at the start.
  void give(const Placement& pose, double period, std::int64_t now_ns) noexcept;

  /// The pose at a time, not before that of the last call.
  [[nodiscard]] InterpolatedPose at(std::int64_t now_ns) const noexcept;

  /// Whether poses came one after the other, as from an application that moves the object.
  [[nodiscard]] bool is_streamed() const noexcept { return measured_; }

  /// The time between poses as it is known, s.
  [[nodiscard]] double period() const noexcept { return period_; }

 private:
  void measure(double period, std::int64_t now_ns) noexcept;

  PoseInterpolatorSettings settings_;
  Placement from_, to_;
  Vector3 turn_ = Vector3::Zero();  ///< rad, axis times angle from `from_` to `to_`; world frame
  std::int64_t begun_ns_ = 0;       ///< when it set out from `from_`
  std::int64_t given_ns_ = 0;       ///< when the last pose was given
  double duration_ = 0;             ///< s, of the way from `from_` to `to_`
  double period_;
  bool driven_ = false, measured_ = false;
};

}  // namespace spm::servo
