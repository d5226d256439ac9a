// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace spm {

/// The part of a tool's surface on which the stiffness of an object is reached, where what pushes
/// grows with the area that is pressed: methods `spm` and `paper`.
inline constexpr double pressed_part = 1.0 / 16;

}  // namespace spm
