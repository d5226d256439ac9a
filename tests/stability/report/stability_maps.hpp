// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/stability/laboratory/contenders.hpp"

namespace spm::stability {

/// The grid of a stability map: a pressed flat wall over stiffness and added damping, for each
/// delay.
struct MapPlan {
  int stiffnesses = 20;                                    ///< evenly on a logarithmic scale
  double min_stiffness = 250;                              ///< N/m
  double max_stiffness = 32e3;                             ///< N/m
  std::vector<double> dampings{0, 0.5, 1, 2, 3, 4, 5, 6};  ///< N s/m
  std::vector<double> delays{0, 1, 2, 4};                  ///< ticks
  double rest = 1.2;                                       ///< s, that the hand holds
  /// Which contenders a report maps, by name.
  std::vector<std::string> methods{"exact-penalty", "distance-field", "mesh-proxy",
                                   "spm",           "proxy",          "default"};
};

/// The stability map of one method on one device.
struct StabilityMap {
  std::string method, device;
  std::vector<double> stiffnesses, dampings, delays;
  /// Whether the wall is held well: [delay][damping][stiffness], the last index runs fastest.
  std::vector<std::uint8_t> stable;
  /// Stiffness, N/m, at which the spectral radius of the sampled loop is 1: [delay][damping];
  /// infinite where it never is.
  std::vector<double> theory;
};

/// The border of a profile against the catalogue's flat wall by the exact eigenvalue, N/m. It
/// covers only what is linear: the device's Coulomb friction and encoders are left out.
[[nodiscard]] double flat_theory(const servo::SimProfile& profile);

/// A map of one contender on one profile, all cells in parallel.
[[nodiscard]] StabilityMap measure_map(const MapPlan& plan, const Contender& contender,
                                       const servo::SimProfile& profile, std::uint64_t seed);

}  // namespace spm::stability
