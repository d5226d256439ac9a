// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace spm::servo {

/// The exit code of shells for a program that was not found.
inline constexpr int program_not_found = 127;

enum class ChildOutput { shown, dropped };

/// Runs a program of the search path with arguments (the program's name first), and waits for it.
/// Returns its exit code; or 128 plus the signal's number if a signal ended it; or
/// `program_not_found` if it could not be started.
[[nodiscard]] int run_child(const std::vector<std::string>& words, ChildOutput output);

}  // namespace spm::servo
