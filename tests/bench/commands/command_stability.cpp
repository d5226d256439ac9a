// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>

#include "baker/base/bake_error.hpp"
#include "formats/cli/command_line.hpp"
#include "formats/files/nearest_word.hpp"
#include "formats/files/output_file.hpp"
#include "tests/bench/base/thread_limit.hpp"
#include "tests/bench/commands/commands.hpp"
#include "tests/stability/report/stability_report.hpp"
#include "tests/stability/report/stability_text.hpp"

namespace spm::bench {
namespace {

struct StabilitySettings {
  stability::StabilityPlan plan;
  std::vector<std::string> parts;
  std::string traces;
  bool quick = false;
  bool verbose = false;
  cli::GlobalOptions global;
};

/// A usage error for a name that is none of the valid ones, with the nearest of them.
void check_names(const std::string& option, const std::vector<std::string>& asked,
                 const std::vector<std::string>& names) {
  for (const std::string& name : asked) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    const auto near = cli::nearest_word(name, names);
    const std::string list = fmt::format("write one of {}", fmt::join(names, ", "));
    throw CLI::ValidationError(
        option, fmt::format("'{}' will not do: {}", name,
                            near ? fmt::format("did you mean {}? Or {}", *near, list) : list));
  }
}

/// Tells on stderr what is being measured, a line a phase and a quarter of it.
class PhaseLines {
 public:
  void tell(const std::string& what, double done) {
    const int quarter = static_cast<int>(4 * done);
    if (what == what_ && quarter == quarter_) return;
    what_ = what;
    quarter_ = quarter;
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - began_;
    std::string line = fmt::format("after {:.0f} s: {}", passed.count(), what);
    if (quarter > 0) line += fmt::format(", {} %", 25 * quarter);
    spdlog::info("{}", line);
  }

 private:
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::string what_;
  int quarter_ = 0;
};

stability::StabilityPlan plan_of(const StabilitySettings& settings) {
  stability::StabilityPlan plan = settings.plan;
  if (settings.quick) stability::make_quick(plan);
  stability::keep_parts(plan, settings.parts);
  return plan;
}

void write_traces(const std::string& folder, const stability::StabilityReport& report) {
  for (const stability::WorstTrace& worst : report.worst) {
    const auto path = std::filesystem::path(folder) / stability::trace_name(worst);
    const Result<void> written = write_file(path.string(), stability::to_csv(worst));
    if (!written) throw baker::BakeError(written.error().code, written.error().message);
  }
}

/// Methods that were asked for and take part in none of the cases that are tried.
std::vector<std::string> without_a_case(const stability::StabilityPlan& plan,
                                        const stability::StabilityReport& report) {
  std::vector<std::string> list;
  for (const std::string& method : plan.methods) {
    const auto is_of_it = [&](const auto& row) { return row.method == method; };
    if (std::any_of(report.cases.begin(), report.cases.end(), is_of_it)) continue;
    if (std::any_of(report.failures.begin(), report.failures.end(), is_of_it)) continue;
    list.push_back(method);
  }
  return list;
}

int run(const StabilitySettings& settings) {
  cli::configure_messages(settings.global);
  const stability::StabilityPlan plan = plan_of(settings);
  const auto limit = thread_limit(plan.threads);
  const stability::StabilityReport report =
      measured(settings.global, [&](const BenchProgress& progress) {
        PhaseLines lines;
        return stability::measure_stability(plan, [&](const std::string& what, double done) {
          progress(what, done);
          if (settings.verbose) lines.tell(what, done);
        });
      });
  for (const stability::StabilityFailure& failure : report.failures) {
    spdlog::warn("{}, {}: no row: {}", failure.name, failure.method, failure.reason);
  }
  const std::vector<std::string> without = without_a_case(plan, report);
  for (const std::string& method : without) {
    spdlog::warn(
        "--method {}: takes part in none of the chosen cases, so it has no row; leave --case out "
        "to "
        "see in which it does",
        method);
  }
  if (!settings.traces.empty()) write_traces(settings.traces, report);
  print_report(
      settings.global, [&] { return to_json(report, plan); },
      [&] { return to_text(report, plan); });
  const bool tried = !report.cases.empty() || !report.failures.empty();
  return static_cast<int>(without.empty() || tried ? ExitCode::done : ExitCode::usage);
}

void add_name_option(CLI::App& command, const std::string& option, std::vector<std::string>& names,
                     const std::string& what) {
  command.add_option(option, names, what)->allow_extra_args(false)->type_name("NAME");
}

}  // namespace

Command add_stability_command(CLI::App& app) {
  auto settings = std::make_shared<StabilitySettings>();
  CLI::App* command = app.add_subcommand(
      "stability", "Where methods fail: closed loops with a simulated device and hand");
  add_name_option(*command, "--case", settings->plan.cases,
                  "try this case only; may be repeated (default: the whole catalogue)");
  add_name_option(
      *command, "--method", settings->plan.methods,
      "try this method only; may be repeated (default: all); METHOD+STABILIZER for one with a "
      "stabilizer, default for the product's default");
  add_name_option(*command, "--device", settings->plan.devices,
                  "try this profile only; may be repeated (default: all five; low with --quick)");
  add_name_option(*command, "--part", settings->parts,
                  "beside cases and flat borders measure this part only, of " +
                      fmt::format("{}", fmt::join(stability::part_names(), ", ")) +
                      "; may be repeated (default: all; theory and maps with --quick)");
  command
      ->add_option("--traces", settings->traces,
                   "folder to write the run of each method's worst case to, a CSV a method")
      ->check(CLI::ExistingDirectory)
      ->type_name("FOLDER");
  add_seed_option(*command, settings->plan.seed, "noise and of the cases' seeds");
  add_threads_option(*command, settings->plan.threads, ", 1 to 1024; they change no figure");
  command->add_flag(
      "--quick", settings->quick,
      "some shapes on low, coarser bakes, fewer seeds and maps: under 45 s on two cores");
  command->add_flag("-v,--verbose", settings->verbose,
                    "tell on stderr what is being measured, a line a phase");
  cli::add_global_options(*command, settings->global);
  command->callback([settings] {
    check_names("--case", settings->plan.cases, stability::case_names());
    check_names("--method", settings->plan.methods, stability::method_names());
    check_names("--device", settings->plan.devices, stability::device_names());
    check_names("--part", settings->parts, stability::part_names());
  });
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::bench
