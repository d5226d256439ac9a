// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace spm::servo {

/// Whether a service manager (systemd) started this program.
[[nodiscard]] bool is_service();

/// Asks the service manager to put the calling process into a scope of its own, so that what ends
/// or freezes the service leaves it alone: the user's manager, or else the system's. Blocks for 2 s
/// at most. False if neither does it.
bool enter_own_scope(const std::string& name);

}  // namespace spm::servo
