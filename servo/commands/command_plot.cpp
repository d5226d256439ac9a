// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "formats/files/output_file.hpp"
#include "formats/motion/recording.hpp"
#include "servo/commands/child_program.hpp"
#include "servo/commands/tool_commands.hpp"

namespace spm::servo {

namespace {

namespace fs = std::filesystem;

constexpr const char* script_name = "plot_recording.py";
/// Succeeds if the packages that the script needs are installed, without loading any of them.
constexpr const char* check_for_packages =
    "import importlib.util as u, sys; "
    "sys.exit(None in (u.find_spec('matplotlib'), u.find_spec('numpy')))";

struct PlotCommand {
  cli::GlobalOptions global;
  std::string recording, out;
  double device = 0;
};

/// The Python that can draw: the one of the search path, or else the system's, for which Debian
/// installs its packages.
Result<std::string> find_python() {
  bool found = false;
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    const int code = run_child({python, "-c", check_for_packages}, ChildOutput::dropped);
    if (code == 0) return std::string(python);
    found = found || code != program_not_found;
  }
  return fail(ExitCode::file_or_device,
              found ? "matplotlib is not installed for python3, which draws: install the package "
                      "python3-matplotlib"
                    : "python3, which draws, was not found: install the packages python3 and "
                      "python3-matplotlib");
}

/// The script beside the installed program, or else in the source tree.
Result<std::string> find_script() {
  std::error_code problem;
  const fs::path program = fs::read_symlink("/proc/self/exe", problem);
  const fs::path installed =
      program.parent_path().parent_path() / "share" / "spm-haptics" / script_name;
  for (const fs::path& path : {installed, fs::path(SPM_SCRIPTS) / script_name}) {
    if (fs::is_regular_file(path, problem)) return path.string();
  }
  return fail(ExitCode::file_or_device,
              installed.string() +
                  ": the script that draws is missing; install the project's scripts again");
}

/// A folder that is removed at the end, with its contents.
class TemporaryFolder {
 public:
  /// Makes the folder beside a file, so that a file in it can be renamed into place. The path is
  /// empty if that fails.
  explicit TemporaryFolder(const fs::path& beside)
      : path_((beside.parent_path() / ".spm-plot-XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) path_.clear();
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  std::string path_;
};

/// Checks in advance what would fail later. Returns the path to draw to.
Result<fs::path> check(const PlotCommand& command) {
  const fs::path out = command.out.empty() ? fs::path(command.recording).replace_extension(".svg")
                                           : fs::path(command.out);
  if (out.extension() != ".svg" && out.extension() != ".png") {
    return fail(ExitCode::usage,
                out.string() + ": a drawing's name ends in .svg or .png; name it so");
  }
  const auto recording = read_recording(command.recording);
  if (!recording) return tl::make_unexpected(recording.error());
  const std::size_t devices = recording->header.devices.size();
  if (command.device != std::floor(command.device) ||
      command.device >= static_cast<double>(devices)) {
    return fail(ExitCode::usage,
                fmt::format("--device-number {}: {} is of {} device{}, counted "
                            "from 0",
                            command.device, command.recording, devices, devices == 1 ? "" : "s"));
  }
  const bool has_ticks =
      std::any_of(recording->rows.begin(), recording->rows.end(),
                  [&](const RecordingRow& row) { return row.device == command.device; });
  if (!has_ticks) {
    return fail(ExitCode::invalid_input,
                fmt::format("{}: has no tick of device {} to draw; record a longer run",
                            command.recording, command.device));
  }
  // Creating a temporary file beside it is the only check that works on every kind of file system.
  auto writable = OutputFile::create(out.string());
  if (!writable) return tl::make_unexpected(std::move(writable.error()));
  return out;
}

/// Returns the exit code of the drawing program.
Result<int> plot(const PlotCommand& command, const fs::path& out) {
  const auto python = find_python();
  if (!python) return tl::make_unexpected(python.error());
  const auto script = find_script();
  if (!script) return tl::make_unexpected(script.error());
  const TemporaryFolder folder(out);
  if (folder.path().empty()) {
    return fail(ExitCode::file_or_device, out.string() + ": no folder can be made beside it (" +
                                              std::strerror(errno) + "); choose another place");
  }
  const fs::path prefix = fs::path(folder.path()) / "plot";
  // Without -B, Python would leave compiled scripts in the folder.
  const int code =
      run_child({*python, "-B", *script, "--device-number", fmt::format("{}", command.device), "-o",
                 prefix.string(), "--", command.recording},
                ChildOutput::shown);
  if (code != 0) return code;
  std::error_code problem;
  fs::rename(prefix.string() + out.extension().string(), out, problem);
  if (problem) {
    return fail(ExitCode::file_or_device, out.string() + ": could not be written (" +
                                              problem.message() + "); choose another place");
  }
  return code;
}

int execute(const PlotCommand& command) {
  cli::configure_messages(command.global);
  const auto out = check(command);
  if (!out) return cli::report(out.error());
  const auto code = plot(command, *out);
  if (!code) return cli::report(code.error());
  if (*code != 0) return *code;
  if (command.global.json) {
    cli::print_json({{"recording", command.recording}, {"out", out->string()}});
  } else if (!command.global.quiet) {
    fmt::print("drawn to {}\n", out->string());
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace

void add_plot_command(CLI::App& program, Action& action) {
  auto command = std::make_shared<PlotCommand>();
  CLI::App* app = program.add_subcommand(
      "plot", "Draw a recording: forces, depth, the loop's times, and why the force was off");
  cli::add_global_options(*app, command->global);
  app->add_option("recording", command->recording,
                  "What run --record wrote, or the black box after a fault")
      ->type_name("RECORDING")
      ->required();
  app->add_option("out", command->out,
                  "Drawing to write, .svg or .png (default: beside the recording, .svg)")
      ->type_name("OUT");
  add_number(*app, "--device-number", 0, 65535, command->device,
             "Which device, counted from 0 (default 0)")
      ->type_name("N");
  app->callback([command, &action] { action = [command] { return execute(*command); }; });
}

}  // namespace spm::servo
