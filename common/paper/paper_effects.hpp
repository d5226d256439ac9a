// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/paper/paper_force.hpp"
#include "common/base/vector.hpp"

namespace spm {

/// Friction, N, against the motion n_f = P_t - P_(t-dt) since the last tick (m): eq. 17 to the
/// letter. f_c in N and k_f in 1/m, both 0 or more; zero where the point has not moved. It does not
/// depend on the force that presses, and at rest, where n_f is an encoder's noise, it chatters: see
/// coulomb_friction.
[[nodiscard]] Vector3 paper_friction(double f_c, double k_f, const PaperContact& contact,
                                     const Vector3& motion) noexcept;

/// Damping, N: -k_d times the velocity (m/s), the term of section 4.2. k_d in N s/m, 0 or more.
[[nodiscard]] Vector3 paper_damping(double k_d, const Vector3& velocity) noexcept;

/// What the hand feels, N: the sum of reaction, friction and damping, eq. 18.
[[nodiscard]] Vector3 haptic_force(const Vector3& reaction, const Vector3& friction,
                                   const Vector3& damping) noexcept;

/// The force on a surface made rough by noise n_g (m) that is added to its distance map, N: eq. 19
/// to the letter where there is contact, zero elsewhere. Stiffness in N/m.
[[nodiscard]] Vector3 paper_texture_force(double stiffness, const PaperContact& contact,
                                          double noise) noexcept;

}  // namespace spm
