// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "tests/stability/laboratory/laboratory.hpp"

namespace spm::stability {

/// All that the laboratory compares, in the order of its tables: the rivals, the product's own
/// forms, each stabilizer alone on both, and the product's default.
[[nodiscard]] const std::vector<Contender>& all_contenders();

/// The contender's name in reports and on the command line: `proxy`, `proxy+damping`.
[[nodiscard]] std::string name_of(const Contender& contender);

}  // namespace spm::stability
