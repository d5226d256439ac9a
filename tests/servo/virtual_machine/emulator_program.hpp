// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace spm::test {

/// Options of a program that emulates a device in a virtual machine. They follow the device's own
/// words: `unplug=COUNT:MS times=COUNT power=lost report=FILE`.
struct EmulatorOptions {
  std::uint64_t unplug_after = 0;     ///< reports or packets since it was plugged in; 0: never
  std::chrono::milliseconds away{0};  ///< time from unplugging to plugging in again
  int times = 1;                      ///< how many times it is unplugged
  bool loses_power = false;           ///< whether it loses power while it is unplugged
  std::string report;                 ///< file for what the device saw
  std::vector<std::string> words;     ///< the words without '=', in their order
};

/// Returns nothing if a word has no meaning.
[[nodiscard]] std::optional<EmulatorOptions> parse_emulator_options(int count, char** arguments);

/// Makes SIGTERM a request to end, and sets a device's priority, below that of a servo's threads.
void enter_emulator();
[[nodiscard]] bool told_to_end() noexcept;

/// Writes a line of JSON. Ends the program if that fails.
void write_report(const std::string& file, const nlohmann::ordered_json& seen);

/// Ends the program with a message that says what failed, and why (from errno).
[[noreturn]] void give_up(const std::string& what);

}  // namespace spm::test
