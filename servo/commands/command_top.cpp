// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <deque>
#include <memory>
#include <thread>
#include <utility>

#include "servo/client/spm_client.h"
#include "servo/commands/account_names.hpp"
#include "servo/commands/commands.hpp"
#include "servo/realtime/stop_signals.hpp"
#include "servo/top/top_screen.hpp"
#include "servo/top/top_terminal.hpp"

namespace spm::servo {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds look_interval{16};
constexpr int rounds_per_drawing = 6;  // ten a second; nobody reads faster
constexpr std::chrono::seconds shown_time{1};
/// A reading fails if the loop is kept from its processor in the middle of a write.
constexpr int max_tries = 10;
constexpr std::chrono::milliseconds retry_interval{1};

struct TopCommand {
  cli::GlobalOptions global;
  std::string socket, name;
  std::uint32_t server_user = 0;
  bool once = false;
};

struct Disconnect {
  void operator()(spm_client* client) const noexcept { spm_client_disconnect(client); }
};
using ClientHandle = std::unique_ptr<spm_client, Disconnect>;

ExitCode exit_code_of(int code) noexcept {
  switch (code) {
    case SPM_CLIENT_BAD_ARGUMENT:
      return ExitCode::usage;
    case SPM_CLIENT_VERSION_DIFFERS:
      return ExitCode::unsupported;
    case SPM_CLIENT_INTERNAL:
      return ExitCode::internal;
    default:
      return ExitCode::file_or_device;
  }
}

Result<ClientHandle> connect(const TopCommand& command) {
  spm_client_options options{};
  options.size = sizeof options;
  options.path = command.socket.empty() ? nullptr : command.socket.c_str();
  options.name = command.name.empty() ? nullptr : command.name.c_str();
  options.application = "spm-servo top";
  options.role = SPM_CLIENT_OBSERVER;
  options.server_user = command.server_user;
  std::array<char, 512> message{};
  spm_client* client = nullptr;
  const int code = spm_client_connect(&options, &client, message.data(), message.size());
  if (code != SPM_CLIENT_OK) return fail(exit_code_of(code), message.data());
  return ClientHandle(client);
}

/// Reads a struct by the library. If that fails, it keeps its value.
template <class Record, class Read>
bool refresh(Record& record, const Read& read) {
  Record found{};
  found.size = sizeof found;
  for (int attempt = 0; attempt < max_tries; ++attempt) {
    const int code = read(&found);
    if (code == SPM_CLIENT_OK) record = found;
    if (code != SPM_CLIENT_BUSY) return code == SPM_CLIENT_OK;
    std::this_thread::sleep_for(retry_interval);
  }
  return false;
}

void look_at_device(const spm_client* client, std::uint32_t index, TopSample::Device& device) {
  std::array<char, SPM_CLIENT_NAME_BYTES> name{};
  if (spm_client_device_name(client, index, name.data(), name.size()) == SPM_CLIENT_OK) {
    device.name = name.data();
  }
  refresh(device.state, [&](auto* to) { return spm_client_read_device(client, index, to); });
  refresh(device.counts,
          [&](auto* to) { return spm_client_read_device_counts(client, index, to); });
  const std::uint32_t cause =
      device.state.cause != SPM_CLIENT_FORCE_ON ? device.state.cause : device.counts.last_cause;
  const char *cause_name = "", *cure = "";
  spm_client_cause(client, cause, &cause_name, &cure);
  device.cause = cause_name;
  device.cure = cure;
}

/// Looks at the daemon. What cannot be read is as in `last`.
TopSample look(const spm_client* client, const TopSample& last) {
  TopSample sample = last;
  sample.daemon = spm_client_daemon_state(client, &sample.age);
  refresh(sample.info, [&](auto* to) { return spm_client_read_info(client, to); });
  refresh(sample.loop, [&](auto* to) { return spm_client_read_loop(client, to); });
  sample.devices.resize(sample.info.device_count);
  for (std::uint32_t i = 0; i < sample.devices.size(); ++i) {
    look_at_device(client, i, sample.devices[i]);
  }
  sample.applications.clear();
  spm_client_application found{};
  for (std::uint32_t i = 0;
       refresh(found, [&](auto* to) { return spm_client_read_application(client, i, to); }); ++i) {
    sample.applications.push_back(found);
  }
  return sample;
}

bool is_over(int daemon) noexcept {
  return daemon == SPM_CLIENT_ENDED || daemon == SPM_CLIENT_GONE;
}

/// Draws until a key or a signal ends it, or the daemon ends. Returns the last view.
TopView watch(const spm_client* client) {
  StopSignals signals;
  signals.listen();
  TopTerminal terminal;
  std::deque<std::pair<Clock::time_point, TopSample>> samples{{Clock::now(), look(client, {})}};
  for (int rounds = 0;; ++rounds) {
    TopView view = view_between(samples.front().second, samples.back().second);
    if (rounds % rounds_per_drawing == 0) {
      terminal.draw(top_screen(view, TopTerminal::width()) + "q ends\n");
    }
    const bool end = is_over(view.daemon) || signals.flag().load();
    if (end || terminal.wait_for_end(look_interval)) return view;
    const auto now = Clock::now();
    samples.emplace_back(now, look(client, samples.back().second));
    while (samples.size() > 2 && samples[1].first <= now - shown_time) samples.pop_front();
  }
}

TopView watch_once(const spm_client* client) {
  const TopSample before = look(client, {});
  std::this_thread::sleep_for(shown_time);
  return view_between(before, look(client, before));
}

int execute_top(const TopCommand& command) {
  cli::configure_messages(command.global);
  const auto client = connect(command);
  if (!client) return cli::report(client.error());
  const bool draws = !command.once && !command.global.json && isatty(STDOUT_FILENO) == 1;
  const TopView view = draws ? watch(client->get()) : watch_once(client->get());
  if (command.global.json) {
    cli::print_json(to_json(view));
  } else if (!draws ? !command.global.quiet : is_over(view.daemon)) {
    fmt::print("{}", top_screen(view, TopTerminal::width()));
  }
  if (view.daemon == SPM_CLIENT_GONE) {
    return cli::report({ExitCode::file_or_device,
                        "the daemon hung up without a word: it crashed or was killed; look at its "
                        "messages, and start it again"});
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace

Command add_top_command(CLI::App& program) {
  auto command = std::make_shared<TopCommand>();
  CLI::App* app = program.add_subcommand(
      "top",
      "Watch the running daemon: how its loop keeps time, what each device feels, and why where it "
      "feels nothing; q ends");
  cli::add_global_options(*app, command->global);
  app->add_option("--name", command->name,
                  "Name of the daemon, as its --name says (default $SPM_SERVO_NAME, or default)")
      ->type_name("NAME");
  app->add_option("--socket", command->socket,
                  "Socket of the daemon (default $XDG_RUNTIME_DIR/spm-servo/NAME.sock)")
      ->type_name("FILE");
  cli::add_parsed(
      *app, "--server-user",
      [&trusted = command->server_user](const std::string& text) -> Result<void> {
        const Result<std::uint32_t> user = user_id(text);
        if (!user) return tl::make_unexpected(user.error());
        trusted = *user;
        return {};
      },
      "User whose daemon is trusted, beside those of this user and of root: a name or an id",
      "USER");
  app->add_flag("--once", command->once,
                "Watch for a second, print what was seen and end; so also where the output is no "
                "terminal, and with --json");
  return {app, [command] { return execute_top(*command); }};
}

}  // namespace spm::servo
