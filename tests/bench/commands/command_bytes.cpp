// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "baker/base/bake_error.hpp"
#include "formats/cli/command_line.hpp"
#include "tests/bench/commands/commands.hpp"
#include "tests/bench/model/known_meshes.hpp"
#include "tests/bench/reports/bytes.hpp"
#include "tests/bench/reports/bytes_text.hpp"
#include "tests/bench/reports/row_text.hpp"

namespace spm::bench {
namespace {

struct BytesSettings {
  BytesPlan plan;
  std::vector<std::string> meshes;
  std::optional<double> tolerance;
  bool quick = false;
  std::uint64_t samples = 0;  ///< 0: the mode's own
  cli::GlobalOptions global;
};

/// What --quick takes: the smallest with curves, and one with edges.
const std::vector<KnownMesh> quick_meshes{{"duck", 100e-6}, {"fandisk", 100e-6}};

std::vector<ModelSource> models_of(const BytesSettings& settings) {
  if (!settings.meshes.empty()) return sources_of(settings.meshes, settings.tolerance);
  return sources_of(settings.quick ? quick_meshes : known_meshes(), settings.tolerance);
}

BytesPlan plan_of(const BytesSettings& settings) {
  BytesPlan plan = settings.plan;
  plan.models = models_of(settings);
  plan.grid_cells = {2e-3, 1e-3};
  if (settings.quick) {
    plan.tolerances = {200e-6};
    plan.grid_cells = {2e-3};
    plan.voxels = {1e-3, 0.5e-3};
    plan.samples = 20000;
  } else {
    plan.tolerances = {25e-6, 50e-6, 100e-6, 200e-6, 400e-6};
    plan.voxels = {1e-3, 0.5e-3, 0.25e-3};
  }
  if (settings.samples > 0) plan.samples = settings.samples;
  return plan;
}

int run(const BytesSettings& settings) {
  cli::configure_messages(settings.global);
  const BytesPlan plan = plan_of(settings);
  const BytesReport report = measured(settings.global, [&plan](const BenchProgress& progress) {
    return measure_bytes(plan, progress);
  });
  warn_of(report.failures);
  print_report(
      settings.global, [&] { return to_json(report); }, [&] { return to_text(report); });
  return 0;
}

}  // namespace

Command add_bytes_command(CLI::App& app) {
  auto settings = std::make_shared<BytesSettings>();
  CLI::App* command = app.add_subcommand(
      "bytes", "Error against bytes of every method, on one equal set of places");
  add_mesh_option(*command, settings->meshes, "the seven");
  cli::add_quantity(*command, "--tolerance", settings->tolerance, Quantity::length,
                    "at which the methods are compared, above 0 (default: the table's, or 100 um)");
  add_method_option(*command, settings->plan.methods);
  cli::add_integer(
      *command, "--samples", 1, 100000000, [settings](std::uint64_t n) { settings->samples = n; },
      "places to measure at, 1 to 100000000 (default 100000; 20000 with --quick)");
  add_seed_option(*command, settings->plan.seed, "the places");
  add_threads_option(*command, settings->plan.threads,
                     ", 1 to 1024; all but seconds is the same for any");
  add_bakes_option(*command, settings->plan.bakes);
  command->add_flag("--quick", settings->quick,
                    "two small meshes, and fewer settings and places: under 45 s on two cores");
  cli::add_global_options(*command, settings->global);
  command->callback([settings] {
    check_tolerance(settings->tolerance);
    check_methods(settings->plan.methods, method_names());
  });
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::bench
