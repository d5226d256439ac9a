// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <csignal>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

#include "common/base/units.hpp"
#include "servo/commands/account_names.hpp"
#include "servo/commands/commands.hpp"
#include "servo/loop/run.hpp"
#include "servo/loop/run_report.hpp"

namespace spm::servo {

namespace {

constexpr double longest_run = 366.0 * 24 * 3600;  // s
constexpr double shortest_run = 1e-3;              // s

struct RunCommand {
  cli::GlobalOptions global;
  RunOptions options;
};

/// What a person has to do before there is force.
void add_permission_options(CLI::App& app, RunOptions& options) {
  cli::add_word(
      app, "--recovery", {"automatic", "acknowledge"},
      [&options](std::size_t i) { options.acknowledge = i == 1; },
      "How the force comes back when a fault is over: by itself (default), or once somebody "
      "acknowledges it, by a button of the device or an application");
  cli::add_parsed(
      app, "--enable-switch",
      [&options](const std::string& text) -> Result<void> {
        constexpr std::string_view form = "button:";
        constexpr std::uint32_t most = 32;  // bits of a DeviceState
        const char* const end = text.data() + text.size();
        std::uint32_t button = 0;
        const bool named = text.starts_with(form);
        const auto parsed = std::from_chars(text.data() + (named ? form.size() : 0), end, button);
        if (text == "off") {
          options.enable_button = 0;
        } else if (named && parsed.ec == std::errc{} && parsed.ptr == end && button >= 1 &&
                   button <= most) {
          options.enable_button = button;
        } else {
          return fail(ExitCode::usage, "'" + text +
                                           "' will not do: write button:N, with a button of the "
                                           "device from 1 to 32, or off");
        }
        return {};
      },
      "Without this button of the device held there is no force; it fades in when it is pressed "
      "(default off)",
      "button:N|off");
}

constexpr double least_budget = 1, whole_budget = 100;  // %

/// A share of a period, from a number with or without its sign, such as `60%`. Errors: usage.
Result<double> percent(const std::string& text) {
  const char* end = text.data() + text.size();
  double value = 0;
  const auto [read, problem] = std::from_chars(text.data(), end, value);
  const std::string_view rest(read, static_cast<std::size_t>(end - read));
  if (problem == std::errc() && (rest.empty() || rest == "%" || rest == " %") &&
      value >= least_budget && value <= whole_budget) {
    return value / 100;
  }
  return fail(ExitCode::usage, "'" + text + "' is no share of a period; give 1% to 100%, like 60%");
}

/// Seconds, from a number of them or from a time with its unit. Errors: usage.
Result<double> duration(const std::string& text) {
  const char* const end = text.data() + text.size();
  double value = 0;
  const auto bare = std::from_chars(text.data(), end, value);
  if (bare.ec != std::errc{} || bare.ptr != end) {
    value = parse_quantity(text, Quantity::duration).value_or(0);
  }
  // Written so that NaN is out of range.
  if (value >= shortest_run && value <= longest_run) return value;
  return fail(ExitCode::usage,
              "'" + text +
                  "' will not do: write a number of seconds, or a time such as 500ms, 10s or 2min, "
                  "from 1ms to a year");
}

int execute_run(const RunCommand& command) {
  cli::configure_messages(command.global);
  // A message that nobody reads must not end this process in mid-force.
  std::signal(SIGPIPE, SIG_IGN);
  const Result<RunReport> report = run(command.options);
  if (!report) return cli::report(report.error());
  if (command.global.json) {
    cli::print_json(to_json(*report));
  } else if (!command.global.quiet) {
    std::cout << to_text(*report);
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace

Command add_run_command(CLI::App& program) {
  auto command = std::make_shared<RunCommand>();
  CLI::App* app =
      program.add_subcommand("run", "Serve forces from a baked asset or a scene to a device");
  RunOptions& options = command->options;
  cli::add_global_options(*app, command->global);
  app->add_option(
         "--device", options.devices,
         "Device: auto (the first that is plugged in, or sim; the default unless the scene "
         "says another), or a kind of device; sim with "
         "profile=low|falcon|touch|omega3|wooden, hand=slide|push|path|live (live: led by an "
         "application, or in the page of view), path=FILE, "
         "depth=LENGTH, speed=SPEED, seed=N, hand_model=spring|arm, mass=constant|device, "
         "delay=TICKS, jitter=TICKS, lost=SHARE, noise=LENGTH, turns=on|off (whether it reads its "
         "orientation), torque=on|off (whether it gives torque); options follow a colon, with "
         "commas between; may be repeated")
      // In the form from which completion takes its words.
      ->type_name(
          "auto|sim|falcon|woodenhaptics|spacemouse|pid:full_force=FORCE|external:name=NAME")
      ->allow_extra_args(false);
  add_rate_option(*app, options.rate_hz);
  cli::add_word(
      *app, "--pace", {"clock", "device"},
      [&options](std::size_t i) { options.paced_by_device = i == 1; },
      "What a tick follows: the clock (default), or each report of the first device, which then "
      "should report about --rate times a second");
  cli::add_parsed(
      *app, "--tick-budget",
      [&options](const std::string& text) -> Result<void> {
        const auto share = percent(text);
        if (!share) return tl::make_unexpected(share.error());
        options.tick_budget = *share;
        return {};
      },
      "Part of a tick's period for the exact forces of all objects; those that are left then are "
      "computed more coarsely, see degraded_ticks (default 60%)",
      "PERCENT");
  cli::add_choice<RealtimeMode>(*app, "--realtime", options.realtime,
                                {{"require", RealtimeMode::require},
                                 {"try", RealtimeMode::attempt},
                                 {"off", RealtimeMode::off}},
                                "Real-time priority and locked memory (default try)");
  app->add_option("--core", options.core,
                  "Core that the loop and the threads of its devices run on (default: any)")
      ->type_name("N");
  cli::add_choice<MapMode>(*app, "--map", options.map,
                           {{"file", MapMode::file}, {"sealed", MapMode::sealed}},
                           "Map the file itself (default), or a sealed copy of it, for stores that "
                           "others may write to");
  cli::add_parsed(
      *app, "--duration",
      [&options](const std::string& text) -> Result<void> {
        const auto seconds = duration(text);
        if (!seconds) return tl::make_unexpected(seconds.error());
        options.duration = *seconds;
        return {};
      },
      "Stop so long after the first tick (default: at a signal); 500ms, 10s and 2min are "
      "understood",
      "SECONDS");
  add_force_options(*app, options.force);
  app->add_option("--trace", options.trace, "Write one row a tick of the first device as CSV")
      ->type_name("FILE");
  app->add_option("--record", options.record,
                  "Write every tick of every device as a recording, for replay")
      ->type_name("FILE");
  app->add_option_function<std::string>(
         "--black-box",
         [&options](const std::string& path) { options.black_box = path == "off" ? "" : path; },
         "Where the last 10 s of ticks are kept after a fault, a crash or a kill, or off (default "
         "a file for each, with the daemon's name and the time, in $XDG_STATE_HOME/spm-servo or "
         "~/.local/state/spm-servo, of which the newest 5 are kept; a * in FILE's name is the "
         "time)")
      ->type_name("FILE|off");
  app->add_option("--name", options.name,
                  "Name of this daemon, by which applications find it where several run (default "
                  "$SPM_SERVO_NAME, or default)")
      ->type_name("NAME");
  app->add_option_function<std::string>(
         "--socket",
         [&options](const std::string& path) {
           options.serve = path != "off";
           options.socket = options.serve ? path : "";
         },
         "Where applications connect, or off (default $XDG_RUNTIME_DIR/spm-servo/NAME.sock)")
      ->type_name("FILE|off");
  cli::add_parsed(
      *app, "--app-group",
      [&options](const std::string& text) -> Result<void> {
        const Result<std::uint32_t> group = group_id(text);
        if (!group) return tl::make_unexpected(group.error());
        options.app_group = *group;
        return {};
      },
      "Group whose members may connect applications too, beside this user and root: a name or an "
      "id; needs --socket, in a folder that the group may enter",
      "GROUP");
  add_permission_options(*app, options);
  cli::add_parsed(
      *app, "--supervisor",
      [&options](const std::string& text) -> Result<void> {
        const bool is_path = text.find('/') != std::string::npos;
        if (!is_path && text != "on" && text != "off") {
          return fail(ExitCode::usage, "--supervisor: '" + text +
                                           "' is neither on, off, nor the path of a socket of "
                                           "'spm-servo supervise', as /run/spm/supervisor.sock");
        }
        options.supervisor = text != "off";
        options.supervisor_socket = is_path ? text : "";
        return {};
      },
      "Whether another process sends the devices zero force where this one is killed: on, off, or "
      "the socket of 'spm-servo supervise', which a pause of this program's container does not "
      "reach (default on)",
      "on|off|SOCKET");
  return cli::with_checked_output({app, [command] { return execute_run(*command); }});
}

}  // namespace spm::servo
