// SPDX-License-Identifier: Apache-2.0
// Written by scripts/write_borders from what the stability laboratory measured (commit
// 231111bfb63a).
#pragma once

#include <array>
#include <string_view>

#include "common/base/device_profile.hpp"

namespace spm {

/// Largest stiffness that shapes may have before a device begins to shake on them, N/m at its tool.
struct StiffnessBorder {
  std::string_view device;  ///< a profile's name
  double hold;              ///< of the bare proxy on a flat wall that is pressed and held
  double tap;               ///< of the bare proxy on a flat wall that is hit at 0.5 m/s
  double served;            ///< of the default settings, in the worst of all other cases
};

/// Borders at 1 kHz with one tick of delay, from simulation: with the masses, damping and friction
/// that sim_profile.hpp assumes, in a hand of two masses. No device was measured. `served` leaves
/// out the cases of a longer delay, a coarser encoder, noise and a wall that switches. In the order
/// of `device_profiles`.
inline constexpr std::array<StiffnessBorder, device_profiles.size()> stiffness_borders{{
    {"low", 1974, 1660, 1890},
    {"falcon", 6358, 4496, 7561},
    {"touch", 3620, 3781, 3044},
    {"omega3", 4903, 3467, 11661},
    {"wooden", 8426, 6222, 3249},
}};

}  // namespace spm
