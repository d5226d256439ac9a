// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace spm {

/// m: the lever at which turns are compared with lengths and torques with forces, and the coupling
/// of a tool turns as stiffly as it moves: 1 N m/rad for 1000 N/m. The length of a finger's bone.
inline constexpr double turning_lever = 0.0316227766;

/// N/m at that lever, for N m/rad; and kg, for kg m2.
[[nodiscard]] constexpr double at_lever(double turning) noexcept {
  return turning / (turning_lever * turning_lever);
}

}  // namespace spm
