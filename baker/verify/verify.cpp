// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/verify.hpp"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
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
  double near_hole;  ///< m
  std::uint64_t seed;
  const AdversarialPlaces* adversarial = nullptr;  ///< else evenly all over
};

/// The change by smoothing at a sample's place, alone and together with the asset's own error.
void judge_smoothing(const ExactSurface& unsmoothed, Outcome& outcome) {
  const double distance = (outcome.point - unsmoothed.closest(outcome.point).position).norm();
  const double truth = unsmoothed.inside(outcome.point) ? -distance : distance;
  outcome.smoothing_error = std::abs(outcome.truth - truth);
  outcome.total_error = outcome.answered ? std::abs(outcome.answer - truth) : 0;
}

/// The asset's result beside a hole, where either side may be the true one.
PlaceNearHole judge_near_hole(const Setting& setting, const Vector3& point, double distance) {
  const Answer answer = query_point(setting.view, point);
  const Band& band = setting.view.band;
  PlaceNearHole place;
  place.point = point;
  place.pruned = answer.status == Status::pruned;
  if (answer.status == Status::far) {
    place.answered = distance >= band.margin - setting.tolerance;
    place.error = place.answered ? std::max(0.0, band.margin - distance) : 0;
  } else if (std::isfinite(answer.distance)) {
    place.answered = true;
    place.error = answer.status == Status::deep ? std::max(0.0, band.max_depth - distance)
                                                : std::abs(std::abs(answer.distance) - distance);
  }
  return place;
}

/// Draws places until one is in the band by its true distance and not beside a hole.
Vector3 draw(const Setting& setting, std::uint64_t index, Outcome& outcome) {
  Vector3 closest = Vector3::Zero();
  for (std::uint64_t attempt = 0; attempt < max_draws && !outcome.drawn; ++attempt) {
    const std::uint64_t counter = 4 * (index * max_draws + attempt);
    const SurfacePoint start = setting.surface.at(random_unit(setting.seed, counter),
                                                  random_unit(setting.seed, counter + 1),
                                                  random_unit(setting.seed, counter + 2));
    const double offset = -setting.band.max_depth + (setting.band.max_depth + setting.band.margin) *
                                                        random_unit(setting.seed, counter + 3);
    outcome.point = setting.adversarial != nullptr
                        ? setting.adversarial->at(setting.seed, index * max_draws + attempt)
                        : Vector3(start.position + offset * start.normal);
    closest = setting.adversarial != nullptr
                  ? setting.surface.closest(outcome.point).position
                  : setting.surface.closest(outcome.point, start).position;
    const double distance = (outcome.point - closest).norm();
    // The side is computed last, since that takes by far the longest.
    if (distance > std::max(setting.band.max_depth, setting.band.margin)) continue;
    if (setting.surface.border_distance(closest) < setting.near_hole) {
      outcome.near_holes.push_back(judge_near_hole(setting, outcome.point, distance));
      continue;
    }
    outcome.truth = setting.surface.inside(outcome.point) ? -distance : distance;
    if (outcome.truth < -setting.band.max_depth || outcome.truth > setting.band.margin) continue;
    outcome.drawn = true;
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
  const Vector3 closest = draw(setting, index, outcome);
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
  const ExactSurface surface(mesh);
  const std::optional<ExactSurface> before =
      unsmoothed != nullptr ? std::optional<ExactSurface>(std::in_place, *unsmoothed)
                            : std::nullopt;
  if (surface.empty()) {
    throw BakeError(ExitCode::invalid_input,
                    mesh.path +
                        ": no part of its surface bounds a solid; close the mesh or turn its "
                        "triangles outward");
  }
  // The fit uses the same generator. A different seed keeps the two sets of places apart.
  const Setting setting{surface,
                        before ? &*before : nullptr,
                        view,
                        band,
                        metadata.tolerance.value_or(metadata.diagonal / 1000),
                        hole_share * metadata.diagonal,
                        random_bits(options.seed, 0x7665726966790000ULL)};
  const auto measured = [&](const Setting& how, std::uint64_t count) {
    std::vector<Outcome> outcomes(count);
    tbb::parallel_for(std::size_t{0}, outcomes.size(),
                      [&](std::size_t i) { outcomes[i] = measure(how, i); });
    return outcomes;
  };
  const std::vector<Outcome> first = measured(setting, std::min(options.samples, first_samples));
  if (std::none_of(first.begin(), first.end(), [](const Outcome& o) { return o.drawn; })) {
    throw BakeError(ExitCode::invalid_input,
                    mesh.path +
                        ": no place to measure: everywhere is within 3 % of the diagonal of a "
                        "border edge; close the mesh's holes");
  }
  const std::vector<Outcome> outcomes = measured(setting, options.samples);
  Setting hard = setting;
  const AdversarialPlaces places(surface, view, setting.tolerance);
  hard.adversarial = &places;
  hard.seed = random_bits(setting.seed, 1);
  const std::vector<Outcome> hard_outcomes = measured(hard, options.samples / 2);
  VerifyReport report = report_of(outcomes, setting.tolerance);
  const VerifyReport hardest = report_of(hard_outcomes, setting.tolerance);
  report.adversarial = {
      hardest.samples,           hardest.counts,     hardest.distance,   hardest.inside_as_outside,
      hardest.outside_as_inside, hardest.unanswered, hardest.worst_point};
  report.near_holes_judged = near_holes_of(outcomes, hard_outcomes, setting.tolerance);
  report.jumps = border_jumps(
      {surface, view, band, setting.tolerance, setting.near_hole, random_bits(setting.seed, 2)},
      options.samples / 4);
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
  Mesh mesh = load_mesh(mesh_path, LoadOptions{metadata.mesh_unit, std::nullopt, true});
  for (Vector3& vertex : mesh.vertices) vertex *= metadata.scale;
  mesh.box_min *= metadata.scale;
  mesh.box_max *= metadata.scale;
  mesh.diagonal *= metadata.scale;
  return mesh;
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
