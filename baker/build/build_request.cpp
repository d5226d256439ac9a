// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/build/build_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>

#include "common/base/device_profile.hpp"
#include "common/base/units.hpp"
#include "formats/cli/command_line.hpp"

namespace spm::baker {
namespace {

constexpr std::uint32_t max_layers = 255;
constexpr std::uint64_t longest_time_limit = 1'000'000;  // s, a week and a half

Result<void> read_layers(const std::string& text, BakeOptions& options) {
  if (text == "auto") {
    options.layers = Layers::automatic;
    return {};
  }
  if (text == "scalar") {
    options.layers = Layers::scalar;
    return {};
  }
  std::uint32_t limit = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, limit);
  if (parsed.ec != std::errc() || parsed.ptr != end || limit < 1 || limit > max_layers) {
    return fail(ExitCode::usage,
                "'" + text + "' will not do: write auto, scalar or a whole number from 1 to 255");
  }
  options.layers = Layers::limited;
  options.layer_limit = limit;
  return {};
}

std::string fail_on_words(const char* between) {
  return fmt::format("{}", fmt::join(finding_words, between));
}

Result<void> read_fail_on(const std::string& text, FailOn& fail_on) {
  std::istringstream words(text);
  std::string word;
  bool any = false;
  while (std::getline(words, word, ',')) {
    const auto found = std::find(finding_words.begin(), finding_words.end(), word);
    if (found == finding_words.end()) {
      return fail(ExitCode::usage, "'" + word + "' will not do: write " + fail_on_words(", ") +
                                       ", one or several of them with commas between");
    }
    fail_on[static_cast<std::size_t>(found - finding_words.begin())] = any = true;
  }
  return any ? Result<void>() : fail(ExitCode::usage, "write one of " + fail_on_words(", "));
}

void refuse(const std::string& option, const std::string& reason) {
  throw CLI::ValidationError(option, reason);
}

/// Records which limits the command line gave and which a scene may still set.
void note_given(const CLI::App& command, LimitSources& limits) {
  limits.tolerance_given = command.count("--tolerance") > 0;
  limits.max_depth_given = command.count("--max-depth") > 0;
  limits.probe_given = command.count("--probe") > 0;
  limits.open_given = command.count("--open") > 0;
}

constexpr double most_direction = std::numbers::pi / 4;

/// Checks what no option can check by itself.
void check(const CLI::App& command, const BuildRequest& request) {
  const BakeOptions& bake = request.bake;
  if (bake.form == AssetForm::sparse) {
    for (const char* option : {"--kind", "--planes", "--resolution", "--layers", "--smooth-maps"}) {
      if (command.count(option) > 0)
        refuse(option, "belongs to --form full; add that or leave it out");
    }
  } else if (bake.tolerance) {
    refuse("--tolerance", "belongs to --form sparse: a full asset promises none; leave it out");
  } else if (command.count("--direction-tolerance") > 0) {
    refuse("--direction-tolerance",
           "belongs to --form sparse: the directions of a full asset are those of its maps; leave "
           "it out");
  }
  if (bake.max_bytes && bake.form == AssetForm::full) {
    refuse("--max-bytes",
           "belongs to --form sparse: --planes and --resolution decide how large a full asset is; "
           "leave it out");
  }
  if (!(bake.direction_tolerance > 0 && bake.direction_tolerance <= most_direction)) {
    refuse("--direction-tolerance", "must be above 0 and at most 45 deg");
  }
  if (bake.form == AssetForm::full && !request.limits.device.empty() &&
      request.limits.scene.empty()) {
    refuse("--device",
           "gives the tolerance of --form sparse; a full asset promises none: leave it out");
  }
  if (bake.tolerance && *bake.tolerance <= 0) refuse("--tolerance", "must be above 0");
  if (bake.max_depth <= 0) refuse("--max-depth", "must be above 0");
  if (bake.sheet_thickness &&
      !(*bake.sheet_thickness > 0 && *bake.sheet_thickness <= bake.max_depth)) {
    refuse("--sheet-thickness", "must be above 0 and at most --max-depth");
  }
  if (bake.margin && *bake.margin < 0) refuse("--margin", "must be 0 or more");
  if (bake.margin && *bake.margin < bake.probe_radius) {
    refuse("--margin", "must be at least the probe's radius, " +
                           format_quantity(bake.probe_radius, Quantity::length) +
                           ", or the probe would touch unfelt");
  }
  if (request.load.fit_diagonal && *request.load.fit_diagonal <= 0) {
    refuse("--fit-diagonal", "must be above 0");
  }
}

void add_cut_options(CLI::App& command, LimitSources& limits) {
  const char* group = "Only what a device and a scene need";
  std::vector<std::string> names;
  names.reserve(device_profiles.size());
  for (const DeviceProfile& profile : device_profiles) names.emplace_back(profile.name);
  cli::add_word(
      command, "--device", names, [&limits, names](std::size_t i) { limits.device = names[i]; },
      "device it is for: a tolerance of half its encoder step, and in a scene its force cap and "
      "workspace (default: the scene's, or none)")
      ->group(group);
  command
      .add_option(
          "--scene", limits.scene,
          "scene it is for (TOML): gives --device, --probe, --max-depth (force cap over "
          "stiffness), and leaves out what is outside the device's workspace (default none)")
      ->type_name("SCENE.toml")
      ->group(group);
}

void add_full_options(CLI::App& command, BakeOptions& bake) {
  const char* group = "Options of --form full";
  cli::add_choice<PlaneKind>(
      command, "--kind", bake.kind,
      {{"auto", PlaneKind::automatic}, {"face", PlaneKind::face}, {"vertex", PlaneKind::vertex}},
      "support planes through the hull's facets, or through its vertices with evenly spread "
      "normals "
      "(default auto: facets where there are enough of them)")
      ->group(group);
  cli::add_integer(
      command, "--planes", 4, 100000, [&bake](std::uint64_t n) { bake.planes = n; },
      "support planes, 4 to 100000 (default: every facet, or 1000 where there are more)")
      ->group(group);
  cli::add_integer(
      command, "--resolution", 2, 4097,
      [&bake](std::uint64_t n) { bake.resolution = static_cast<std::uint32_t>(n); },
      "samples a side of each distance map, 2 to 4097 (default 65)")
      ->group(group);
  cli::add_parsed(
      command, "--layers", [&bake](const std::string& text) { return read_layers(text, bake); },
      "crossings kept along a ray: all, the first, or at most N, 1 to 255 (default auto: all)",
      "auto|scalar|N")
      ->group(group);
  cli::add_parsed(
      command, "--smooth-maps",
      [&bake](const std::string& text) -> Result<void> {
        return parse_smoothing(text).map(
            [&](const SmoothOptions& read) { bake.smooth_maps = read; });
      },
      "filter the distance maps (eq. 16): with a Gaussian of SIGMA, or one that keeps edges that "
      "turn by more than ANGLE (default none)",
      "none|gaussian:SIGMA|crease:ANGLE")
      ->group(group);
}

}  // namespace

