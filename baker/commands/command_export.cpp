// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "baker/base/bake_error.hpp"
#include "baker/commands/commands.hpp"
#include "baker/pictures/export.hpp"
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
  bool text = false;
  cli::GlobalOptions global;
};

int run(const ExportSettings& settings) {
  cli::configure_messages(settings.global);
  if (const auto writable = check_output_path(settings.output); !writable) {
    return cli::report(writable.error());
  }
  const auto asset = MappedAsset::open(settings.asset, {.tiles = true});
  if (!asset) return cli::report(asset.error());
  const KnownSurface surface = known_surface((*asset)->view());
  if (const auto written = write_file(settings.output, to_ply(surface, settings.text)); !written) {
    return cli::report(written.error());
  }
  if (settings.global.json) {
    cli::print_json({{"output", settings.output},
                     {"vertices", surface.vertices.size()},
                     {"triangles", surface.triangles.size()}});
  } else if (!settings.global.quiet) {
    std::cout << fmt::format("{}: {} vertices, {} triangles\n", settings.output,
                             surface.vertices.size(), surface.triangles.size());
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
  command->add_flag("--ascii", settings->text, "write a PLY of text (default binary)");
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
