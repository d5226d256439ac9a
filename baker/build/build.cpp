// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/build/build.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <filesystem>
#include <numbers>
#include <system_error>

#include "baker/base/bake_error.hpp"
#include "baker/base/stopwatch.hpp"
#include "baker/build/lids_report.hpp"
#include "baker/build/time_limit.hpp"
#include "baker/cast/exact_tree.hpp"
#include "baker/mesh/load.hpp"
#include "baker/reachability/reachability.hpp"
#include "baker/verify/answer_shares.hpp"
#include "common/base/units.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/files/sha256.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t check_samples = 20000;
constexpr double degree = std::numbers::pi / 180;

std::string length(double metres) { return format_quantity(metres, Quantity::length); }

Json vector_json(const Vector3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json error_json(const VerifyReport& check) {
  constexpr double micro = 1e6;
  return {{"rms", check.distance.rms * micro}, {"p50", check.distance.p50 * micro},
          {"p99", check.distance.p99 * micro}, {"p999", check.distance.p999 * micro},
          {"max", check.distance.max * micro}, {"samples", check.samples}};
}

Json direction_json(const BakeOptions& options, const VerifyReport& check) {
  Json json = {{"p50", check.direction_p50 / degree}, {"p99", check.direction_p99 / degree}};
  if (options.form == AssetForm::sparse) json["tolerance"] = options.direction_tolerance / degree;
  return json;
}

Json mesh_json(const Mesh& mesh) {
  return {{"path", mesh.path},
          {"triangles", mesh.file_triangles},
          {"vertices", mesh.file_vertices},
          {"closed", mesh.border_edges == 0},
          {"components", mesh.components},
          {"border_edges", mesh.border_edges},
          {"diagonal_m", mesh.diagonal},
          {"bbox_m", {{"min", vector_json(mesh.box_min)}, {"max", vector_json(mesh.box_max)}}},
          {"sha256", mesh.sha256}};
}

Json spm_json(const BakeResult& baked) {
  const Asset& asset = baked.asset;
  return {{"form", asset.metadata.form == AssetForm::full ? "full" : "sparse"},
          {"kind", asset.metadata.kind},
          {"planes", asset.planes.size()},
          {"tiles", asset.maps.size() + asset.atlas.charts.size()},
          {"samples", baked.report.samples},
          {"layers_max", asset.metadata.layers_max},
          {"cells", baked.report.record_cells}};
}

/// Refuses to write an asset that breaks its promise, unless that is allowed.
void judge(const BuildRequest& request, const BakeResult& baked, const VerifyReport& check,
           BuildReport& report) {
  const AssetMetadata& metadata = baked.asset.metadata;
  if (!metadata.tolerance || metadata.tolerance_met) return;
  std::string finding;
  if (metadata.certified && *metadata.certified > *metadata.tolerance) {
    finding = fmt::format("no error below {} can be proven in the floats of a baked file",
                          length(*metadata.certified));
  } else if (check.distance.max > *metadata.tolerance) {
    const Vector3& at = check.worst_point;
    finding = fmt::format(
        "the error reaches {} at ({:.9g}, {:.9g}, {:.9g}) m, above the tolerance of {}",
        length(check.distance.max), at.x(), at.y(), at.z(), length(*metadata.tolerance));
  } else if (check.jumps.beyond > 0) {
    const Vector3& at = check.jumps.worst_point;
    finding = fmt::format(
        "the distance jumps by {} at ({:.9g}, {:.9g}, {:.9g}) m, by more than twice the tolerance "
        "of {}",
        length(check.jumps.distance.max), at.x(), at.y(), at.z(), length(*metadata.tolerance));
  } else {
    finding = fmt::format("{:.2g} % of the band is left without an answer", 100 * check.unanswered);
  }
  if (!request.allow_inexact) {
    throw BakeError(ExitCode::tolerance_not_met,
                    fmt::format("{}: not written: {}; ask for a larger --tolerance, mend the mesh "
                                "there, or add --allow-inexact",
                                request.output, finding));
  }
  report.warnings.push_back("the tolerance is not met: " + finding);
}

/// The effect of smoothing, and its error apart from that of the fit.
Json smooth_json(const std::optional<SmoothReport>& smooth) {
  if (!smooth) return {{"kind", "none"}};
  constexpr double micro = 1e6;
  const SmoothOptions& options = smooth->options;
  const bool crease = options.kind == Smoothing::crease;
  Json json = {{"kind", crease ? "crease" : "gaussian"}};
  if (crease) json["angle_deg"] = options.angle / degree;
  json["sigma_um"] = options.sigma * micro;
  json["error_um"] = {
      {"rms", smooth->rms * micro}, {"p99", smooth->p99 * micro}, {"max", smooth->max * micro}};
  return json;
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

std::uint64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

int threads_of(const BakeOptions& options) {
  return options.threads > 0 ? static_cast<int>(options.threads) : tbb::info::default_concurrency();
}

/// Refuses a mesh that has what somebody does not want, all of it in one sentence.
void refuse_findings(const BuildRequest& request, const std::vector<MeshFinding>& findings) {
  std::string what, words;
  for (const MeshFinding& finding : findings) {
    const auto kind = static_cast<std::size_t>(finding.kind);
    if (!request.fail_on[kind]) continue;
    const Vector3 at = 1e3 * finding.place;
    what += fmt::format("{}{}, at ({:.9g}, {:.9g}, {:.9g}) mm{}", what.empty() ? "" : "; ",
                        finding.what.substr(0, finding.what.size() - 1), at.x(), at.y(), at.z(),
                        finding.count > 1 ? " for instance" : "");
    if (words.find(finding_words[kind]) == std::string::npos) {
      words += std::string(words.empty() ? "" : ",") + finding_words[kind];
    }
  }
  if (what.empty()) return;
  throw BakeError(ExitCode::invalid_input,
                  fmt::format("{}: --fail-on {}: {}; mend the mesh there, or leave that word out",
                              request.mesh, words, what));
}

/// Objects that a hand feels are no smaller and no larger from corner to corner, m.
constexpr double smallest_object = 2e-3, largest_object = 5;

bool is_felt_by_hand(const Mesh& mesh) {
  return mesh.diagonal >= smallest_object && mesh.diagonal <= largest_object;
}

/// Asks for the unit of a file whose numbers, taken for metres, give an object that no hand feels.
void ask_unit(const BuildRequest& request, const Mesh& mesh) {
  if (is_felt_by_hand(mesh) || mesh.unit_named || request.load.fit_diagonal) return;
  throw BakeError(ExitCode::invalid_input,
                  fmt::format("{}: the file names no unit, and in metres the object is {} from "
                              "corner to corner; is it in mm? Say what its numbers are by --unit "
                              "m, mm, cm or in, or how large it is to be by --fit-diagonal",
                              request.mesh, length(mesh.diagonal)));
}

/// Warns where the size of an object whose unit was named is not one that a hand feels.
void doubt_unit(const BuildRequest& request, const Mesh& mesh, const AssetMetadata& metadata,
                BuildReport& report) {
  if (request.load.fit_diagonal || request.load.unit) return;
  const std::string size = length(mesh.diagonal);
  if (!is_felt_by_hand(mesh)) {
    report.warnings.push_back(fmt::format(
        "the object is {} from corner to corner; is it in mm? --unit says what its numbers are",
        size));
  } else if (metadata.tolerance && *metadata.tolerance > metadata.band.max_depth) {
    report.warnings.push_back(fmt::format(
        "the tolerance of {} exceeds the depth of {} that the asset answers, for an object of {} "
        "from corner to corner; is it in mm? --unit says what its numbers are",
        length(*metadata.tolerance), length(metadata.band.max_depth), size));
  }
}

/// Tells where directions are off by more than was asked for: in the median, or in 1 of 100 places
/// by more than 3.75 times that, which is 15 degrees for 4.
void judge_directions(const BakeOptions& options, const VerifyReport& check, BuildReport& report) {
  constexpr double tail = 3.75;
  const double asked = options.direction_tolerance;
  if (options.form != AssetForm::sparse ||
      (check.direction_p50 <= asked && check.direction_p99 <= tail * asked)) {
    return;
  }
  report.warnings.push_back(fmt::format(
      "directions are off by {:.2g} deg in the median and {:.3g} at p99, of {:.2g} and {:.3g} deg "
      "asked for; a smaller --direction-tolerance or --tolerance brings them nearer",
      check.direction_p50 / degree, check.direction_p99 / degree, asked / degree,
      tail * asked / degree));
}

/// Queries the asset in memory as whoever opens the file does, and sets whether its tolerance is
/// met.
VerifyReport check_asset(const Mesh& mesh, const BakeOptions& options, BakeResult& baked) {
  Asset& asset = baked.asset;
  const AssetTables tables = tables_of(asset);
  VerifyOptions verify;
  verify.samples = check_samples;
  verify.seed = options.seed;
  verify.threads = options.threads;
  VerifyReport check = verify_against(mesh, tables.view(), asset.metadata, verify);
  asset.metadata.tolerance_met = asset.metadata.tolerance && check.unanswered == 0 &&
                                 check.distance.max <= *asset.metadata.tolerance &&
                                 check.jumps.beyond == 0;
  std::optional<double>& certified = asset.metadata.certified;
  if (certified && *certified > *asset.metadata.tolerance) {
    asset.metadata.tolerance_met = false;
  } else if (!asset.metadata.tolerance_met) {
    certified.reset();
  }
  return check;
}

struct Written {
  AssetBytes bytes;
  std::string sha256;
};

Written write(const Asset& asset, const std::string& path) {
  const Result<AssetBytes> bytes = write_asset(asset, path);
  if (!bytes) throw BakeError(bytes.error().code, bytes.error().message);
  const Result<std::string> hash = sha256_file(path);
  if (!hash) throw BakeError(hash.error().code, hash.error().message);
  return {*bytes, *hash};
}

/// Bakes. Adds the mesh's name to error messages, since the inner stages do not know it.
BakeResult bake_named(const Mesh& mesh, const BakeOptions& options, const Progress& progress) {
  try {
    return bake(mesh, options, progress);
  } catch (const BakeError& error) {
    const std::string message = error.what();
    if (error.code() != ExitCode::invalid_input || message.find(mesh.path) != std::string::npos)
      throw;
    throw BakeError(error.code(), mesh.path + ": " + message);
  }
}

/// Why a rule leaves places out, for a person.
std::string reason_of(const std::string& rule) {
  if (rule == name_of(PruneRule::workspace)) return "outside the device's workspace";
  if (rule == name_of(PruneRule::probe)) return "where the probe does not fit";
  if (rule == name_of(PruneRule::unreachable)) return "in hollows that no way leads into";
  return rule;
}

Json stages_json(const StageTimes& stages) {
  Json json = Json::object();
  for (const auto& [stage, seconds] : stages.seconds()) json[stage] = seconds;
  return json;
}

struct Seconds {
  double load = 0, verify = 0, write = 0, total = 0;
};

Json to_json(const BuildRequest& request, const Mesh& mesh, const BakeResult& baked,
             const VerifyReport& check, const Written& written, const Seconds& seconds) {
  const AssetMetadata& metadata = baked.asset.metadata;
  Json json;
  json["output"] = request.output;
  json["mesh"] = mesh_json(mesh);
  json["solid"] = Json::parse(metadata.solid);
  json["spm"] = spm_json(baked);
  json["fallback"] = {{"cells", share(baked.report.fallback_cells, baked.report.record_cells)},
                      {"answers", check.fallback_answers},
                      {"bytes", share(written.bytes.triangles, written.bytes.total)}};
  if (metadata.form == AssetForm::sparse) {
    add_answers(tables_of(baked.asset).view(), json);
  }
  json["bytes"] = written.bytes.total;
  json["content_sha256"] = written.sha256;
  json["tolerance_um"] = metadata.tolerance ? Json(*metadata.tolerance * 1e6) : Json();
  json["tolerance_met"] = metadata.tolerance_met;
  json["error_um"] = error_json(check);
  json["direction_error_deg"] = direction_json(request.bake, check);
  json["smooth"] = smooth_json(baked.report.smooth);
  json["unanswered"] = check.unanswered;
  json["pruned"] = Json::array();
  json["pruned_nothing"] = Json::array();
  for (const Pruned& pruned : baked.report.pruned) {
    if (pruned.bytes == 0) {
      json["pruned_nothing"].push_back(pruned.rule);
      continue;
    }
    json["pruned"].push_back({{"rule", pruned.rule}, {"bytes", pruned.bytes}});
  }
  add_lids_json(baked.report.lids, json);
  json["seconds"] = {{"load", seconds.load},
                     {"fit", baked.report.seconds_fit},
                     {"cast", baked.report.seconds_cast},
                     {"write", seconds.write},
                     {"verify", seconds.verify},
                     {"total", seconds.total},
                     {"stages", stages_json(baked.report.stages)}};
  json["threads"] = threads_of(request.bake);
  json["peak_rss_bytes"] = peak_memory();
  json["notes"] = baked.report.notes;
  return json;
}

}  // namespace

Result<void> check_new_output(const std::string& output) {
  const std::filesystem::path path(output);
  std::filesystem::path folder = path.parent_path();
  std::error_code ignored;
  while (!folder.empty() &&
         !std::filesystem::exists(std::filesystem::symlink_status(folder, ignored))) {
    folder = folder.parent_path();
  }
  return check_output_path(folder == path.parent_path() ? output
                                                        : (folder / path.filename()).string());
}

void make_folder_of(const std::string& output) {
  const std::filesystem::path folder = std::filesystem::path(output).parent_path();
  std::error_code problem;
  if (!folder.empty()) std::filesystem::create_directories(folder, problem);
  if (problem) {
    throw BakeError(ExitCode::file_or_device, folder.string() + ": the folder cannot be made: " +
                                                  problem.message() + "; write elsewhere");
  }
}

void check_paths(const BuildRequest& request) {
  if (const Result<void> writable = check_new_output(request.output); !writable) {
    throw BakeError(writable.error().code, writable.error().message);
  }
  std::error_code ignored;
  if (std::filesystem::equivalent(request.mesh, request.output, ignored)) {
    throw BakeError(ExitCode::usage, request.output +
                                         ": is the mesh itself; give -o another name, such as "
                                         "FILE.spm.exr");
  }
}

BuildReport run_build(const BuildRequest& request, const Progress& progress) {
  const Clock::time_point start = Clock::now();
  Seconds seconds;
  TimeLimit time_limit(request.time_limit, request.output);
  const Progress timed = [&](const char* stage, double done) {
    time_limit.enter(stage);
    if (progress) progress(stage, done);
  };
  const auto tell = [&](const char* stage) { timed(stage, 0); };
  check_paths(request);
  BakeOptions options = request.bake;
  BuildReport report;
  LoadOptions load = request.load;
  report.derived = derive_limits(request.limits, request.mesh, options, load.open_as);
  tell("load");
  const Mesh mesh = load_mesh(request.mesh, load);
  seconds.load = seconds_since(start);
  ask_unit(request, mesh);
  refuse_findings(request, mesh.findings);

  check_limits(request.limits, options, mesh, request.allow_inexact);
  time_limit.describe(fmt::format("{} triangles in {} {}", mesh.triangles.size(), mesh.components,
                                  mesh.components == 1 ? "part" : "parts"));
  BakeResult baked = bake_named(mesh, options, timed);
  refuse_findings(request, baked.report.found_in_surface);
  const AssetMetadata& metadata = baked.asset.metadata;
  if (metadata.tolerance && !options.tolerance) {
    report.warnings.push_back(fmt::format("no --tolerance: taking 1/1000 of the diagonal, {}",
                                          length(*metadata.tolerance)));
  }

  const Clock::time_point verifying = Clock::now();
  tell("verify");
  const VerifyReport check = check_asset(baked.smoothed ? *baked.smoothed : mesh, options, baked);
  seconds.verify = seconds_since(verifying);
  judge(request, baked, check, report);
  judge_directions(options, check, report);
  doubt_unit(request, mesh, metadata, report);

  time_limit.disarm();
  const Clock::time_point writing = Clock::now();
  make_folder_of(request.output);
  tell("write");
  const Written written = write(baked.asset, request.output);
  seconds.write = seconds_since(writing);
  const std::uint64_t bytes = written.bytes.total, tree = exact_tree_bytes(mesh, bytes);
  seconds.total = seconds_since(start);

  report.notes = baked.report.notes;
  report.json = to_json(request, mesh, baked, check, written, seconds);
  report.json["derived"] = report.derived;
  report.json["exact_tree_bytes"] = tree < bytes ? Json(tree) : Json();
  return report;
}

void add_answers(const AssetView& view, Json& json) {
  const SharesOfPlaces shares = shares_of_places(view);
  for (const auto& [name, of] :
       {std::pair{"answers", &shares.surface}, {"answers_in_band", &shares.band}}) {
    json[name] = {
        {"one_map", of->one_map}, {"two_maps", of->two_maps}, {"triangles", of->triangles}};
  }
}

std::string answers_text(const Json& json) {
  const auto text_of = [&json](const char* name, const char* of) {
    const auto percent = [&](const char* what) { return 100 * json[name][what].get<double>(); };
    return fmt::format("{:.1f} % {} by one distance map, {:.1f} % by two, {:.1f} % by triangles",
                       percent("one_map"), of, percent("two_maps"), percent("triangles"));
  };
  return text_of("answers", "of the surface") + "\n         " +
         text_of("answers_in_band", "of the band");
}

std::string describe(const BuildReport& report) {
  const Json& json = report.json;
  const Json& mesh = json["mesh"];
  const Json& spm = json["spm"];
  std::string text = fmt::format(
      "mesh     {}: {} triangles, {} {}, {}\n", mesh["path"].get<std::string>(),
      mesh["triangles"].get<std::uint64_t>(), mesh["components"].get<std::uint64_t>(),
      mesh["components"] == 1 ? "part" : "parts",
      mesh["closed"].get<bool>()
          ? std::string("closed")
          : fmt::format("open ({} border edges)", mesh["border_edges"].get<std::uint64_t>()));
  text += fmt::format("asset    {}: {} bytes, {} form, {} support planes, {} distance maps\n",
                      json["output"].get<std::string>(), json["bytes"].get<std::uint64_t>(),
                      spm["form"].get<std::string>(), spm["planes"].get<std::uint64_t>(),
                      spm["tiles"].get<std::uint64_t>());
  const Json &low = mesh["bbox_m"]["min"], &high = mesh["bbox_m"]["max"];
  text += "size    ";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    text += fmt::format("{} {:.4g}", axis > 0 ? " x" : "",
                        1e3 * (high[axis].get<double>() - low[axis].get<double>()));
  }
  text += " mm\n";
  const Json& error = json["error_um"];
  text +=
      fmt::format("error    rms {:.3g} um, 99 % below {:.3g} um, largest {:.3g} um of {} samples",
                  error["rms"].get<double>(), error["p99"].get<double>(),
                  error["max"].get<double>(), error["samples"].get<std::uint64_t>());
  if (!json["tolerance_um"].is_null()) {
    text += fmt::format("; tolerance {:.4g} um {}", json["tolerance_um"].get<double>(),
                        json["tolerance_met"].get<bool>() ? "met" : "NOT met");
  }
  const Json& direction = json["direction_error_deg"];
  text += fmt::format("\ndirection off by {:.2g} deg in the median, 99 % below {:.2g} deg",
                      direction["p50"].get<double>(), direction["p99"].get<double>());
  if (const Json& smooth = json["smooth"]; smooth.contains("error_um")) {
    text += fmt::format(
        "\nsmooth   {} of sigma {:.4g} um moved the surface by rms {:.3g} um, 99 % below {:.3g} "
        "um, "
        "at most {:.3g} um; the error above is against the smoothed surface",
        smooth["kind"] == "crease" ? fmt::format("all but edges over {:.4g} deg, by a Gaussian",
                                                 smooth["angle_deg"].get<double>())
                                   : "a Gaussian",
        smooth["sigma_um"].get<double>(), smooth["error_um"]["rms"].get<double>(),
        smooth["error_um"]["p99"].get<double>(), smooth["error_um"]["max"].get<double>());
  }
  const Json& fallback = json["fallback"];
  text += fmt::format(
      "\nfallback {:.1f} % of the cells hold exact triangles, for places that no map answers",
      100 * fallback["cells"].get<double>());
  if (json.contains("answers")) {
    text += "\nanswers  " + answers_text(json);
  }
  if (json.contains("exact_tree_bytes") && !json["exact_tree_bytes"].is_null()) {
    text += fmt::format("\nsmaller  a compact tree of the mesh's exact triangles: {} bytes",
                        json["exact_tree_bytes"].get<std::uint64_t>());
  }
  const Json& seconds = json["seconds"];
  text += fmt::format(
      "\nseconds  {:.2f}: load {:.2f}, fit {:.2f}, cast {:.2f}, verify {:.2f}, write {:.2f}\n",
      seconds["total"].get<double>(), seconds["load"].get<double>(), seconds["fit"].get<double>(),
      seconds["cast"].get<double>(), seconds["verify"].get<double>(),
      seconds["write"].get<double>());
  text += lids_text(json);
  for (const Json& pruned : json["pruned"]) {
    text += fmt::format("pruned   {} bytes: {}\n", pruned["bytes"].get<std::uint64_t>(),
                        reason_of(pruned["rule"].get<std::string>()));
  }
  for (const Json& rule : json["pruned_nothing"]) {
    text += fmt::format("pruned   nothing: {}\n", reason_of(rule.get<std::string>()));
  }
  for (const std::string& derived : report.derived) text += "derived  " + derived + "\n";
  for (const std::string& note : report.notes) text += "note     " + note + "\n";
  return text;
}

}  // namespace spm::baker
