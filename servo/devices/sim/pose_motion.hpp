// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "common/base/hand_pose.hpp"
#include "servo/devices/sim/sixdof_plant.hpp"

namespace spm::servo {

/// Largest speed of a hand's target, m/s.
inline constexpr double fastest_target = 1.0;

/// Largest rate at which a hand's target turns, rad/s.
inline constexpr double fastest_turn = 20;

/// How fast a hand's target moves, m/s, and turns, rad/s; a way between two poses takes as long as
/// the slower of both.
struct PoseSpeed {
  double moving = 0.04;
  double turning = 1;
};

/// A pose of a hand that does not turn.
[[nodiscard]] inline HandPose unturned(const Vector3& position) noexcept {
  return {position, Eigen::Quaterniond::Identity()};
}

/// Where a hand wants its tool, tick by tick. It depends on the number of ticks alone. The target
/// never jumps. A hand that does not turn has poses that all are of no turn (`unturned`).
class PoseMotion {
 public:
  PoseMotion() = default;

  /// From the first pose along the others, then back and forth without end between the last pose
  /// and poses[turn]. At least one pose; `turn` is below their number.
  [[nodiscard]] static PoseMotion back_and_forth(std::vector<HandPose> poses, std::size_t turn,
                                                 const PoseSpeed& speed, double period);

  /// From a pose along the others, where it stays.
  [[nodiscard]] static PoseMotion press(std::vector<HandPose> poses, const PoseSpeed& speed,
                                        double period);

  /// One recorded pose a tick, no faster than a target may move and turn; stays at the last. At
  /// least one.
  [[nodiscard]] static PoseMotion recorded(std::vector<HandPose> poses, double period);

  [[nodiscard]] const HandPose& start() const noexcept { return poses_.front(); }

  /// Approximate number of ticks from the start to the end and back; for a recorded motion the
  /// length of its table.
  [[nodiscard]] std::size_t cycle_ticks() const noexcept;

  /// The target of the next tick.
  [[nodiscard]] SixdofTarget next() noexcept;

 private:
  enum class Kind { back_and_forth, press, recorded };

  [[nodiscard]] static PoseMotion along(Kind kind, std::vector<HandPose> poses, std::size_t turn,
                                        const PoseSpeed& speed, double period);
  [[nodiscard]] double ticks_between(const HandPose& from, const HandPose& to) const noexcept;
  [[nodiscard]] HandPose travel() noexcept;
  bool turn_around() noexcept;

  Kind kind_ = Kind::press;
  std::vector<HandPose> poses_{HandPose{}};
  std::size_t turn_ = 0;
  PoseSpeed step_;  ///< a tick
  double period_ = 1e-3;
  std::size_t heading_to_ = 0;
  bool forward_ = true;
  HandPose pose_;
};

}  // namespace spm::servo
