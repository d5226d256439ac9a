// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "servo/devices/sim/hand_model.hpp"
#include "servo/devices/sim/moving_mass.hpp"
#include "servo/devices/sim/sim_profile.hpp"

namespace spm::servo {

enum class HandKind : std::uint8_t {
  slide,     ///< presses and slides on the object
  push,      ///< presses at one place and stays
  recorded,  ///< goes where a file says
  live,      ///< goes where an application leads it
};

/// Options of the simulated device:
/// `sim:profile=NAME,hand=slide|push|path|live,path=FILE,depth=LENGTH,
/// speed=SPEED,seed=N,hand_model=spring|arm,mass=constant|device,delay=TICKS,jitter=TICKS,lost=SHARE,
/// noise=LENGTH,turns=on|off,torque=on|off`.
struct SimOptions {
  const SimProfile* profile = &sim_profiles[0];  ///< one of these
  HandKind hand = HandKind::slide;
  std::string path;     ///< trajectory of a recorded hand, one row for each tick
  double depth = 1e-3;  ///< m, above 0
  double speed = 0.04;  ///< m/s, above 0, at most fastest_target
  std::uint64_t seed = 1;
  HandModel hand_model = HandModel::spring;
  MovingMass mass = MovingMass::constant;
  double delay_ticks = 0;   ///< 0 to longest_delay
  double jitter_ticks = 0;  ///< 0 to longest_delay, standard deviation
  double lost_share = 0;    ///< 0 to 1, fraction of the ticks whose force is lost
  double noise = 0;         ///< m, 0 or more, standard deviation of a reading
  /// Whether it reads its orientation; empty: where the scene's tool is an object.
  std::optional<bool> turns;
  /// Whether it gives torque; empty: where it turns.
  std::optional<bool> torque;
};

/// Parses the text after `sim:`; the empty text gives the defaults. Errors: usage, for an unknown
/// key or word, with the valid ones, a value out of range, and a profile whose kinematics are not
/// known.
[[nodiscard]] Result<SimOptions> parse_sim_options(std::string_view text);

}  // namespace spm::servo
