// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace spm::servo {

/// Largest force that is ever sent to a kind of device, N: what its maker rates it for, as
/// CHAI3D 3.3 ships the figures, and for devices that people build themselves the rating of their
/// motors.
inline constexpr double force_cap_omega3 = 12;
inline constexpr double force_cap_falcon = 8;
inline constexpr double force_cap_touch = 3.3;
inline constexpr double force_cap_wooden = 10;

/// The worst-case profile is as strong as the strongest of them.
inline constexpr double force_cap_low = 12;

}  // namespace spm::servo
