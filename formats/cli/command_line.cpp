// SPDX-License-Identifier: Apache-2.0
#include "formats/cli/command_line.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "formats/cli/progress_text.hpp"
#include "formats/files/nearest_word.hpp"

namespace spm::cli {
namespace {

bool messages_configured = false;

/// The sub-command that was being parsed, or the program itself.
const CLI::App& deepest(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : deepest(*chosen.front());
}

std::string full_name(const CLI::App& app) {
  const CLI::App* parent = app.get_parent();
  return parent == nullptr ? app.get_name() : full_name(*parent) + " " + app.get_name();
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += words[i];
  }
  return text;
}

/// The option that a file of such a name was meant for; empty where there is none.
std::string option_of_file(const CLI::App& command, const std::string& file) {
  std::string option;
  if (file.ends_with(".spm.exr")) option = "--asset";
  if (file.ends_with(".toml")) option = "--scene";
  return command.get_option_no_throw(option) != nullptr ? option : "";
}

std::string describe_unexpected(const CLI::App& app) {
  const std::vector<std::string> rest = app.remaining(true);
  const auto option = std::find_if(rest.begin(), rest.end(), [](const std::string& word) {
    return word.size() > 1 && word.front() == '-';
  });
  const CLI::App& command = deepest(app);
  const std::string help = fmt::format("'{} --help' lists them", full_name(command));
  if (option != rest.end()) {
    const std::string word = option->substr(0, option->find('='));
    std::vector<std::string> names;
    for (const CLI::Option* known : command.get_options()) {
      for (const std::string& name : known->get_lnames()) names.push_back("--" + name);
    }
    const auto near = nearest_word(word, names);
    return fmt::format("{} is not an option of {}: {}", word, full_name(command),
                       near ? fmt::format("did you mean {}?", *near) : help);
  }
  if (rest.empty()) return fmt::format("an argument was not expected: {}", help);
  if (command.get_parent() == nullptr && !command.get_subcommands({}).empty()) {
    std::vector<std::string> names;
    for (const CLI::App* known : command.get_subcommands({})) names.push_back(known->get_name());
    const auto near = nearest_word(rest.front(), names);
    return fmt::format("'{}' is not a command of {}: {}", rest.front(), full_name(command),
                       near ? fmt::format("did you mean {}?", *near) : help);
  }
  if (const std::string meant = option_of_file(command, rest.front()); !meant.empty()) {
    return fmt::format("the argument '{}' was not expected: did you mean {} {}?", rest.front(),
                       meant, rest.front());
  }
  return fmt::format(
      "the argument '{}' was not expected: quote names with blanks, or see '{} --help'",
      rest.front(), full_name(command));
}

std::string describe(const CLI::App& app, const CLI::ParseError& problem) {
  if (dynamic_cast<const CLI::ExtrasError*>(&problem) != nullptr) return describe_unexpected(app);
  std::string text = problem.what();
  if (dynamic_cast<const CLI::RequiredError*>(&problem) != nullptr) {
    // A missing argument may be one that was misspelt.
    if (!app.remaining(true).empty()) return describe_unexpected(app);
    return fmt::format("{}: see '{} --help'", text, full_name(deepest(app)));
  }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&problem) != nullptr) {
    const std::string option = text.substr(0, text.find(':'));
    return fmt::format("{} needs one value, and may be given once: see '{} --help'", option,
                       full_name(deepest(app)));
  }
  return text;
}

void add_version(CLI::App& app) {
  if (app.get_version_ptr() == nullptr) {
    std::string program = full_name(app);
    program = program.substr(0, program.find(' '));
    app.set_version_flag("--version", program + " " SPM_VERSION, "print the version and exit");
  }
  for (CLI::App* command : app.get_subcommands({})) add_version(*command);
}

const char* type_name(Quantity quantity) {
  switch (quantity) {
    case Quantity::length:
      return "LENGTH";
    case Quantity::stiffness:
      return "STIFFNESS";
    case Quantity::force:
      return "FORCE";
    case Quantity::speed:
      return "SPEED";
    case Quantity::angle:
      return "ANGLE";
    case Quantity::damping:
      return "DAMPING";
    case Quantity::mass:
      return "MASS";
    case Quantity::per_length:
      return "PER-LENGTH";
    case Quantity::angular_speed:
      return "ANGULAR-SPEED";
    case Quantity::rate:
      return "RATE";
    case Quantity::torque:
      return "TORQUE";
    case Quantity::turning_stiffness:
      return "TURNING-STIFFNESS";
    case Quantity::duration:
      return "DURATION";
  }
  return "QUANTITY";
}

}  // namespace

CLI::Option* add_parsed(CLI::App& command, const std::string& name,
                        std::function<Result<void>(const std::string&)> store,
                        const std::string& description, const std::string& type) {
  // Messages use the long name.
  const std::string shown =
      name.substr(name.rfind(',') == std::string::npos ? 0 : name.rfind(',') + 1);
  return command
      .add_option_function<std::string>(
          name,
          [store = std::move(store), shown](const std::string& text) {
            const Result<void> stored = store(text);
            if (!stored) throw CLI::ValidationError(shown, stored.error().message);
          },
          description)
      ->type_name(type);
}

void add_global_options(CLI::App& command, GlobalOptions& options) {
  command.add_flag("--json", options.json, "print the result as one JSON object and nothing else");
  command.add_flag("--quiet", options.quiet, "print errors only: no warnings, notes or progress");
  add_choice<Color>(
      command, "--color", options.color,
      {{"auto", Color::automatic}, {"always", Color::always}, {"never", Color::never}},
      "colour of messages (default auto: on a terminal, unless NO_COLOR is set)");
}

