// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>

#include "baker/bake_error.hpp"
#include "formats/cli/command_line.hpp"
#include "tests/bench/bytes.hpp"
#include "tests/bench/bytes_text.hpp"
#include "tests/bench/commands.hpp"

namespace spm::bench {
namespace {

struct Settings {
  BytesPlan plan;
  std::vector<std::string> meshes;
  std::optional<double> tolerance;
  bool quick = false;
  std::uint64_t samples = 0;  ///< 0: the mode's own
  cli::GlobalOptions global;
};

struct KnownMesh {
  const char* name;
  double tolerance;  ///< m
};

/// The meshes of the project's table, at the tolerances that it gives.
constexpr std::array known_meshes{
    KnownMesh{"duck", 100e-6},       KnownMesh{"spot", 100e-6},
    KnownMesh{"rocker-arm", 100e-6}, KnownMesh{"stanford-bunny", 100e-6},
    KnownMesh{"galleon", 100e-6},    KnownMesh{"fandisk", 20e-6},
    KnownMesh{"teeth", 50e-6}};
/// What --quick takes of them: the smallest with curves, and one with edges.
constexpr std::array quick_meshes{KnownMesh{"duck", 100e-6}, KnownMesh{"fandisk", 100e-6}};

std::filesystem::path shared_meshes() {
  const char* folder = std::getenv("SPM_SHARED");
  std::filesystem::path meshes =
      std::filesystem::path(folder != nullptr && *folder != '\0' ? folder : SPM_SHARED_FOLDER) /
      "meshes";
  if (!std::filesystem::is_directory(meshes)) {
    throw baker::BakeError(ExitCode::file_or_device,
                           meshes.string() +
                               ": no such folder; name the folder of shared meshes by SPM_SHARED, "
                               "or give --mesh");
  }
  return meshes;
}

std::vector<ModelSource> models_of(const Settings& settings) {
  std::vector<ModelSource> models;
  for (const std::string& mesh : settings.meshes) {
    models.push_back({std::filesystem::path(mesh).stem().string(), mesh,
                      settings.tolerance.value_or(bench_diagonal / 1000)});
  }
  if (!models.empty()) return models;
  const std::filesystem::path folder = shared_meshes();
  const auto add = [&](const KnownMesh& mesh) {
    models.push_back({mesh.name, (folder / (std::string(mesh.name) + ".obj")).string(),
                      settings.tolerance.value_or(mesh.tolerance)});
  };
  if (settings.quick) {
    std::for_each(quick_meshes.begin(), quick_meshes.end(), add);
  } else {
    std::for_each(known_meshes.begin(), known_meshes.end(), add);
  }
  return models;
}

BytesPlan plan_of(const Settings& settings) {
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

int run(const Settings& settings) {
  cli::configure_messages(settings.global);
  const BytesPlan plan = plan_of(settings);
  BytesReport report;
  {
    cli::ProgressLine line(settings.global);
    report = measure_bytes(
        plan, [&line](const std::string& what, double done) { line.update(what.c_str(), done); });
  }
  for (const FailureRow& failure : report.failures) {
    spdlog::warn("{}, {}: no row: {}", failure.model, failure.method, failure.reason);
  }
  if (settings.global.json) {
    cli::print_json(to_json(report));
  } else if (!settings.global.quiet) {
    std::cout << to_text(report);
  }
  return 0;
}

void check(const Settings& settings) {
  if (settings.tolerance && *settings.tolerance <= 0) {
    throw CLI::ValidationError("--tolerance", "must be above 0");
  }
  const std::vector<std::string>& names = method_names();
  for (const std::string& method : settings.plan.methods) {
    if (std::find(names.begin(), names.end(), method) != names.end()) continue;
    throw CLI::ValidationError("--method", fmt::format("'{}' will not do: write one of {}", method,
                                                       fmt::join(names, ", ")));
  }
}

}  // namespace

Command add_bytes_command(CLI::App& app) {
  auto settings = std::make_shared<Settings>();
  CLI::App* command = app.add_subcommand(
      "bytes", "Error against bytes of every method, on one equal set of places");
  command
      ->add_option("--mesh", settings->meshes,
                   "mesh to measure on, scaled to a diagonal of 100 mm; may be repeated (default: "
                   "the seven of the table, from the folder that SPM_SHARED names)")
      ->allow_extra_args(false)
      ->type_name("FILE");
  cli::add_quantity(*command, "--tolerance", settings->tolerance, Quantity::length,
                    "at which the methods are compared, above 0 (default: the table's, or 100 um)");
  command
      ->add_option("--method", settings->plan.methods,
                   "measure this one only; may be repeated (default: all)")
      ->allow_extra_args(false)
      ->type_name("NAME");
  cli::add_integer(
      *command, "--samples", 1, 100000000, [settings](std::uint64_t n) { settings->samples = n; },
      "places to measure at, 1 to 100000000 (default 100000; 20000 with --quick)");
  cli::add_integer(
      *command, "--seed", 0, std::numeric_limits<std::uint64_t>::max(),
      [settings](std::uint64_t n) { settings->plan.seed = n; }, "seed of the places (default 1)");
  cli::add_integer(
      *command, "--threads", 1, 1024,
      [settings](std::uint64_t n) { settings->plan.threads = static_cast<unsigned>(n); },
      "threads, 1 to 1024; all but seconds is the same for any (default: all cores)");
  command->add_flag("--quick", settings->quick,
                    "two small meshes, and fewer settings and places: under 45 s on two cores");
  cli::add_global_options(*command, settings->global);
  command->callback([settings] { check(*settings); });
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::bench
