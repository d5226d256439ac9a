// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

#include "baker/base/bake_error.hpp"
#include "baker/commands/commands.hpp"
#include "baker/pictures/export.hpp"
#include "common/base/units.hpp"
#include "common/contour/contour_mesh.hpp"
#include "common/contour/surface_box.hpp"
#include "formats/asset/asset.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/cli/command_line.hpp"
#include "formats/files/output_file.hpp"

namespace spm::baker {
namespace {

struct ExportSettings {
  std::string asset;
  std::string output;
  std::optional<double> cell;  ///< m
  bool text = false;
  cli::GlobalOptions global;
};

/// Cells along the longest edge, of the grid of the mesh: as many as are useful, and as many as
/// memory holds.
constexpr int chosen_cells = 240, most_cells = 500;

/// Cells of the asked edge along the longest one.
int cells_of(const AssetView& view, double cell) {
  const double longest = surface_box(view).size.maxCoeff();
  if (!(longest / cell <= most_cells)) {
    throw BakeError(ExitCode::usage,
                    fmt::format("--cell: the surface is {} wide, so it must be at least {}",
                                format_quantity(longest, Quantity::length),
                                format_quantity(longest / most_cells, Quantity::length)));
  }
  return std::max(1, static_cast<int>(std::ceil(longest / cell)));
}

int run(const ExportSettings& settings) {
  cli::configure_messages(settings.global);
  if (const auto writable = check_output_path(settings.output); !writable) {
    return cli::report(writable.error());
  }
  const auto asset = MappedAsset::open(settings.asset);
  if (!asset) return cli::report(asset.error());
  const AssetView& view = (*asset)->view();
  const ContourMesh surface =
      contour_mesh(view, settings.cell ? cells_of(view, *settings.cell) : chosen_cells);
  if (const auto written = write_file(settings.output, to_ply(surface, settings.text)); !written) {
    return cli::report(written.error());
  }
  if (settings.global.json) {
    cli::print_json({{"output", settings.output},
                     {"vertices", surface.vertices.size()},
                     {"triangles", surface.triangles.size() / 3},
                     {"cell_m", surface.cell}});
  } else if (!settings.global.quiet) {
    std::cout << fmt::format("{}: {} vertices, {} triangles\n", settings.output,
                             surface.vertices.size(), surface.triangles.size() / 3);
  }
  return 0;
}

}  // namespace

Command add_export_command(CLI::App& app) {
  auto settings = std::make_shared<ExportSettings>();
  CLI::App* command =
      app.add_subcommand("export", "Writes the surface as an asset knows it, for any viewer");
  command->add_option("FILE", settings->asset, "baked file")->required()->type_name("");
  command->add_option("-o,--output", settings->output, "mesh to write")
      ->required()
      ->type_name("SURFACE.ply");
  cli::add_quantity(*command, "--cell", settings->cell, Quantity::length,
                    "edge of the cells of the grid that the surface is found on, at least 1/500 of "
                    "the longest edge of its box (default 1/240)");
  command->add_flag("--ascii", settings->text, "write a PLY of text (default binary)");
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