void configure_messages(const GlobalOptions& options) {
  const char* no_color = std::getenv("NO_COLOR");
  auto mode = spdlog::color_mode::automatic;
  if (options.color == Color::always) mode = spdlog::color_mode::always;
  if (options.color == Color::never) mode = spdlog::color_mode::never;
  if (options.color == Color::automatic && no_color != nullptr && *no_color != '\0') {
    mode = spdlog::color_mode::never;
  }
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>(mode);
  auto logger = std::make_shared<spdlog::logger>("messages", std::move(sink));
  logger->set_pattern("%^%l:%$ %v");
  logger->set_level(options.quiet ? spdlog::level::err : spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
  messages_configured = true;
}

namespace {

template <class Target>
auto quantity_into(Target& target, Quantity quantity) {
  return [&target, quantity](const std::string& text) -> Result<void> {
    const Result<double> value = parse_quantity(text, quantity);
    if (!value) return tl::make_unexpected(value.error());
    target = *value;
    return {};
  };
}

}  // namespace

CLI::Option* add_quantity(CLI::App& command, const std::string& name, double& target,
                          Quantity quantity, const std::string& description) {
  return add_parsed(command, name, quantity_into(target, quantity),
                    fmt::format("{} (default {})", description, format_quantity(target, quantity)),
                    type_name(quantity));
}

CLI::Option* add_quantity(CLI::App& command, const std::string& name, std::optional<double>& target,
                          Quantity quantity, const std::string& description) {
  return add_parsed(command, name, quantity_into(target, quantity), description,
                    type_name(quantity));
}

namespace {

template <class Target>
CLI::Option* add_probe_into(CLI::App& command, Target& radius) {
  return add_parsed(
      command, "--probe",
      [&radius](const std::string& text) -> Result<void> {
        const Result<double> value = parse_probe(text);
        if (!value) return tl::make_unexpected(value.error());
        radius = *value;
        return {};
      },
      "what touches the object; RADIUS is a length such as 0.5mm (default point)",
      "point|sphere:RADIUS");
}

}  // namespace

CLI::Option* add_probe(CLI::App& command, double& radius) {
  return add_probe_into(command, radius);
}

CLI::Option* add_probe(CLI::App& command, std::optional<double>& radius) {
  return add_probe_into(command, radius);
}

CLI::Option* add_integer(CLI::App& command, const std::string& name, std::uint64_t min,
                         std::uint64_t max, std::function<void(std::uint64_t)> store,
                         const std::string& description) {
  return add_parsed(
      command, name,
      [min, max, store = std::move(store)](const std::string& text) -> Result<void> {
        std::uint64_t value = 0;
        const char* end = text.data() + text.size();
        const auto parsed = std::from_chars(text.data(), end, value);
        if (parsed.ec != std::errc() || parsed.ptr != end || value < min || value > max) {
          return fail(
              ExitCode::usage,
              fmt::format("'{}' will not do: write a whole number from {} to {}", text, min, max));
        }
        store(value);
        return {};
      },
      description, "N");
}

CLI::Option* add_word(CLI::App& command, const std::string& name, std::vector<std::string> words,
                      std::function<void(std::size_t)> store, const std::string& description) {
  std::string type;
  for (const std::string& word : words) type += (type.empty() ? "" : "|") + word;
  return add_parsed(
      command, name,
      [words = std::move(words),
       store = std::move(store)](const std::string& text) -> Result<void> {
        const auto found = std::find(words.begin(), words.end(), text);
        if (found == words.end()) {
          return fail(ExitCode::usage,
                      fmt::format("'{}' will not do: write {}", text, joined(words)));
        }
        store(static_cast<std::size_t>(found - words.begin()));
        return {};
      },
      description, type);
}

std::optional<int> parse(CLI::App& app, int argc, const char* const* argv) {
  add_version(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    // --help and --version: CLI11 prints them on stdout.
    return app.exit(success, std::cout, std::cout);
  } catch (const CLI::ParseError& problem) {
    return report(Error{ExitCode::usage, describe(app, problem)});
  }
  return std::nullopt;
}

int report(const Error& error) {
  if (!messages_configured) configure_messages({});
  std::string line = error.message;
  std::replace(line.begin(), line.end(), '\n', ' ');
  spdlog::error("{}", line);
  return static_cast<int>(error.code);
}

void print_json(const nlohmann::ordered_json& object) {
  // A path need not be valid UTF-8; the JSON must be.
  std::cout << object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
            << '\n';
  std::cout.flush();
}

ProgressLine::ProgressLine(const GlobalOptions& options)
    : active_(!options.quiet && !options.json && isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::clear() {
  if (drawn_) std::cerr << "\r\033[K" << std::flush;
  drawn_ = false;
  last_.clear();
}

void ProgressLine::update(const char* stage, double done, const std::string& detail) {
  if (!active_) return;
  const auto now = std::chrono::steady_clock::now();
  // A stage whose progress falls far back has started another round. Threads report slightly out of
  // order.
  if (stage != stage_ || done < done_ / 2) {
    stage_ = stage;
    start_ = done;
    began_ = now;
  }
  done_ = done;
  const double seconds = std::chrono::duration<double>(now - began_).count();
  std::string line = progress_text(stage, {done, start_, seconds});
  if (!detail.empty()) line += "; " + detail;
  if (line == last_) return;
  std::cerr << "\r\033[K" << line << std::flush;
  last_ = std::move(line);
  drawn_ = true;
}

}  // namespace spm::cli
