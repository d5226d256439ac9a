// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace spm::test {

/// What a program that emulates a device in a virtual machine is told, after the device's own
/// words: `unplug=COUNT:MS times=COUNT power=lost report=FILE`.
struct EmulatorOptions {
  std::uint64_t unplug_after = 0;     ///< reports or packets since it was plugged in; 0: never
  std::chrono::milliseconds away{0};  ///< until it is plugged in again
  int times = 1;                      ///< it is unplugged so often
  bool loses_power = false;           ///< while it is away
  std::string report;                 ///< file for what the device saw
  std::vector<std::string> words;     ///< those without '=', in their order
};

/// Nothing where a word has no meaning.
[[nodiscard]] std::optional<EmulatorOptions> parse_emulator_options(int count, char** arguments);

/// Takes SIGTERM as the end, and the priority of a device, below a servo's threads.
void enter_emulator();
[[nodiscard]] bool told_to_end() noexcept;

/// Writes a line of JSON. Ends the program where that fails.
void write_report(const std::string& file, const nlohmann::ordered_json& seen);

/// Ends the program, with a message of what failed and why by errno.
[[noreturn]] void give_up(const std::string& what);

}  // namespace spm::test
