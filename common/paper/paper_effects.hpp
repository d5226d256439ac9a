// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/vector.hpp"
#include "common/paper/paper_force.hpp"

namespace spm {

/// Friction, N, against the motion n_f = P_t - P_(t-dt) since the last tick (m): eq. 17 to the
/// letter. f_c in N and k_f in 1/m, both 0 or more. Zero where the point has not moved. This
/// friction does not depend on the normal force. At rest, where n_f is only the encoder's noise, it
/// chatters; coulomb_friction does not.
[[nodiscard]] Vector3 paper_friction(double f_c, double k_f, const PaperContact& contact,
                                     const Vector3& motion) noexcept;

/// Damping, N: -k_d times the velocity (m/s), the damping term of section 4.2. k_d in N s/m, 0 or
/// more.
[[nodiscard]] Vector3 paper_damping(double k_d, const Vector3& velocity) noexcept;

/// The force that the hand feels, N: the sum of reaction, friction and damping, eq. 18.
[[nodiscard]] Vector3 haptic_force(const Vector3& reaction, const Vector3& friction,
                                   const Vector3& damping) noexcept;

/// Force of a surface that noise n_g (m), added to its distance map (map_noise), makes rough, N:
/// eq. 19 to the letter where there is contact, zero elsewhere. Stiffness in N/m.
[[nodiscard]] Vector3 paper_texture_force(double stiffness, const PaperContact& contact,
                                          double noise) noexcept;

}  // namespace spm
