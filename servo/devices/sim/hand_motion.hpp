// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "servo/devices/sim/hand_model.hpp"

namespace spm::servo {

/// Largest speed of a hand's target, m/s.
inline constexpr double fastest_target = 1.0;

/// Where a hand wants its tool, tick by tick. It depends on the number of ticks alone. The target
/// never jumps.
class HandMotion {
 public:
  HandMotion() = default;

  /// From the first point along the others at a speed (m/s), then back and forth without end
  /// between the last point and points[turn]. At least one point; `turn` is below their number.
  [[nodiscard]] static HandMotion back_and_forth(std::vector<Vector3> points, std::size_t turn,
                                                 double speed, double period);

  /// From a point straight to another at a speed (m/s), where it stays.
  [[nodiscard]] static HandMotion press(const Vector3& from, const Vector3& to, double speed,
                                        double period);

  /// One recorded position a tick, no faster than a target may move; stays at the last. At least
  /// one.
  [[nodiscard]] static HandMotion recorded(std::vector<Vector3> positions, double period);

  [[nodiscard]] const Vector3& start() const noexcept { return points_.front(); }

  /// Approximate number of ticks from the start to the end and back; for a recorded motion the
  /// length of its table.
  [[nodiscard]] std::size_t cycle_ticks() const noexcept;

  /// The target of the next tick.
  [[nodiscard]] HandTarget next() noexcept;

 private:
  enum class Kind { back_and_forth, press, recorded };

  [[nodiscard]] Vector3 travel() noexcept;
  [[nodiscard]] Vector3 follow() noexcept;
  bool turn_around() noexcept;

  Kind kind_ = Kind::press;
  std::vector<Vector3> points_{Vector3::Zero()};
  std::size_t turn_ = 0;
  double step_ = 0;  ///< m a tick
  double period_ = 1e-3;
  std::size_t heading_to_ = 0;
  bool forward_ = true;
  Vector3 position_ = Vector3::Zero();
};

}  // namespace spm::servo
