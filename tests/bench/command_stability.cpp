// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "baker/bake_error.hpp"
#include "formats/cli/command_line.hpp"
#include "formats/cli/nearest_word.hpp"
#include "formats/output_file.hpp"
#include "tests/bench/commands.hpp"
#include "tests/bench/thread_limit.hpp"
#include "tests/stability/stability_report.hpp"
#include "tests/stability/stability_text.hpp"

namespace spm::bench {
namespace {

struct Settings {
  stability::StabilityPlan plan;
  std::string traces;
  bool quick = false;
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

stability::StabilityPlan plan_of(const Settings& settings) {
  stability::StabilityPlan plan = settings.plan;
  if (settings.quick) stability::make_quick(plan);
  return plan;
}

void write_traces(const std::string& folder, const stability::StabilityReport& report) {
  for (const stability::WorstTrace& worst : report.worst) {
    const auto path = std::filesystem::path(folder) / stability::trace_name(worst);
    const Result<void> written = write_file(path.string(), stability::to_csv(worst));
    if (!written) throw baker::BakeError(written.error().code, written.error().message);
  }
}

int run(const Settings& settings) {
  cli::configure_messages(settings.global);
  const stability::StabilityPlan plan = plan_of(settings);
  const auto limit = thread_limit(plan.threads);
  const stability::StabilityReport report =
      measured(settings.global, [&plan](const BenchProgress& progress) {
        return stability::measure_stability(plan, progress);
      });
  for (const stability::StabilityFailure& failure : report.failures) {
    spdlog::warn("{}, {}: no row: {}", failure.name, failure.method, failure.reason);
  }
  if (!settings.traces.empty()) write_traces(settings.traces, report);
  print_report(
      settings.global, [&] { return to_json(report, plan); },
      [&] { return to_text(report, plan); });
  return 0;
}

void add_name_option(CLI::App& command, const std::string& option, std::vector<std::string>& names,
                     const std::string& what) {
  command.add_option(option, names, what)->allow_extra_args(false)->type_name("NAME");
}

}  // namespace

Command add_stability_command(CLI::App& app) {
  auto settings = std::make_shared<Settings>();
  CLI::App* command = app.add_subcommand(
      "stability", "Where methods fail: closed loops with a simulated device and hand");
  add_name_option(*command, "--case", settings->plan.cases,
                  "try this case only; may be repeated (default: the whole catalogue)");
  add_name_option(
      *command, "--method", settings->plan.methods,
      "try this method only; may be repeated (default: all); METHOD+CURE for one with a "
      "cure, default for the product's default");
  add_name_option(*command, "--device", settings->plan.devices,
                  "try this profile only; may be repeated (default: all five; low with --quick)");
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
  cli::add_global_options(*command, settings->global);
  command->callback([settings] {
    check_names("--case", settings->plan.cases, stability::case_names());
    check_names("--method", settings->plan.methods, stability::method_names());
    check_names("--device", settings->plan.devices, stability::device_names());
  });
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::bench
