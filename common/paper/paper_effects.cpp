// SPDX-License-Identifier: Apache-2.0
#include "common/paper/paper_effects.hpp"

#include <cmath>

namespace spm {

Vector3 paper_friction(double f_c, double k_f, const PaperContact& contact,
                       const Vector3& motion) noexcept {
  const double moved = motion.norm();
  if (!contact.contact || !(moved > 0)) return Vector3::Zero();
  const double depth = std::abs(contact.plane_depth - contact.surface_distance);
  return -f_c * (1 + k_f * depth) * motion / moved;
}

Vector3 paper_damping(double k_d, const Vector3& velocity) noexcept { return -k_d * velocity; }

Vector3 haptic_force(const Vector3& reaction, const Vector3& friction,
                     const Vector3& damping) noexcept {
  return reaction + friction + damping;
}

Vector3 paper_texture_force(double stiffness, const PaperContact& contact, double noise) noexcept {
  if (!contact.contact) return Vector3::Zero();
  return paper_force_magnitude(stiffness, contact.plane_depth, contact.surface_distance + noise) *
         contact.normal;
}

}  // namespace spm