void add_fail_on(CLI::App& command, FailOn& fail_on) {
  cli::add_parsed(
      command, "--fail-on",
      [&fail_on](const std::string& text) { return read_fail_on(text, fail_on); },
      "exit with 3, and places, where the mesh has any of these: open edges, edges of more than "
      "two triangles, triangles that cross, sheets, lids, or anything that had to be mended",
      fail_on_words(","));
}

void add_build_options(CLI::App& command, BuildRequest& request) {
  BakeOptions& bake = request.bake;
  command
      .add_option("MESH", request.mesh,
                  "mesh to bake: glTF (.gltf, .glb), 3MF, OBJ, PLY, STL or OFF, also as .gz")
      ->required()
      ->type_name("");
  command.add_option("-o,--output", request.output, "baked file to write, FILE.spm.exr")
      ->required()
      ->type_name("FILE");
  cli::add_choice<AssetForm>(command, "--form", bake.form,
                             {{"sparse", AssetForm::sparse}, {"full", AssetForm::full}},
                             "sparse: small, with a tolerance; full: N planes with a map each, for "
                             "the paper's method (default sparse)");
  cli::add_quantity(
      command, "--tolerance", bake.tolerance, Quantity::length,
      "largest error of the signed distance in the band, above 0, such as 50um; more than a tenth "
      "of the band's depth saves nothing, and that is what is proven then (default half of the "
      "named device's encoder step, or 1/1000 of the bounding box's "
      "diagonal)");
  cli::add_quantity(command, "--direction-tolerance", bake.direction_tolerance, Quantity::angle,
                    "how far directions may be off in the median, above 0 and at most 45deg");
  command.add_option(
      "--max-bytes", bake.max_bytes,
      "the most bytes that the file may take; queries are as fast as they can be with so many "
      "(default: as many as make bytes times the time of queries least)");
  cli::add_quantity(command, "--max-depth", bake.max_depth, Quantity::length,
                    "how deep inside the asset answers, above 0");
  cli::add_quantity(command, "--margin", bake.margin, Quantity::length,
                    "how far outside the asset answers, at least the probe's radius "
                    "(default: that radius and a quarter of --max-depth)");
  cli::add_word(
      command, "--open", {open_as_words.begin(), open_as_words.end()},
      [&request](std::size_t i) { request.load.open_as = static_cast<OpenAs>(i); },
      "what open parts are: solids whose holes get lids, or sheets felt from both sides (default "
      "auto: solids where lids take at most 5 % of their area)");
  cli::add_quantity(command, "--sheet-thickness", bake.sheet_thickness, Quantity::length,
                    "from the middle of a sheet to what is felt of it, above 0 and at most "
                    "--max-depth (default the tolerance)");
  cli::add_probe(command, bake.probe_radius);
  add_cut_options(command, request.limits);
  add_full_options(command, bake);
  cli::add_parsed(
      command, "--smooth,--smooth-mesh",
      [&bake](const std::string& text) -> Result<void> {
        return parse_smoothing(text).map([&](const SmoothOptions& read) { bake.smooth = read; });
      },
      "smooth the mesh first: with a Gaussian of SIGMA, or all but edges that turn by more than "
      "ANGLE; the tolerance is then to the smoothed surface (default none)",
      "none|gaussian:SIGMA|crease:ANGLE");
  cli::add_parsed(
      command, "--unit",
      [&request](const std::string& text) -> Result<void> {
        return parse_mesh_unit(text).map([&](double metres) { request.load.unit = metres; });
      },
      "unit of the mesh file's coordinates (default as the file says, else m)", "m|mm|cm|in");
  cli::add_quantity(command, "--fit-diagonal", request.load.fit_diagonal, Quantity::length,
                    "scale about the origin until the bounding box's diagonal is this long");
  command.add_flag("--outside-buffers", request.load.outside_buffers,
                   "read buffers that a glTF names by an absolute path or by '..' (default: only "
                   "those in its own folder)");
  cli::add_integer(
      command, "--threads", 1, 1024,
      [&bake](std::uint64_t n) { bake.threads = static_cast<unsigned>(n); },
      "threads to bake with, 1 to 1024; the output is the same for any (default: all cores)");
  cli::add_integer(
      command, "--seed", 0, std::numeric_limits<std::uint64_t>::max(),
      [&bake](std::uint64_t n) { bake.seed = n; },
      "seed of the places where the bake and its check measure (default 1)");
  add_fail_on(command, request.fail_on);
  cli::add_integer(
      command, "--time-limit", 1, longest_time_limit,
      [&request](std::uint64_t n) { request.time_limit = n; },
      "give up after so many SECONDS, with nothing written (default 3600)");
  command.add_flag("--allow-inexact", request.allow_inexact,
                   "write the asset even where the tolerance was not met");
  command.callback([&command, &request] {
    note_given(command, request.limits);
    check(command, request);
  });
}

}  // namespace spm::baker
