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
#include "baker/smooth/smooth.hpp"
#include "baker/verify/adversarial.hpp"
#include "baker/verify/exact_surface.hpp"
#include "common/base/random.hpp"
#include "common/base/units.hpp"
#include "common/query/query.hpp"
#include "formats/files/sha256.hpp"

namespace spm::baker {
namespace {

constexpr double hole_share = 0.03;    // of the diagonal
constexpr double min_distance = 2e-6;  // m; nearer the direction is lost in rounding
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
  bool adversarial = false;  ///< where the asset is likeliest wrong, not evenly all over
};

/// One sample and the asset's result there.
struct Outcome {
  bool drawn = false;  ///< a place in the band and away from holes was found
  std::uint32_t near_holes = 0;
  Vector3 point = Vector3::Zero();
  double truth = 0;
  bool answered = false;
  bool far = false;     ///< the asset answers: outside, beyond the margin
  bool pruned = false;  ///< the bake left this place out
  double answer = 0;
  double error = 0;
  double smoothing_error = 0;
  double total_error = 0;
  Source source = Source::none;
  double direction_error = -1;  ///< rad; negative where no direction is defined or answered
  bool contested = false;
};

/// The change by smoothing at a sample's place, alone and together with the asset's own error.
void judge_smoothing(const ExactSurface& unsmoothed, Outcome& outcome) {
  const double distance = (outcome.point - unsmoothed.closest(outcome.point).position).norm();
  const double truth = unsmoothed.inside(outcome.point) ? -distance : distance;
  outcome.smoothing_error = std::abs(outcome.truth - truth);
  outcome.total_error = outcome.answered ? std::abs(outcome.answer - truth) : 0;
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
    outcome.point = setting.adversarial
                        ? adversarial_place(setting.surface, setting.view, setting.tolerance,
                                            setting.seed, index * max_draws + attempt)
                        : Vector3(start.position + offset * start.normal);
    closest = setting.surface.closest(outcome.point).position;
    const double distance = (outcome.point - closest).norm();
    // The side is computed last, since that takes by far the longest.
    if (distance > std::max(setting.band.max_depth, setting.band.margin)) continue;
    if (setting.surface.border_distance(closest) < setting.near_hole) {
      ++outcome.near_holes;
      continue;
    }
    outcome.truth = setting.surface.inside(outcome.point) ? -distance : distance;
    if (outcome.truth < -setting.band.max_depth || outcome.truth > setting.band.margin) continue;
    outcome.drawn = true;
  }
  return closest;
}

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
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

void judge_direction(const Setting& setting, const Vector3& closest, const Answer& answer,
                     Outcome& outcome) {
  outcome.contested = std::abs(outcome.truth) < min_distance ||
                      setting.surface.contested(outcome.point, closest, 2 * setting.tolerance);
  if (outcome.contested || answer.normal.squaredNorm() == 0) return;
  const Vector3 away =
      outcome.truth > 0 ? Vector3(outcome.point - closest) : Vector3(closest - outcome.point);
  outcome.direction_error = angle_between(answer.normal, away);
}

Outcome measure(const Setting& setting, std::uint64_t index) {
  Outcome outcome;
  const Vector3 closest = draw(setting, index, outcome);
  if (!outcome.drawn) return outcome;
  const Answer answer = query_point(setting.view, outcome.point);
  judge_distance(setting, answer, outcome);
  judge_direction(setting, closest, answer, outcome);
  if (setting.unsmoothed != nullptr) judge_smoothing(*setting.unsmoothed, outcome);
  return outcome;
}

/// Nearest-rank quantile of sorted values; 0 where there are none.
double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  const auto index = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  return sorted[std::min(index, sorted.size() - 1)];
}

