// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/error.hpp"
#include "servo/devices/sim/sim_profile.hpp"

namespace spm::servo {

enum class HandKind : std::uint8_t {
  slide,     ///< presses and slides on the object
  push,      ///< presses at one place and stays
  recorded,  ///< goes where a file says
};

/// Options of the simulated device: `sim:profile=NAME,hand=slide|push|path,path=FILE,depth=LENGTH,
/// speed=SPEED,seed=N`.
struct SimOptions {
  const SimProfile* profile = &sim_profiles[0];  ///< one of these
  HandKind hand = HandKind::slide;
  std::string path;     ///< trajectory of a recorded hand, one row a tick
  double depth = 1e-3;  ///< m, above 0
  double speed = 0.04;  ///< m/s, above 0, at most fastest_target
  std::uint64_t seed = 1;
};

/// Parses what follows `sim:`; the empty text gives the defaults. Errors: usage, an unknown key or
/// word with the valid ones, a value out of range.
[[nodiscard]] Result<SimOptions> parse_sim_options(std::string_view text);

}  // namespace spm::servo
