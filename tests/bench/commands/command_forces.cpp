// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "formats/cli/command_line.hpp"
#include "formats/files/output_file.hpp"
#include "tests/bench/base/unwrap.hpp"
#include "tests/bench/commands/commands.hpp"
#include "tests/bench/model/known_meshes.hpp"
#include "tests/bench/reports/forces.hpp"
#include "tests/bench/reports/forces_text.hpp"
#include "tests/bench/reports/row_text.hpp"

namespace spm::bench {
namespace {

struct ForcesSettings {
  ForcesPlan plan;
  std::vector<std::string> meshes;
  std::optional<double> tolerance;
  std::string traces;
  bool quick = false;
  std::uint64_t ticks = 0;  ///< 0: the mode's own
  cli::GlobalOptions global;
};

/// The models with a recorded slide, and the paper's counts of planes on them; the first alone is
/// quick.
std::vector<ForceSource> recorded_sources(const ForcesSettings& settings) {
  std::vector<KnownMesh> meshes{{"teeth", settings.quick ? 400e-6 : 50e-6}};
  if (!settings.quick) meshes.push_back({"galleon", 100e-6});
  const std::vector<std::size_t> planes{1500, 1000};
  const std::filesystem::path folder = std::filesystem::path(shared_folder()) / "trajectories";
  std::vector<ForceSource> sources;
  for (ModelSource& model : sources_of(meshes, settings.tolerance)) {
    std::string slide = (folder / (model.name + "-slide.txt")).string();
    sources.push_back({std::move(model), std::move(slide), planes[sources.size()]});
  }
  return sources;
}

ForcesPlan plan_of(const ForcesSettings& settings) {
  ForcesPlan plan = settings.plan;
  if (settings.meshes.empty()) {
    plan.sources = recorded_sources(settings);
  } else {
    for (ModelSource& model : sources_of(settings.meshes, settings.tolerance)) {
      plan.sources.push_back({std::move(model), {}, 1000});
    }
  }
  if (settings.quick) {
    plan.paper_resolution = 17;
    plan.max_ticks = 3000;
    plan.walked_ticks = 2000;
  }
  if (settings.ticks > 0) plan.max_ticks = plan.walked_ticks = settings.ticks;
  return plan;
}

void write_traces(const std::string& folder, const ForcesReport& report, const ForcesPlan& plan) {
  for (const ForceTrace& trace : report.traces) {
    const std::string name = fmt::format("{}-{}.csv", trace.model, trace.path.name);
    const Result<void> written =
        write_file((std::filesystem::path(folder) / name).string(), to_csv(trace, plan));
    if (!written) throw baker::BakeError(written.error().code, written.error().message);
  }
}

int run(const ForcesSettings& settings) {
  cli::configure_messages(settings.global);
  const ForcesPlan plan = plan_of(settings);
  const ForcesReport report = measured(settings.global, [&plan](const BenchProgress& progress) {
    return measure_forces(plan, progress);
  });
  warn_of(report.failures);
  if (!settings.traces.empty()) write_traces(settings.traces, report, plan);
  print_report(
      settings.global, [&] { return to_json(report, plan); }, [&] { return to_text(report); });
  return 0;
}

}  // namespace

Command add_forces_command(CLI::App& app) {
  auto settings = std::make_shared<ForcesSettings>();
  CLI::App* command = app.add_subcommand(
      "forces", "Forces along slides, recorded and walked, beside the exact mesh's penalty");
  add_mesh_option(*command, settings->meshes, "teeth and galleon, with their recorded slides,");
  cli::add_quantity(*command, "--tolerance", settings->tolerance, Quantity::length,
                    "of the bakes, above 0 (default: the table's, or 100 um)");
  command
      ->add_option("--traces", settings->traces,
                   "folder to write the forces of every tick to, a CSV a mesh and path")
      ->check(CLI::ExistingDirectory)
      ->type_name("FOLDER");
  cli::add_integer(
      *command, "--ticks", 100, 10000000, [settings](std::uint64_t n) { settings->ticks = n; },
      "of a path, 100 to 10000000 (default 20000; 3000 and 2000 with --quick)");
  add_seed_option(*command, settings->plan.seed, "the walked slides");
  add_threads_option(*command, settings->plan.threads, ", 1 to 1024; they change no figure");
  command->add_flag("--quick", settings->quick,
                    "teeth alone, a coarser bake and fewer ticks: under 45 s on two cores");
  cli::add_global_options(*command, settings->global);
  command->callback([settings] { check_tolerance(settings->tolerance); });
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::bench