double share_of(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

ErrorSummary summarise(std::vector<double> errors) {
  ErrorSummary summary;
  double squares = 0;
  for (const double error : errors) squares += error * error;
  if (!errors.empty()) summary.rms = std::sqrt(squares / static_cast<double>(errors.size()));
  std::sort(errors.begin(), errors.end());
  summary.p50 = quantile(errors, 0.5);
  summary.p99 = quantile(errors, 0.99);
  summary.p999 = quantile(errors, 0.999);
  summary.max = errors.empty() ? 0 : errors.back();
  return summary;
}

/// True where an inside sample was answered as outside, or the other way round.
bool wrong_side(const Outcome& outcome) {
  const bool outside = outcome.far || (outcome.answered && outcome.answer > 0);
  if (outcome.truth < 0) return outside;
  return outcome.answered && !outside;
}

/// Adds the changes by smoothing to a report.
void add_smoothing(const std::vector<Outcome>& outcomes, VerifyReport& report) {
  std::vector<double> smoothing, total;
  for (const Outcome& outcome : outcomes) {
    if (!outcome.drawn) continue;
    smoothing.push_back(outcome.smoothing_error);
    if (outcome.answered) total.push_back(outcome.total_error);
  }
  report.smoothing = summarise(std::move(smoothing));
  report.total = summarise(std::move(total));
}

VerifyReport reduce(const std::vector<Outcome>& outcomes, double tolerance) {
  VerifyReport report;
  std::vector<double> errors;
  std::vector<double> angles;
  std::uint64_t near_holes = 0, contested = 0, from_triangles = 0, pruned = 0;
  std::uint64_t clear = 0, inside_wrong = 0, outside_wrong = 0;
  double worst = -1;
  for (const Outcome& outcome : outcomes) {
    near_holes += outcome.near_holes;
    if (!outcome.drawn) continue;
    ++report.samples;
    contested += outcome.contested ? 1 : 0;
    pruned += outcome.pruned ? 1 : 0;
    if (outcome.direction_error >= 0) angles.push_back(outcome.direction_error);
    if (std::abs(outcome.truth) > tolerance) {
      ++clear;
      if (wrong_side(outcome)) ++(outcome.truth < 0 ? inside_wrong : outside_wrong);
    }
    if (!outcome.answered) continue;
    errors.push_back(outcome.error);
    from_triangles += outcome.source == Source::triangles ? 1 : 0;
    if (outcome.error > worst) {
      worst = outcome.error;
      report.worst_point = outcome.point;
    }
  }
  report.unanswered = share_of(report.samples - errors.size() - pruned, report.samples);
  report.pruned = share_of(pruned, report.samples);
  report.fallback_answers = share_of(from_triangles, errors.size());
  report.near_holes = share_of(near_holes, near_holes + report.samples);
  report.direction_contested = share_of(contested, report.samples);
  report.inside_as_outside = share_of(inside_wrong, clear);
  report.outside_as_inside = share_of(outside_wrong, clear);
  report.distance = summarise(std::move(errors));
  std::sort(angles.begin(), angles.end());
  report.direction_p50 = quantile(angles, 0.5);
  report.direction_p99 = quantile(angles, 0.99);
  report.direction_max = angles.empty() ? 0 : angles.back();
  return report;
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
  VerifyReport report = reduce(outcomes, setting.tolerance);
  Setting hard = setting;
  hard.adversarial = true;
  hard.seed = random_bits(setting.seed, 1);
  const VerifyReport hardest = reduce(measured(hard, options.samples / 2), setting.tolerance);
  report.adversarial = {hardest.samples,           hardest.distance,   hardest.inside_as_outside,
                        hardest.outside_as_inside, hardest.unanswered, hardest.worst_point};
  if (before) add_smoothing(outcomes, report);
  report.band = band;
  return report;
}

Mesh mesh_of_asset(const AssetMetadata& metadata, const std::string& mesh_path) {
  const Result<std::string> hash = sha256_file(mesh_path);
  if (!hash) throw BakeError(hash.error().code, hash.error().message);
  if (*hash != metadata.mesh_sha256) {
    throw BakeError(ExitCode::invalid_input,
                    mesh_path +
                        ": not the mesh that the asset was baked from (its SHA-256 differs); "
                        "give that mesh, or bake this one");
  }
  Mesh mesh = load_mesh(mesh_path, LoadOptions{metadata.mesh_unit, std::nullopt});
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
