// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>

#include "formats/cli/command_line.hpp"
#include "tests/bench/commands/commands.hpp"
#include "tests/bench/model/known_meshes.hpp"
#include "tests/bench/reports/row_text.hpp"
#include "tests/bench/reports/times.hpp"
#include "tests/bench/reports/times_text.hpp"

namespace spm::bench {
namespace {

struct MethodsSettings {
  TimesPlan plan;
  std::vector<std::string> meshes;
  std::optional<double> tolerance;
  bool quick = false;
  std::uint64_t samples = 0;  ///< 0: the mode's own
  cli::GlobalOptions global;
};

/// Of the table those that differ most: scanned parts that overlap, a fine scan, smooth, sharp,
/// thin.
const std::vector<KnownMesh> timed_meshes{{"teeth", 50e-6},
                                          {"stanford-bunny", 100e-6},
                                          {"duck", 100e-6},
                                          {"fandisk", 20e-6},
                                          {"galleon", 100e-6}};
const std::vector<KnownMesh> quick_meshes{{"duck", 100e-6}};

std::vector<ModelSource> models_of(const MethodsSettings& settings) {
  if (!settings.meshes.empty()) return sources_of(settings.meshes, settings.tolerance);
  return sources_of(settings.quick ? quick_meshes : timed_meshes, settings.tolerance);
}

TimesPlan plan_of(const MethodsSettings& settings) {
  TimesPlan plan = settings.plan;
  plan.models = models_of(settings);
  if (settings.quick) {
    // A bake of a large mesh takes a third of the time there is: none but the mesh's own tolerance.
    plan.tolerances = {};
    plan.adaptive_tolerances = {400e-6};
    plan.voxels = {0.5e-3};
    plan.nano_voxels = {NanoVoxel::fixed8};
    plan.grid_cells = {2e-3};
    plan.paper_planes = 200;
    plan.scalar = false;
    plan.samples = 20000;
    plan.path_steps = 1024;
    plan.timing = {7, 0.004, 20};
  } else {
    plan.tolerances = {25e-6, 50e-6, 100e-6, 200e-6};
    plan.adaptive_tolerances = {50e-6, 100e-6, 200e-6};
    plan.voxels = {1e-3, 0.5e-3, 0.25e-3, 0.125e-3};
    plan.nano_voxels = {NanoVoxel::float32, NanoVoxel::fixed16, NanoVoxel::fixed8,
                        NanoVoxel::variable};
    plan.grid_cells = {2e-3, 1e-3, 0.6e-3};
  }
  if (settings.samples > 0) plan.samples = settings.samples;
  return plan;
}

int run(const MethodsSettings& settings) {
  cli::configure_messages(settings.global);
  const TimesPlan plan = plan_of(settings);
  const TimesReport report = measured(settings.global, [&plan](const BenchProgress& progress) {
    return measure_times(plan, progress);
  });
  warn_of(report.failures);
  print_report(
      settings.global, [&] { return to_json(report, plan); }, [&] { return to_text(report); });
  return 0;
}

}  // namespace

Command add_methods_command(CLI::App& app) {
  auto settings = std::make_shared<MethodsSettings>();
  CLI::App* command = app.add_subcommand(
      "methods", "Error against time of every method, at the same places, on one core");
  add_mesh_option(*command, settings->meshes, "five");
  cli::add_quantity(*command, "--tolerance", settings->tolerance, Quantity::length,
                    "at which spm is compared, above 0 (default: the table's, or 100 um)");
  add_method_option(*command, settings->plan.methods);
  cli::add_integer(
      *command, "--samples", 1, 100000000, [settings](std::uint64_t n) { settings->samples = n; },
      "places to measure errors at, 1 to 100000000 (default 100000; 20000 with --quick)");
  add_seed_option(*command, settings->plan.seed, "places and path");
  add_threads_option(*command, settings->plan.threads,
                     " that build and score, 1 to 1024; timing takes one");
  add_bakes_option(*command, settings->plan.bakes);
  command->add_flag("--quick", settings->quick,
                    "one small mesh, and fewer settings and places: under 45 s on two cores");
  cli::add_global_options(*command, settings->global);
  command->callback([settings] {
    check_tolerance(settings->tolerance);
    check_methods(settings->plan.methods, timed_method_names());
  });
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::bench
