// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "common/base/device_profile.hpp"

namespace spm {

/// How a velocity is told from positions.
enum class VelocityBy : std::uint8_t {
  estimate,    ///< the longest straight window
  difference,  ///< the last two positions alone: noise of one encoder step a tick
};

/// Longest delay that is reckoned with, ticks.
inline constexpr double most_delay_ticks = 8;

/// What keeps a force stable in a sampled loop with a hand in it; each is off until it is set, and
/// then costs a comparison. Lengths, stiffness and damping are the hand's.
struct CureSettings {
  /// Of K (1/2 + d + lag/T) T: braking in contact along the force, see matched_damping; 0 to 2, 0
  /// is off.
  double damping_share = 0;
  /// d: ticks between a reading and the force that answers it, 0 to most_delay_ticks; 0 holds the
  /// force for the tick alone.
  double delay_ticks = 1;
  /// s, of the device's actuator, first order: counts as delay. 0 or more.
  double lag = 0;
  double coupling = 0;          ///< N/m of a virtual coupling, see CouplingPoint; 0 is off
  double coupling_damping = 0;  ///< N s/m beside it, 0 or more
  bool passivity = false;       ///< observer and controller, see PassivityControl
  /// m: the force of `spm` is minus the gradient of one potential, of distances interpolated
  /// between the corners of a lattice so far apart (PotentialLattice), and its turns are not
  /// limited; 0 is off.
  double potential = 0;
  /// What the two dampings, and eq. 18's, take for the hand's velocity.
  VelocityBy velocity = VelocityBy::estimate;
  double device_mass = 0.1;  ///< kg at the tool, above 0: bounds all damping

  /// Whether there is a cure at all.
  [[nodiscard]] bool any() const noexcept { return acts_on_sum() || coupling > 0 || potential > 0; }
  /// Whether there is one that acts on the sum of the objects' forces.
  [[nodiscard]] bool acts_on_sum() const noexcept { return damping_share > 0 || passivity; }
  /// Ticks after which a force acts in the mean; `tick` in s.
  [[nodiscard]] double whole_delay(double tick) const noexcept { return delay_ticks + lag / tick; }
  [[nodiscard]] bool operator==(const CureSettings&) const noexcept = default;
};

/// The share of matched damping that is advised, all that the sampling gives back: raises the
/// border of a flat wall and costs no static stiffness.
inline constexpr double advised_damping_share = 1;
/// The lattice that the word `potential` stands for, m.
inline constexpr double advised_potential = 5e-5;
/// The coupling that the word `coupling` stands for, N/m: as stiff as a flat wall may be on the
/// worst device (stable_stiffness.hpp).
inline constexpr double advised_coupling = 2000;

/// The combination that is advised where nothing else is known.
inline constexpr CureSettings advised_cures{.damping_share = advised_damping_share,
                                            .passivity = true};

/// Cures in the loop of other ones: its delay, lag and mass, which no choice of cures changes.
[[nodiscard]] constexpr CureSettings in_loop_of(const CureSettings& loop,
                                                CureSettings cures) noexcept {
  cures.delay_ticks = loop.delay_ticks;
  cures.lag = loop.lag;
  cures.device_mass = loop.device_mass;
  return cures;
}

/// The same with what is known of a device.
[[nodiscard]] constexpr CureSettings in_loop_of(const DeviceProfile& device,
                                                CureSettings cures) noexcept {
  cures.lag = device.actuator_lag();
  cures.device_mass = device.moving_mass;
  return cures;
}

/// Sets the cures that are named, joined by "+": `damping`, `coupling`, `passivity`, `velocity`
/// (the estimate, as it is anyway) or `difference` (a plain one, for comparison), `potential`, each
/// as it is advised; `default` is the combination that is, and clears the others. What has no word
/// is left as it is. False, and nothing set, where a word is not known.
[[nodiscard]] bool parse_cures(std::string_view words, CureSettings& cures) noexcept;

}  // namespace spm
