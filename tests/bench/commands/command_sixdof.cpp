// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>
#include <optional>

#include "formats/cli/command_line.hpp"
#include "tests/bench/commands/commands.hpp"
#include "tests/bench/model/known_meshes.hpp"
#include "tests/bench/sixdof/sixdof.hpp"
#include "tests/bench/sixdof/sixdof_text.hpp"

namespace spm::bench {
namespace {

struct SixdofSettings {
  SixdofPlan plan;
  std::optional<double> tolerance;
  bool quick = false;
  std::uint64_t ticks = 0, samples = 0;  ///< 0: the mode's own
  cli::GlobalOptions global;
};

std::string shared_mesh(const char* name) {
  return (std::filesystem::path(shared_folder()) / "meshes" / name).string();
}

SixdofPlan plan_of(const SixdofSettings& settings) {
  SixdofPlan plan = settings.plan;
  if (plan.tool.empty()) plan.tool = shared_mesh("drill.obj");
  if (plan.object.empty()) plan.object = shared_mesh("teeth.obj");
  plan.samples = {2000, 8000, 30000, 120000, 1000000};
  if (settings.quick) {
    plan.samples = {2000, 30000};
    plan.ticks = 1000;
    plan.tool_tolerance = plan.tolerance = 1e-4;
    plan.peer_ticks = 100;
    plan.judged = 20;
    plan.judged_deep = 10;
    plan.reference_radius = 1e-4;
    plan.culled_objects = 100;
  }
  if (settings.tolerance) plan.tolerance = *settings.tolerance;
  if (settings.samples > 0) plan.samples = {settings.samples};
  if (settings.ticks > 0) plan.ticks = settings.ticks;
  return plan;
}

int run(const SixdofSettings& settings) {
  cli::configure_messages(settings.global);
  const SixdofPlan plan = plan_of(settings);
  const SixdofReport report = measured(settings.global, [&plan](const BenchProgress& progress) {
    return measure_sixdof(plan, progress);
  });
  print_report(
      settings.global, [&] { return to_json(report); }, [&] { return to_text(report); });
  return 0;
}

}  // namespace

Command add_sixdof_command(CLI::App& app) {
  auto settings = std::make_shared<SixdofSettings>();
  CLI::App* command =
      app.add_subcommand("sixdof", "Force on an object that slides over another, and its time");
  command
      ->add_option("--tool", settings->plan.tool,
                   "mesh that moves, scaled to a diagonal of 60 mm (default: the shared drill)")
      ->type_name("FILE");
  command
      ->add_option("--mesh", settings->plan.object,
                   "mesh that stands still, scaled to 100 mm (default: the shared teeth)")
      ->type_name("FILE");
  cli::add_quantity(*command, "--tolerance", settings->tolerance, Quantity::length,
                    "of the mesh's asset, above 0 (default 50um; 100um with --quick)");
  cli::add_integer(
      *command, "--samples", 100, 4000000, [settings](std::uint64_t n) { settings->samples = n; },
      "samples of the tool, about, 100 to 4000000 (default: 2000 to 1000000 in five steps; 2000 "
      "and "
      "30000 with --quick)");
  cli::add_integer(
      *command, "--ticks", 1, 10000000, [settings](std::uint64_t n) { settings->ticks = n; },
      "ticks of the path, 1 to 10000000 (default 5000; 1000 with --quick)");
  add_seed_option(*command, settings->plan.seed, "the path");
  command->add_flag("--quick", settings->quick, "fewer samples and ticks: under 45 s on two cores");
  cli::add_global_options(*command, settings->global);
  command->callback([settings] { check_tolerance(settings->tolerance); });
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::bench
