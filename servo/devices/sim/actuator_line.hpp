// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/base/vector.hpp"
#include "servo/base/random.hpp"

namespace spm::servo {

/// Longest delay that a simulated device may have, ticks.
inline constexpr double longest_delay = 32;

/// What lies between a commanded force and the force that acts.
struct ActuatorSettings {
  double period = 1e-3;    ///< s, of a tick
  double delay_ticks = 0;  ///< 0 to longest_delay
  double jitter = 0;       ///< s, standard deviation of a force's arrival
  double lost_share = 0;   ///< 0 to 1
  double force_cap = 0;    ///< N
  double bandwidth = 0;    ///< Hz, of a first-order lag; 0 or infinite: none
  std::uint64_t seed = 1;
};

/// The path of forces from the loop to the tool: limited to a cap, late, sometimes lost, in order,
/// and through an actuator with a first-order lag. Between arrivals the last force holds.
class ActuatorLine {
 public:
  explicit ActuatorLine(const ActuatorSettings& settings) noexcept;

  /// Resets it: no force is on its way, and none acts.
  void reset() noexcept;

  /// Begins a tick with a commanded force, N.
  void command(const Vector3& force) noexcept;

  /// The mean of the force that acts, N, from one moment of the tick to a later one. Moments are in
  /// ticks since its beginning; the calls must cover each tick once, in order.
  [[nodiscard]] Vector3 mean_force(double from, double to) noexcept;

 private:
  struct Pending {
    double due = 0;  ///< ticks since the beginning of the present tick
    Vector3 force = Vector3::Zero();
  };

  void arrive() noexcept;
  [[nodiscard]] Vector3 drive(double ticks) noexcept;

  ActuatorSettings settings_;
  double lag_;  ///< ticks; 0: none
  Random random_;
  std::array<Pending, 64> pending_;
  std::size_t first_ = 0, count_ = 0;
  double last_due_ = 0;                 ///< ticks, of the force sent last
  Vector3 held_ = Vector3::Zero();      ///< N, the force that arrived last
  Vector3 actuator_ = Vector3::Zero();  ///< N
};

}  // namespace spm::servo
