// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iostream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

#include "baker/commands/commands.hpp"
#include "common/query/query.hpp"
#include "formats/asset/asset.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/cli/command_line.hpp"
#include "formats/files/output_file.hpp"
#include "formats/motion/trajectory.hpp"

namespace spm::baker {
namespace {

struct QuerySettings {
  std::string asset;
  std::string points;
  std::string output;
  cli::GlobalOptions global;
};

const char* name_of(Status status) {
  switch (status) {
    case Status::exact:
      return "exact";
    case Status::deep:
      return "deep";
    case Status::far:
      return "far";
    case Status::pruned:
      return "pruned";
  }
  return "far";
}

/// What a distance map is called: of a `full` asset a tile, of a `sparse` one by how many count.
const char* name_of_map(const AssetView& asset, const Vector3& point) {
  if (asset.full) return "tile";
  const std::uint32_t* words = words_at(asset.octree, leaf_at(asset.octree, point));
  return words != nullptr && NamedMaps(words[0]).two() ? "two-maps" : "map";
}

const char* name_of(Source source, const AssetView& asset, const Vector3& point) {
  switch (source) {
    case Source::map:
      return name_of_map(asset, point);
    case Source::triangles:
      return "triangles";
    case Source::none:
      return "none";
  }
  return "none";
}

/// A number that reads back as itself; `nan` has no sign.
std::string number(double value) { return std::isnan(value) ? "nan" : fmt::format("{}", value); }

void append_row(std::string& csv, const AssetView& asset, const Vector3& point,
                const Answer& answer) {
  for (const double value : {point.x(), point.y(), point.z(), answer.distance, answer.normal.x(),
                             answer.normal.y(), answer.normal.z()}) {
    csv += number(value) + ",";
  }
  fmt::format_to(std::back_inserter(csv), "{},{},{},{}\n", answer.plane, answer.layer,
                 name_of(answer.source, asset, point), name_of(answer.status));
}

int run(const QuerySettings& settings) {
  cli::configure_messages(settings.global);
  if (const auto writable = check_output_path(settings.output); !writable) {
    return cli::report(writable.error());
  }
  const auto asset = MappedAsset::open(settings.asset);
  if (!asset) return cli::report(asset.error());
  const auto points = read_trajectory(settings.points);
  if (!points) return cli::report(points.error());
  std::string csv = "x,y,z,distance,nx,ny,nz,plane,layer,source,status\n";
  std::array<std::uint64_t, 4> counts{};
  for (const TrajectorySample& sample : *points) {
    const Answer answer = query_point((*asset)->view(), sample.position);
    ++counts[static_cast<std::size_t>(answer.status)];
    append_row(csv, (*asset)->view(), sample.position, answer);
  }
  if (const auto written = write_file(settings.output, csv); !written) {
    return cli::report(written.error());
  }
  if (settings.global.json) {
    cli::print_json({{"output", settings.output},
                     {"points", points->size()},
                     {"exact", counts[0]},
                     {"deep", counts[1]},
                     {"far", counts[2]},
                     {"pruned", counts[3]}});
  } else if (!settings.global.quiet) {
    std::cout << fmt::format("{}: {} points: {} exact, {} deep, {} far, {} pruned\n",
                             settings.output, points->size(), counts[0], counts[1], counts[2],
                             counts[3]);
  }
  return 0;
}

}  // namespace

Command add_query_command(CLI::App& app) {
  auto settings = std::make_shared<QuerySettings>();
  CLI::App* command =
      app.add_subcommand("query", "Signed distance and normal at the points of a file, as CSV");
  command->add_option("FILE", settings->asset, "baked file")->required()->type_name("");
  command->add_option("--points", settings->points, "x y z a line, metres, in the asset's frame")
      ->required()
      ->type_name("POINTS.txt");
  command->add_option("-o,--output", settings->output, "file to write, one row a point")
      ->required()
      ->type_name("OUT.csv");
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
