// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace spm::baker {

/// Called with the name of a stage and how much of it is done, from 0 to 1. May be empty.
using Progress = std::function<void(const char* stage, double done)>;

}  // namespace spm::baker
