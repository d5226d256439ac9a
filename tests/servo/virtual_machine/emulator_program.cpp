// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/virtual_machine/emulator_program.hpp"

#include <sched.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>

namespace spm::test {

namespace {

/// Below a servo's threads (80 and 85), above everything else, so that the device keeps time.
constexpr int device_priority = 70;

volatile std::sig_atomic_t end_asked = 0;

/// Takes a whole number off the front.
template <class Number>
bool take_number(std::string_view& text, Number& number) {
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (parsed.ec != std::errc{}) return false;
  text.remove_prefix(static_cast<std::size_t>(parsed.ptr - text.data()));
  return true;
}

bool set_unplug(EmulatorOptions& options, std::string_view value) {
  std::int64_t away = 0;
  if (!take_number(value, options.unplug_after) || value.empty() || value.front() != ':') {
    return false;
  }
  value.remove_prefix(1);
  if (!take_number(value, away) || !value.empty()) return false;
  options.away = std::chrono::milliseconds(away);
  return true;
}

bool set(EmulatorOptions& options, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) {
    options.words.push_back(text);
    return true;
  }
  const std::string key = text.substr(0, equals);
  std::string_view value = std::string_view(text).substr(equals + 1);
  if (key == "unplug") return set_unplug(options, value);
  if (key == "times") return take_number(value, options.times) && value.empty();
  if (key == "report") {
    options.report = value;
    return !value.empty();
  }
  options.loses_power = key == "power" && value == "lost";
  return options.loses_power;
}

}  // namespace

std::optional<EmulatorOptions> parse_emulator_options(int count, char** arguments) {
  EmulatorOptions options;
  for (int i = 1; i < count; ++i) {
    if (!set(options, arguments[i])) return std::nullopt;
  }
  return options;
}

void enter_emulator() {
  std::signal(SIGTERM, [](int) { end_asked = 1; });
  std::signal(SIGPIPE, SIG_IGN);
  sched_param priority{};
  priority.sched_priority = device_priority;
  static_cast<void>(sched_setscheduler(0, SCHED_FIFO, &priority));
}

bool told_to_end() noexcept { return end_asked != 0; }

void write_report(const std::string& file, const nlohmann::ordered_json& seen) {
  std::ofstream out(file);
  out << seen.dump() << '\n';
  out.close();
  if (!out) give_up("the report cannot be written to " + file);
}

void give_up(const std::string& what) {
  std::fprintf(stderr, "%s (%s)\n", what.c_str(), std::strerror(errno));
  std::exit(2);
}

}  // namespace spm::test
