// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "common/base/vector.hpp"
#include "common/base/wrench.hpp"

namespace spm {

/// What of a force that was sent counts as the contact's, N, where `contact` and what applications
/// `added` to it were wanted. The passivity account is of the contact alone: what an application
/// pushes is work by intent, and counted as the contact's it would be braked as energy that the
/// loop made, or would pay for such energy. What a limit takes is taken from both alike.
[[nodiscard]] inline Vector3 contact_part(const Vector3& sent, const Vector3& contact,
                                          const Vector3& added) noexcept {
  if (added == Vector3::Zero()) return sent;
  const Vector3 wanted = contact + added;
  const double size = wanted.squaredNorm();
  return size > 0 ? Vector3(std::clamp(sent.dot(wanted) / size, 0.0, 1.0) * contact)
                  : Vector3(contact);
}

/// The same of a wrench: limits take from force and torque each by itself.
[[nodiscard]] inline Wrench contact_part(const Wrench& sent, const Wrench& contact,
                                         const Wrench& added) noexcept {
  return {contact_part(sent.force, contact.force, added.force),
          contact_part(sent.torque, contact.torque, added.torque)};
}

}  // namespace spm
