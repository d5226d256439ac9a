// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace spm::bench {

/// Called with the name of the current measurement and the share done, 0 to 1; may be empty.
using BenchProgress = std::function<void(const std::string& what, double done)>;

}  // namespace spm::bench
