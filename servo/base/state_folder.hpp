// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace spm::servo {

/// The folder for what the programs keep from run to run: spm-servo in the user's folder for
/// program state, $XDG_STATE_HOME or ~/.local/state. Empty if there is none. It may not exist yet.
[[nodiscard]] std::string state_folder();

}  // namespace spm::servo
