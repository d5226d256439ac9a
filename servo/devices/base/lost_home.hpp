// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace spm::servo {

/// A position that jumped by more than this between two reports, m, as no hand moves: an encoder
/// has slipped, and does not know any more where it is.
inline constexpr double lost_home_jump = 0.02;

}  // namespace spm::servo
