// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/units.hpp"

namespace spm::cli {

enum class Color { automatic, always, never };

/// Options that every command of every program has.
struct GlobalOptions {
  bool quiet = false;
  bool json = false;
  Color color = Color::automatic;
};

/// Adds --quiet, --color and --json to a command; each sub-command gets its own.
void add_global_options(CLI::App& command, GlobalOptions& options);

/// Directs spdlog's default logger to stderr: one line each, "warning: ..." or "error: ...", in
/// colour as requested (NO_COLOR is honoured). With --quiet it prints errors only.
void configure_messages(const GlobalOptions& options);

/// Adds an option whose value has a unit ("50um"); a wrong value is a usage error that explains it.
CLI::Option* add_quantity(CLI::App& command, const std::string& name, double& target,
                          Quantity quantity, const std::string& description);
CLI::Option* add_quantity(CLI::App& command, const std::string& name, std::optional<double>& target,
                          Quantity quantity, const std::string& description);

/// Adds --probe point|sphere:RADIUS; the target is the radius in metres.
CLI::Option* add_probe(CLI::App& command, double& radius);
CLI::Option* add_probe(CLI::App& command, std::optional<double>& radius);

/// Adds an option whose text is read by `store`; an error from it is a usage error. `type` is what
/// the help shows for the value.
CLI::Option* add_parsed(CLI::App& command, const std::string& name,
                        std::function<Result<void>(const std::string&)> store,
                        const std::string& description, const std::string& type);

/// Adds a whole number from `min` to `max`; anything else is a usage error that names the range.
/// `store` gets the number.
CLI::Option* add_integer(CLI::App& command, const std::string& name, std::uint64_t min,
                         std::uint64_t max, std::function<void(std::uint64_t)> store,
                         const std::string& description);

/// Adds an option that takes one of a few words; any other word is a usage error that lists them.
/// `store` gets the index of the word.
CLI::Option* add_word(CLI::App& command, const std::string& name, std::vector<std::string> words,
                      std::function<void(std::size_t)> store, const std::string& description);

/// As add_word, with one value per word.
template <class T>
CLI::Option* add_choice(CLI::App& command, const std::string& name, T& target,
                        const std::vector<std::pair<std::string, T>>& choices,
                        const std::string& description) {
  std::vector<std::string> words;
  words.reserve(choices.size());
  for (const auto& choice : choices) words.push_back(choice.first);
  return add_word(
      command, name, words, [&target, choices](std::size_t i) { target = choices[i].second; },
      description);
}

/// Parses the command line. Returns nothing when the program should go on, otherwise the exit code:
/// 0 after --help or --version (on stdout), 1 for a usage error (one sentence on stderr).
/// The program and each of its sub-commands get --version here.
[[nodiscard]] std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

/// Prints an error as one line "error: ..." on stderr and returns its exit code.
[[nodiscard]] int report(const Error& error);

/// Prints one JSON object and a newline on stdout. Numbers that are not finite become null.
void print_json(const nlohmann::ordered_json& object);

/// A progress line on stderr, redrawn in place. Only on a terminal, never with --quiet or --json.
class ProgressLine {
 public:
  explicit ProgressLine(const GlobalOptions& options);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Draws the stage, the part that is done, 0 to 1, the time that it may still take and, where
  /// there is one, a detail. Draws nothing where the text is the same as before.
  void update(const char* stage, double done, const std::string& detail = {});

  /// Takes the line away, so that something else can be printed.
  void clear();

 private:
  bool active_ = false;
  bool drawn_ = false;
  std::string last_;
  std::string stage_;
  double start_ = 0;  ///< part of the stage that was done when it began
  double done_ = 0;   ///< part that was done at the last update
  std::chrono::steady_clock::time_point began_;
};

}  // namespace spm::cli
