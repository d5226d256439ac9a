// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "common/base/device_profile.hpp"

namespace spm {

/// How a velocity is estimated from positions.
enum class VelocityBy : std::uint8_t {
  estimate,    ///< the longest straight window
  difference,  ///< the last two positions only: noise of one encoder step per tick
};

/// Longest delay that the settings allow, ticks.
inline constexpr double most_delay_ticks = 8;

/// Stabilization: it keeps a force stable in a sampled loop with a hand in it. Each part is off
/// until it is set, and then costs one comparison. Lengths, stiffness and damping are in the hand's
/// frame.
struct CureSettings {
  /// Share of K (1/2 + d + lag/T) T that is applied as damping in contact along the force; see
  /// matched_damping. 0 to 2, 0 is off.
  double damping_share = 0;
  /// d: ticks between a reading and the force that answers it, 0 to most_delay_ticks. At 0 the
  /// force is only held for the tick.
  double delay_ticks = 1;
  /// s, first-order lag of the device's actuator; counts as delay. 0 or more.
  double lag = 0;
  double coupling = 0;          ///< N/m of a virtual coupling, see CouplingPoint; 0 is off
  double coupling_damping = 0;  ///< N s/m of a damper parallel to it, 0 or more
  bool passivity = false;       ///< observer and controller, see PassivityControl
  /// m, spacing of a lattice; 0 is off. The force of `spm` becomes minus the gradient of one
  /// potential, made of distances interpolated between the lattice's corners (PotentialLattice),
  /// and the turns of its direction are not limited.
  double potential = 0;
  /// The velocity that both dampings, and that of eq. 18, use.
  VelocityBy velocity = VelocityBy::estimate;
  double device_mass = 0.1;  ///< kg at the tool, above 0: limits all damping

  /// Whether any stabilization is on.
  [[nodiscard]] bool any() const noexcept { return acts_on_sum() || coupling > 0 || potential > 0; }
  /// Whether any stabilization that acts on the sum of the objects' forces is on.
  [[nodiscard]] bool acts_on_sum() const noexcept { return damping_share > 0 || passivity; }
  /// Mean delay until a force acts, ticks; `tick` in s.
  [[nodiscard]] double whole_delay(double tick) const noexcept { return delay_ticks + lag / tick; }
  [[nodiscard]] bool operator==(const CureSettings&) const noexcept = default;
};

/// The advised share of matched damping: all the energy that sampling gives back. It raises the
/// stable stiffness of a flat wall and costs no static stiffness.
inline constexpr double advised_damping_share = 1;
/// Spacing of the lattice that the word `potential` stands for, m.
inline constexpr double advised_potential = 5e-5;
/// The coupling that the word `coupling` stands for, N/m: as stiff as a flat wall may be on the
/// worst device (stable_stiffness.hpp).
inline constexpr double advised_coupling = 2000;

/// The combination that is advised where nothing else is known.
inline constexpr CureSettings advised_cures{.damping_share = advised_damping_share,
                                            .passivity = true};

/// The settings `cures` in the loop of `loop`: with its delay, lag and mass, which do not
/// depend on the chosen stabilization.
[[nodiscard]] constexpr CureSettings in_loop_of(const CureSettings& loop,
                                                CureSettings cures) noexcept {
  cures.delay_ticks = loop.delay_ticks;
  cures.lag = loop.lag;
  cures.device_mass = loop.device_mass;
  return cures;
}

/// The same with the lag and mass of a device.
[[nodiscard]] constexpr CureSettings in_loop_of(const DeviceProfile& device,
                                                CureSettings cures) noexcept {
  cures.lag = device.actuator_lag();
  cures.device_mass = device.moving_mass;
  return cures;
}

/// Switches on the named parts of the stabilization, joined by "+": `damping`, `coupling`,
/// `passivity`, `velocity` (the estimate, which is the default anyway), `difference` (a plain
/// difference, for comparison) and `potential`, each at its advised value. `default` stands for the
/// advised combination, and clears the others. Settings without a word are left as they are. Where
/// a word is unknown: returns false and sets nothing.
[[nodiscard]] bool parse_cures(std::string_view words, CureSettings& cures) noexcept;

}  // namespace spm
