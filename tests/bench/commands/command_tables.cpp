// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>

#include "formats/cli/command_line.hpp"
#include "tests/bench/commands/commands.hpp"
#include "tests/bench/model/known_meshes.hpp"
#include "tests/bench/reports/row_text.hpp"
#include "tests/bench/reports/tables.hpp"
#include "tests/bench/reports/tables_text.hpp"

namespace spm::bench {
namespace {

struct TablesSettings {
  bool quick = false;
  unsigned threads = 0;
  cli::GlobalOptions global;
};

/// The paper's models, planes and figures (its section 5.2, Tables 2 and 3).
std::vector<SlidSource> slides(bool quick) {
  const std::vector<ModelSource> models =
      sources_of(std::vector<KnownMesh>{{"galleon", quick ? 200e-6 : 100e-6},
                                        {"teeth", quick ? 200e-6 : 50e-6}},
                 std::nullopt);
  const std::filesystem::path folder = std::filesystem::path(shared_folder()) / "trajectories";
  return {{2, models[0], (folder / "galleon-slide.txt").string(), 1000, {1200, 220}, {28, 6}},
          {3, models[1], (folder / "teeth-slide.txt").string(), 1500, {4200, 820}, {36, 5}}};
}

TablesPlan plan_of(const TablesSettings& settings) {
  TablesPlan plan;
  plan.threads = settings.threads;
  plan.slides = slides(settings.quick);
  if (settings.quick) {
    plan.subdivisions = {3, 4};
    plan.plane_counts = {100, 1000};
    plan.paper_resolution = 17;
    plan.slide_steps = 300;
    plan.max_ticks = 3000;
    plan.scaling_tolerance = 400e-6;
    plan.timing = {5, 0.5, 2};
  } else {
    plan.subdivisions = {4, 5, 6, 7, 8};
    plan.plane_counts = {100, 300, 1000, 3000};
  }
  return plan;
}

int run(const TablesSettings& settings) {
  cli::configure_messages(settings.global);
  const TablesPlan plan = plan_of(settings);
  const TablesReport report = measured(settings.global, [&plan](const BenchProgress& progress) {
    return measure_tables(plan, progress);
  });
  warn_of(report.failures);
  print_report(
      settings.global, [&] { return to_json(report); }, [&] { return to_text(report); });
  return 0;
}

}  // namespace

Command add_tables_command(CLI::App& app) {
  auto settings = std::make_shared<TablesSettings>();
  CLI::App* command = app.add_subcommand(
      "tables", "The paper's Tables 1 to 3 measured: time of a force, on its recorded slides");
  add_threads_option(*command, settings->threads, " that bake, 1 to 1024; timing takes one");
  command->add_flag("--quick", settings->quick,
                    "coarser bakes, fewer counts and ticks: under 45 s on two cores");
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::bench
