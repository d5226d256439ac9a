// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace spm::baker {

/// Called with a stage's name and how much of it is done, 0 to 1; may be empty.
using Progress = std::function<void(const char* stage, double done)>;

}  // namespace spm::baker
