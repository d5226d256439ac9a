// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/verify.hpp"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "baker/mesh/mesh_files.hpp"
#include "baker/smooth/smooth.hpp"
#include "baker/verify/adversarial.hpp"
#include "baker/verify/border_jumps.hpp"
#include "baker/verify/direction_error.hpp"
#include "baker/verify/doubtful_gaps.hpp"
#include "baker/verify/exact_surface.hpp"
#include "baker/verify/outcome.hpp"
#include "common/base/random.hpp"
#include "common/base/units.hpp"
#include "common/query/query.hpp"

namespace spm::baker {
namespace {

constexpr std::uint64_t max_draws = 256;
/// Samples that are tried first, so that a surface without a place to measure is reported at once.
constexpr std::uint64_t first_samples = 256;

/// The inputs of a verification; fixed while it runs.
struct Setting {
  const ExactSurface& surface;
  const ExactSurface* unsmoothed;  ///< the surface before smoothing; may be null
  const AssetView& view;
  Band band;         ///< the band that is sampled
  double tolerance;  ///< m
  std::uint64_t seed;
  const AdversarialPlaces* adversarial = nullptr;  ///< else evenly all over
};

/// The change by smoothing at a sample's place, alone and together with the asset's own error.
void judge_smoothing(const ExactSurface& unsmoothed, Outcome& outcome) {
  const double truth = unsmoothed.distance(outcome.point, unsmoothed.closest(outcome.point));
  outcome.smoothing_error = std::abs(outcome.truth - truth);
  outcome.total_error = outcome.answered ? std::abs(outcome.answer - truth) : 0;
}

/// Draws places until one is in the band by its true distance.
SurfacePoint draw(const Setting& setting, std::uint64_t index, Outcome& outcome) {
  SurfacePoint closest;
  const Band& band = setting.band;
  for (std::uint64_t attempt = 0; attempt < max_draws && !outcome.drawn; ++attempt) {
    const std::uint64_t counter = 4 * (index * max_draws + attempt);
    const auto random = [&](std::uint64_t k) { return random_unit(setting.seed, counter + k); };
    const SurfacePoint start = setting.surface.at(random(0), random(1), random(2));
    double offset = -band.max_depth + (band.max_depth + band.margin) * random(3);
    // Both sides of a sheet are outside.
    if (start.sheet) offset = (setting.view.sheet_thickness + band.margin) * (2 * random(3) - 1);
    outcome.point = setting.adversarial != nullptr
                        ? setting.adversarial->at(setting.seed, index * max_draws + attempt)
                        : Vector3(start.position + offset * start.normal);
    closest = setting.adversarial != nullptr ? setting.surface.closest(outcome.point)
                                             : setting.surface.closest(outcome.point, start);
    // The side is computed last, since that takes by far the longest.
    if (setting.surface.size_of_distance(outcome.point, closest) >
        std::max(band.max_depth, band.margin)) {
      continue;
    }
    outcome.truth = setting.surface.distance(outcome.point, closest);
    outcome.drawn = outcome.truth >= -band.max_depth && outcome.truth <= band.margin;
  }
  return closest;
}

void judge_distance(const Setting& setting, const Answer& answer, Outcome& outcome) {
  outcome.source = answer.source;
  outcome.answered = std::isfinite(answer.distance);
  outcome.answer = answer.distance;
  outcome.far = answer.status == Status::far;
  outcome.pruned = answer.status == Status::pruned;
  if (outcome.far && outcome.truth >= setting.view.band.margin - setting.tolerance) {
    outcome.answered = true;
    outcome.answer = setting.view.band.margin;
  }
  outcome.error = outcome.answered ? std::abs(outcome.answer - outcome.truth) : 0;
}

Outcome measure(const Setting& setting, std::uint64_t index) {
  Outcome outcome;
  const SurfacePoint closest = draw(setting, index, outcome);
  if (!outcome.drawn) return outcome;
  const Answer answer = query_point(setting.view, outcome.point);
  judge_distance(setting, answer, outcome);
  outcome.directed = index < most_directions;
  if (outcome.directed) {
    const DirectionError direction = direction_error(
        setting.surface, {outcome.point, closest, outcome.truth}, setting.tolerance, answer);
    outcome.contested = direction.contested;
    outcome.direction_error = direction.angle;
  }
  if (setting.unsmoothed != nullptr) judge_smoothing(*setting.unsmoothed, outcome);
  return outcome;
}

unsigned threads_of(const VerifyOptions& options) {
  return options.threads > 0 ? options.threads
                             : static_cast<unsigned>(tbb::info::default_concurrency());
}

/// What the open surfaces of an asset's mesh were taken for, by its options.
OpenAs recorded_open_as(const std::string& options) {
  const nlohmann::json json = nlohmann::json::parse(options, nullptr, false);
  if (!json.is_object() || !json.contains("open")) return OpenAs::automatic;
  for (std::size_t i = 0; i < open_as_words.size(); ++i) {
    if (json["open"] == open_as_words[i]) return static_cast<OpenAs>(i);
  }
  throw BakeError(
      ExitCode::invalid_input,
      "options.open of the asset is no word that this program knows; verify it with the "
      "program that baked it");
}

/// The band to sample, after checking the options.
Band checked_band(const AssetMetadata& metadata, const VerifyOptions& options) {
  Band band = metadata.band;
  if (!options.band) return band;
  if (!(*options.band >= 0)) {
    throw BakeError(ExitCode::usage, "--band: a depth inside cannot be below 0");
  }
  // Text such as 2mm and the recorded value may differ in the last bit.
  if (*options.band > metadata.band.max_depth * (1 + 1e-12)) {
    throw BakeError(ExitCode::invalid_input,
                    "--band " + format_quantity(*options.band, Quantity::length) +
                        " is more than the asset answers, " +
                        format_quantity(metadata.band.max_depth, Quantity::length) +
                        " inside; ask for less or bake with a larger --max-depth");
  }
  band.max_depth = std::min(*options.band, metadata.band.max_depth);
  return band;
}

}  // namespace

VerifyReport verify_against(const Mesh& mesh, const AssetView& view, const AssetMetadata& metadata,
                            const VerifyOptions& options, const Mesh* unsmoothed) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  threads_of(options));
  const Band band = checked_band(metadata, options);
  const double thickness = metadata.sheet_thickness, tolerance = answer_tolerance(metadata);
  const ExactSurface surface(mesh, thickness, tolerance);
  const std::optional<ExactSurface> before =
      unsmoothed != nullptr
          ? std::optional<ExactSurface>(std::in_place, *unsmoothed, thickness, tolerance)
          : std::nullopt;
  if (surface.empty()) {
    throw BakeError(ExitCode::invalid_input,
                    mesh.path + ": nothing of its surface is felt; turn its triangles outward");
  }
  // The fit uses the same generator. A different seed keeps the two sets of places apart.
  const Setting setting{surface,   before ? &*before : nullptr,
                        view,      band,
                        tolerance, random_bits(options.seed, 0x7665726966790000ULL)};
  const auto measured = [&](const Setting& how, std::uint64_t count) {
    std::vector<Outcome> outcomes(count);
    tbb::parallel_for(std::size_t{0}, outcomes.size(),
                      [&](std::size_t i) { outcomes[i] = measure(how, i); });
    return outcomes;
  };
  const std::vector<Outcome> first = measured(setting, std::min(options.samples, first_samples));
  if (std::none_of(first.begin(), first.end(), [](const Outcome& o) { return o.drawn; })) {
    throw BakeError(ExitCode::invalid_input,
                    mesh.path + ": no place to measure: none lies in the band");
  }
  std::vector<Outcome> outcomes = measured(setting, options.samples);
  Setting hard = setting;
  const AdversarialPlaces places(surface, view, setting.tolerance);
  hard.adversarial = &places;
  hard.seed = random_bits(setting.seed, 1);
  std::vector<Outcome> hard_outcomes = measured(hard, options.samples / 2);
  if (surface.has_gaps()) {
    DoubtfulGaps gaps(mesh, view, tolerance);
    for (std::vector<Outcome>* some : {&outcomes, &hard_outcomes}) gaps.judge(*some);
  }
  VerifyReport report = report_of(outcomes, setting.tolerance);
  const VerifyReport hardest = report_of(hard_outcomes, setting.tolerance);
  report.adversarial = {
      hardest.samples,           hardest.counts,     hardest.distance,   hardest.inside_as_outside,
      hardest.outside_as_inside, hardest.unanswered, hardest.worst_point};
  report.jumps = border_jumps(
      {surface, view, band, setting.tolerance, random_bits(setting.seed, 2)}, options.samples / 4);
  report.worst = worst_places(outcomes, hard_outcomes, setting.tolerance, options.worst);
  if (before) add_smoothing(outcomes, report);
  report.band = band;
  report.seed = options.seed;
  report.tolerance = metadata.tolerance;
  report.tolerance_met = metadata.tolerance_met;
  return report;
}

