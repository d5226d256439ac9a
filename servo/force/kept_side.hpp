// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace spm {

/// m, and rad of what turns: how far a hand or an object may move while there is no force, and the
/// hand stay on its side of what it touched. It is more than a hand presses into what is stiff
/// enough to lean on (8 N at 2 N/mm), and less than a hand moves to go round something.
inline constexpr double kept_way = 0.005, kept_turn = 0.1;

}  // namespace spm
