// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "common/base/device_profile.hpp"

namespace spm {

/// How a velocity is estimated from positions.
enum class VelocityMethod : std::uint8_t {
  estimate,    ///< the longest straight window
  difference,  ///< the last two positions only: noise of one encoder step per tick
};

/// Longest delay that the settings allow, ticks.
inline constexpr double max_delay_ticks = 8;

/// Stabilization: it keeps a force stable in a sampled loop with a hand in it. Each part is off
/// until it is set, and then costs one comparison. Lengths, stiffness and damping are in the hand's
/// frame.
struct StabilizationSettings {
  /// Share of K (1/2 + d + lag/T) T that is applied as damping in contact along the force; see
  /// matched_damping. 0 to 2, 0 is off.
  double damping_share = 0;
  /// d: ticks between a reading and the force that answers it, 0 to max_delay_ticks. At 0 the
  /// force is only held for the tick.
  double delay_ticks = 1;
  /// s, first-order lag of the device's actuator; counts as delay. 0 or more.
  double lag = 0;
  double coupling = 0;          ///< N/m of a virtual coupling, see VirtualCoupling; 0 is off
  double coupling_damping = 0;  ///< N s/m of a damper parallel to it, 0 or more
  bool passivity = false;       ///< observer and controller, see PassivityControl
  /// m, spacing of a lattice; 0 is off. The force of `spm` becomes minus the gradient of one
  /// potential, made of distances interpolated between the lattice's corners (PotentialLattice),
  /// and the turns of its direction are not limited.
  double potential = 0;
  /// The velocity that both dampings, and that of eq. 18, use.
  VelocityMethod velocity = VelocityMethod::estimate;
  double device_mass = 0.1;  ///< kg at the tool, above 0: limits all damping

  /// Whether any stabilization is on.
  [[nodiscard]] bool any() const noexcept { return acts_on_sum() || coupling > 0 || potential > 0; }
  /// Whether any stabilization that acts on the sum of the objects' forces is on.
  [[nodiscard]] bool acts_on_sum() const noexcept { return damping_share > 0 || passivity; }
  /// Mean delay until a force acts, ticks; `tick` in s.
  [[nodiscard]] double total_delay(double tick) const noexcept { return delay_ticks + lag / tick; }
  [[nodiscard]] bool operator==(const StabilizationSettings&) const noexcept = default;
};

/// The recommended share of matched damping: all the energy that sampling gives back. It raises the
/// stable stiffness of a flat wall and costs no static stiffness.
inline constexpr double recommended_damping_share = 1;
/// Spacing of the lattice that the word `potential` stands for, m.
inline constexpr double recommended_potential = 5e-5;
/// The coupling that the word `coupling` stands for, N/m: as stiff as a flat wall may be on the
/// worst device (stable_stiffness.hpp).
inline constexpr double recommended_coupling = 2000;

/// The combination that is recommended where nothing else is known.
inline constexpr StabilizationSettings recommended_stabilization{
    .damping_share = recommended_damping_share, .passivity = true};

/// The settings `stabilization` in the loop of `loop`: with its delay, lag and mass, which do not
/// depend on the chosen stabilization.
[[nodiscard]] constexpr StabilizationSettings in_loop_of(
    const StabilizationSettings& loop, StabilizationSettings stabilization) noexcept {
  stabilization.delay_ticks = loop.delay_ticks;
  stabilization.lag = loop.lag;
  stabilization.device_mass = loop.device_mass;
  return stabilization;
}

/// The same with the lag and mass of a device.
[[nodiscard]] constexpr StabilizationSettings in_loop_of(
    const DeviceProfile& device, StabilizationSettings stabilization) noexcept {
  stabilization.lag = device.actuator_lag();
  stabilization.device_mass = device.moving_mass;
  return stabilization;
}

/// Switches on the named parts of the stabilization, joined by "+": `damping`, `coupling`,
/// `passivity`, `velocity` (the estimate, which is the default anyway), `difference` (a plain
/// difference, for comparison) and `potential`, each at its recommended value. `default` stands for
/// the recommended combination, and clears the others. Settings without a word are left as they
/// are. Where a word is unknown: returns false and sets nothing.
[[nodiscard]] bool parse_stabilization(std::string_view words,
                                       StabilizationSettings& stabilization) noexcept;

}  // namespace spm