Mesh mesh_of_asset(const AssetMetadata& metadata, const std::string& mesh_path) {
  // What it is made of was allowed when it was baked, or its hash differs.
  const Result<std::string> hash = mesh_sha256(mesh_path, true);
  if (!hash) throw BakeError(hash.error().code, hash.error().message);
  if (*hash != metadata.mesh_sha256) {
    throw BakeError(ExitCode::invalid_input,
                    mesh_path +
                        ": not the mesh that the asset was baked from (its SHA-256 differs); "
                        "give that mesh, or bake this one");
  }
  return load_mesh(mesh_path, {.unit = metadata.mesh_unit,
                               .scale = metadata.scale,
                               .outside_buffers = true,
                               .open_as = recorded_open_as(metadata.options)});
}

VerifyReport verify_asset(const AssetView& view, const AssetMetadata& metadata,
                          const std::string& mesh_path, const VerifyOptions& options) {
  const Band band = checked_band(metadata, options);
  const Mesh mesh = mesh_of_asset(metadata, mesh_path);
  VerifyOptions checked = options;
  if (options.band) checked.band = band.max_depth;
  const Result<SmoothOptions> smoothing = recorded_smoothing(metadata.options);
  if (!smoothing) throw BakeError(smoothing.error().code, smoothing.error().message);
  if (smoothing->kind == Smoothing::none) return verify_against(mesh, view, metadata, checked);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  threads_of(options));
  SmoothReport ignored;
  const Mesh smoothed = smoothed_mesh(mesh, *smoothing, {}, ignored);
  return verify_against(smoothed, view, metadata, checked, &mesh);
}

}  // namespace spm::baker
