// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>

#include "tests/servo/devices/hid/emulated_hid.hpp"

namespace spm::test {

/// A force feedback stick by name; or null:
/// - pid: two axes of 16 bits, a report each millisecond, directions are angles
/// - pid-axes: two axes of 8 bits, a report each 40 ms unless it is asked, no directions
/// - pid-no-constant: as pid, without constant force
/// - pid-full: as pid, with room for one effect
/// - pid-busy: as pid, but it never finishes creating an effect
[[nodiscard]] std::unique_ptr<EmulatedHid> make_emulated_pid(std::string_view name);

}  // namespace spm::test
