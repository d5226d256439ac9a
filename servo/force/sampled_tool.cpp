// SPDX-License-Identifier: Apache-2.0
#include "servo/force/sampled_tool.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/sixdof/sample_vectors.hpp"

namespace spm {

namespace {

/// Samples where neither their number nor their spacing is named, about.
constexpr double chosen_samples = 8000;
/// More samples than this take longer to look at than a tick lasts.
constexpr std::size_t most_samples = 2'000'000;
constexpr int spacing_trials = 8;
/// m of the world: samples that are nearer to each other tell no more, as fields have errors of
/// that size; and all of a tool that is as small would touch at once, more than a tick has time
/// for.
constexpr double least_spacing = 1e-5;
/// Of a tool's size: its samples are no farther apart for that.
constexpr double least_parts = 4;
/// A tool whose volume is a smaller part of its surface times its radius than this is a sheet.
constexpr double least_fullness = 1e-5;

/// By the divergence theorem, m3.
double volume_of(const SurfaceSamples& samples) noexcept {
  double volume = 0;
  const SampleLevel& finest = samples.levels.back();
  for (std::uint32_t i = finest.first; i < finest.first + finest.count; ++i) {
    const Vector3 arm = vector_of(samples.places[i].position) - samples.centre;
    volume += static_cast<double>(samples.shares[i].area) * arm.dot(samples.shares[i].normal());
  }
  return volume / 3;
}

/// A part of the largest number of samples that is near enough to it.
constexpr double close = 0.9;

/// Samples at most as many as asked for, where `spacing` gives more. Their number falls by jumps
/// where faces take up samples in rows: first the spacing grows until they are few enough, and then
/// the place of the jump is halved in on. Where even one cube around the whole tool has more,
/// these. `around`, m: the edge of such a cube.
Result<SurfaceSamples> fewer(SurfaceSampler& sampler, double around, std::size_t most,
                             double spacing) {
  constexpr int halvings = 12;
  const auto count = [](const SurfaceSamples& samples) { return samples.levels.back().count; };
  double step = 1.1, fits = spacing;
  Result<SurfaceSamples> best;
  do {
    spacing = fits;
    fits = std::min(around, fits * step);
    step *= step;
    best = sampler.sample(fits);
  } while (best && count(*best) > most && fits < around);
  for (int i = 0; best && i < halvings; ++i) {
    if (static_cast<double>(count(*best)) > close * static_cast<double>(most)) break;
    const double middle = std::sqrt(spacing * fits);
    Result<SurfaceSamples> tried = sampler.sample(middle);
    if (!tried) return tried;
    if (count(*tried) > most) {
      spacing = middle;
      continue;
    }
    fits = middle;
    if (count(*tried) > count(*best)) best = std::move(tried);
  }
  return best;
}

/// Samples within the largest number, or as many as are chosen.
Result<SurfaceSamples> sampled(const AssetView& asset, const ToolSettings& settings) {
  const double size = extent_of(asset).size.norm();
  double spacing = settings.spacing;
  SurfaceSampler sampler(asset);
  if (spacing > 0) return sampler.sample(spacing);
  const double wanted =
      settings.samples > 0 ? static_cast<double>(settings.samples) : chosen_samples;
  spacing = size / std::sqrt(wanted);
  const double least = std::min(least_spacing / settings.placement.scale, size / least_parts);
  const bool tiny = spacing < least;
  spacing = std::max(spacing, least);
  Result<SurfaceSamples> made = sampler.sample(spacing);
  for (int trial = 0; made && !tiny && trial < spacing_trials; ++trial) {
    const double share = static_cast<double>(made->levels.back().count) / wanted;
    if (share <= 1 && share > close) break;
    // A little coarser than would just do, since the number is an upper bound.
    spacing *= std::sqrt(share) * (share > 1 ? 1.02 : 1.01);
    made = sampler.sample(spacing);
  }
  const bool too_many =
      made && settings.samples > 0 && made->levels.back().count > settings.samples;
  return too_many ? fewer(sampler, 2 * size, settings.samples, spacing) : std::move(made);
}

/// The same samples in the frame of the device's tool, in metres of the world.
void place(SurfaceSamples& samples, const Placement& placement) {
  const double scale = placement.scale;
  const Eigen::Matrix3d rotation = placement.rotation.normalized().toRotationMatrix();
  const double reach =
      (placement.position + scale * (rotation * samples.centre)).norm() + scale * samples.radius;
  // Places are rounded to floats anew.
  const double rounding = 1e-6 * reach;
  for (SamplePlace& place : samples.places) {
    place.position = floats_of(placement.position + scale * (rotation * vector_of(place.position)));
    if (place.radius > 0) {
      place.radius =
          static_cast<float>((scale * static_cast<double>(place.radius) + rounding) * (1 + 1e-6));
    }
  }
  for (SampleShare& share : samples.shares) {
    share.packed_normal = pack_octahedral(rotation * share.normal());
    share.area = static_cast<float>(scale * scale * static_cast<double>(share.area));
  }
  for (SampleSpread& spread : samples.spreads) {
    spread.middle = floats_of(scale * (rotation * vector_of(spread.middle)));
    spread.spread = static_cast<float>(scale * static_cast<double>(spread.spread));
  }
  for (SampleLevel& level : samples.levels) {
    level.spacing *= scale;
    level.bound *= scale;
  }
  samples.area *= scale * scale;
  samples.centre = placement.position + scale * (rotation * samples.centre);
  samples.radius = scale * samples.radius + rounding;
}

}  // namespace

Result<std::unique_ptr<SampledTool>> SampledTool::make(const AssetView& asset,
                                                       const ToolSettings& settings,
                                                       std::size_t hands, std::size_t objects) {
  const Placement& placement = settings.placement;
  if (!(placement.scale > 0) || !std::isfinite(placement.scale) ||
      !placement.position.allFinite() || !(placement.rotation.norm() > 0)) {
    return fail(ExitCode::invalid_input,
                "the tool's pose or scale is not a number above 0; correct it in the scene");
  }
  if (settings.samples > most_samples) {
    return fail(ExitCode::invalid_input,
                fmt::format("{} samples are too many for a tool; give at most {}", settings.samples,
                            most_samples));
  }
  if (asset.maps_every_plane()) {
    std::unique_ptr<SampledTool> letter(new SampledTool);
    letter->paper_ = asset;
    letter->error_ = placement.scale * asset.tolerance;
    return letter;
  }
  Result<SurfaceSamples> samples = sampled(asset, settings);
  if (!samples) {
    return fail(ExitCode::invalid_input,
                "no tool can be made of the asset: " + samples.error().message);
  }
  const std::size_t count = samples->levels.empty() ? 0 : samples->levels.back().count;
  if (count == 0 || !(samples->area > 0)) {
    return fail(ExitCode::invalid_input,
                "the tool's asset has no surface to sample; bake it from a mesh with triangles");
  }
  if (settings.samples > 0 && count > settings.samples) {
    return fail(ExitCode::invalid_input,
                fmt::format("the tool's surface needs {} samples at the least, one for each side; "
                            "give that many 'samples' or more",
                            count));
  }
  if (count > most_samples) {
    return fail(ExitCode::invalid_input,
                fmt::format("the tool's spacing gives {} samples, more than {}; give a larger one",
                            count, most_samples));
  }
  if (volume_of(*samples) < least_fullness * samples->area * samples->radius) {
    return fail(ExitCode::invalid_input,
                "the tool's asset has no inside, so nothing can be in it; close its mesh and bake "
                "it again");
  }
  // Contact needs them above the finest level alone.
  samples->spreads.resize(samples->children.size());
  samples->spreads.shrink_to_fit();
  place(*samples, placement);
  std::unique_ptr<SampledTool> made(new SampledTool);
  made->samples_ = std::move(*samples);
  made->error_ = placement.scale * asset.tolerance;
  ObjectContactSettings contact;
  contact.objects = static_cast<std::uint32_t>(objects);
  made->contacts_.reserve(hands);
  made->hull_ = support_hull(made->samples_);
  made->cullings_.reserve(hands);
  for (std::size_t hand = 0; hand < hands; ++hand) {
    made->contacts_.emplace_back(made->samples_, contact);
    made->cullings_.emplace_back(made->hull_, objects);
  }
  return made;
}

double SampledTool::patch_size() const noexcept {
  // A sixth of the tool: its faces are told apart, the clusters of one face are not.
  constexpr double part = 1.0 / 3;
  return part * samples_.radius;
}

std::size_t SampledTool::bytes() const noexcept {
  std::size_t bytes = samples_.bytes();
  for (const ObjectContact& contact : contacts_) bytes += contact.bytes();
  return bytes;
}

}  // namespace spm
