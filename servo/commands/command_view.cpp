// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "servo/commands/account_names.hpp"
#include "servo/commands/commands.hpp"
#include "servo/realtime/stop_signals.hpp"
#include "servo/view/view_recordings.hpp"
#include "servo/view/view_server.hpp"

namespace spm::servo {

namespace {

namespace fs = std::filesystem;

struct ViewCommand {
  cli::GlobalOptions global;
  ViewSettings settings;
};

/// The built page beside the program, installed or in its build folder; or in the build folder of
/// the preset that scripts/build_page takes by itself, where this one is of another.
std::string page_folder() {
  std::error_code problem;
  const fs::path program = fs::read_symlink("/proc/self/exe", problem);
  const fs::path prefix = program.parent_path().parent_path();
  const auto page = fs::path("share") / "spm-haptics" / "view";
  const fs::path other = prefix.parent_path() / "release" / page;
  const bool is_elsewhere = !fs::exists(prefix / page, problem) &&
                            fs::exists(prefix / "CMakeCache.txt", problem) &&
                            fs::exists(other, problem);
  return (is_elsewhere ? other : prefix / page).string();
}

void tell_start(const ViewCommand& command, const ViewAddresses& addresses) {
  const bool is_live = command.settings.recordings.empty();
  if (command.global.json) {
    nlohmann::ordered_json json = {{"url", addresses.page}};
    if (is_live) json["foxglove"] = addresses.foxglove;
    cli::print_json(json);
  } else {
    fmt::print("{}\n", addresses.page);
    if (is_live) {
      spdlog::info("open this address in a browser; Ctrl-C ends the view, not the daemon");
      spdlog::info("Foxglove viewers connect to {}", addresses.foxglove);
    } else {
      spdlog::info("open this address in a browser; Ctrl-C ends the view");
    }
  }
  // Whoever reads it waits for it while the view goes on.
  std::fflush(stdout);
}

/// What does not go together. Errors: usage.
Result<void> check(const ViewSettings& settings) {
  const FeedSettings& feed = settings.feed;
  if (settings.recordings.empty()) return {};
  if (!feed.name.empty() || !feed.socket.empty() || !settings.origins.empty()) {
    return fail(ExitCode::usage,
                "--recording: no daemon is watched with it; leave --name, --socket and "
                "--allow-origin out");
  }
  return {};
}

int execute_view(const ViewCommand& command) {
  cli::configure_messages(command.global);
  if (const auto good = check(command.settings); !good) return cli::report(good.error());
  if (!is_loopback(command.settings.address)) {
    spdlog::warn(
        "--address {}: whoever learns the address with its token can lead the simulated hand and "
        "change how objects feel, and reads along the way are not encrypted; leave the option away "
        "for this machine alone",
        command.settings.address);
  }
  StopSignals signals;
  signals.listen();
  ViewSettings settings = command.settings;
  settings.page = page_folder();
  settings.tell = [](const std::string& sentence) { spdlog::warn(sentence); };
  const auto served = serve_view(settings, signals.flag(), [&](const ViewAddresses& addresses) {
    tell_start(command, addresses);
  });
  if (!served) return cli::report(served.error());
  return static_cast<int>(ExitCode::done);
}

}  // namespace

Command add_view_command(CLI::App& program) {
  auto command = std::make_shared<ViewCommand>();
  CLI::App* app = program.add_subcommand(
      "view",
      "Serve a page for the browser: the scene of the running daemon, its hands and forces, where "
      "with --device sim:hand=live the page leads the hand; or a recording, to be played");
  cli::add_global_options(*app, command->global);
  FeedSettings& feed = command->settings.feed;
  app->add_option("--recording", command->settings.recordings,
                  "Recording or black box to play instead of watching a daemon; a second one is "
                  "compared with it")
      ->type_name("FILE")
      ->expected(1, int{most_recordings});
  app->add_option("--allow-origin", command->settings.origins,
                  "Origin of a page, such as https://app.foxglove.dev, that may watch by the "
                  "Foxglove protocol (default: programs alone)")
      ->type_name("ORIGIN");
  cli::add_integer(
      *app, "--port", 0, 65535,
      [&settings = command->settings](std::uint64_t port) {
        settings.port = static_cast<std::uint16_t>(port);
      },
      "Port of the page, 0 to 65535 (default 0: any)");
  app->add_option("--address", command->settings.address,
                  "Address to serve at, in digits (default 127.0.0.1: this machine alone)")
      ->type_name("ADDRESS");
  app->add_option("--name", feed.name,
                  "Name of the daemon, as its --name says (default $SPM_SERVO_NAME, or default)")
      ->type_name("NAME");
  app->add_option("--socket", feed.socket,
                  "Socket of the daemon (default $XDG_RUNTIME_DIR/spm-servo/NAME.sock)")
      ->type_name("FILE");
  cli::add_parsed(
      *app, "--server-user",
      [&trusted = feed.server_user](const std::string& text) -> Result<void> {
        const Result<std::uint32_t> user = user_id(text);
        if (!user) return tl::make_unexpected(user.error());
        trusted = *user;
        return {};
      },
      "User whose daemon is trusted, beside those of this user and of root: a name or an id",
      "USER");
  return {app, [command] { return execute_view(*command); }};
}

}  // namespace spm::servo
