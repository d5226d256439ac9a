// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace spm::servo {

/// A shell's code for a program that was not found.
inline constexpr int program_not_found = 127;

enum class ChildOutput { shown, dropped };

/// Runs a program of the search path with arguments, the program's name first, and waits for it.
/// Gives its exit code; 128 and the signal's number where a signal ended it; `program_not_found`
/// where it could not be started.
[[nodiscard]] int run_child(const std::vector<std::string>& words, ChildOutput output);

}  // namespace spm::servo
