// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace spm::servo {

/// What a motor's data sheet says about heat. All motors of a device are alike.
struct MotorData {
  double resistance = 0;          ///< ohm, between the terminals at 25 degrees Celsius; 0: no data
  double thermal_resistance = 0;  ///< K/W, from the winding to the air
  double time_constant = 0;       ///< s, of the winding
  double winding_limit = 0;       ///< degrees Celsius
  double ambient = 25;            ///< degrees Celsius
  std::string source;             ///< where these stand, for the report

  [[nodiscard]] bool known() const noexcept { return resistance > 0; }
};

/// The estimated temperature of one winding, of first order: heated by I^2 R, whose R grows with
/// the temperature as copper's does, and cooled to the air. It begins as warm as the air. With the
/// winding's own time constant and the whole thermal resistance it errs to the warm side.
class MotorHeat {
 public:
  /// A current, A, flowed for `seconds`. No effect without data.
  void add(const MotorData& motor, double current, double seconds) noexcept {
    if (!motor.known()) return;
    const double now = temperature(motor);
    const double resistance = motor.resistance * (1 + copper * (now - 25));
    const double aim = motor.thermal_resistance * resistance * current * current;
    rise_ += (aim - rise_) * -std::expm1(-seconds / motor.time_constant);
    hottest_ = std::max(hottest_, rise_);
  }

  /// The part of a current that may flow, 0 to 1: less and less over the last fifth of the rise to
  /// the limit, and nothing at the limit. 1 without data.
  [[nodiscard]] double share(const MotorData& motor) const noexcept {
    if (!motor.known()) return 1;
    const double most = motor.winding_limit - motor.ambient;
    return std::clamp((most - rise_) / (soft * most), 0.0, 1.0);
  }

  /// Degrees Celsius: now, and the highest so far.
  [[nodiscard]] double temperature(const MotorData& motor) const noexcept {
    return motor.ambient + rise_;
  }
  [[nodiscard]] double hottest(const MotorData& motor) const noexcept {
    return motor.ambient + hottest_;
  }

 private:
  static constexpr double copper = 0.00393;  // 1/K, of its resistance at 25 degrees Celsius
  static constexpr double soft = 0.2;

  double rise_ = 0;  ///< K above the air
  double hottest_ = 0;
};

}  // namespace spm::servo
