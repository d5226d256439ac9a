// SPDX-License-Identifier: Apache-2.0
#include "servo/force/felt_object.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/smooth_change.hpp"

namespace spm {

namespace {

/// The numbers of an object's effects that go over into others.
template <class Effects>
auto numbers_of(Effects& effects) noexcept {
  return std::array{&effects.friction.stick, &effects.friction.slide, &effects.friction.stiffness,
                    &effects.damping,        &effects.friction_force, &effects.friction_depth,
                    &effects.texture_noise};
}

bool same_numbers(const PlacedObject& one, const PlacedObject& other) noexcept {
  const auto mine = numbers_of(one.effects), theirs = numbers_of(other.effects);
  const TextureSettings& texture = one.effects.texture;
  const TextureSettings& other_texture = other.effects.texture;
  return one.force.stiffness == other.force.stiffness &&
         std::equal(mine.begin(), mine.end(), theirs.begin(),
                    [](const double* a, const double* b) { return *a == *b; }) &&
         texture.amplitude == other_texture.amplitude &&
         texture.wavelength == other_texture.wavelength && texture.seed == other_texture.seed;
}

constexpr double any_step = std::numeric_limits<double>::infinity();

/// Another pattern comes once the old one is flat.
void step_texture(TextureSettings& felt, const TextureSettings& from, const TextureSettings& wanted,
                  double share) noexcept {
  const bool same = felt.wavelength == wanted.wavelength && felt.seed == wanted.seed;
  if (same) {
    // Where the pattern was exchanged, the way to the new height began at none.
    const bool exchanged = from.wavelength != wanted.wavelength || from.seed != wanted.seed;
    const double begun = exchanged ? 0 : from.amplitude;
    felt.amplitude = stepped(felt.amplitude, begun, wanted.amplitude, share, any_step);
    return;
  }
  felt.amplitude = stepped(felt.amplitude, from.amplitude, 0, share, any_step);
  if (felt.amplitude > 0) return;
  felt.wavelength = wanted.wavelength;
  felt.seed = wanted.seed;
}

}  // namespace

bool feels_alike(const PlacedObject& one, const PlacedObject& other) noexcept {
  const ForceSettings& mine = one.force;
  const ForceSettings& theirs = other.force;
  const EffectSettings& my = one.effects;
  const EffectSettings& their = other.effects;
  return one.asset == other.asset && one.placement.scale == other.placement.scale &&
         one.stiffness_chosen == other.stiffness_chosen && mine.method == theirs.method &&
         mine.rule == theirs.rule && mine.probe_radius == theirs.probe_radius &&
         mine.probe_kind == theirs.probe_kind && mine.form == theirs.form &&
         mine.probe_length == theirs.probe_length && mine.probe_axis == theirs.probe_axis &&
         mine.density == theirs.density && my.smoothing.sigma == their.smoothing.sigma &&
         my.turn.rate == their.turn.rate && my.turn.jump == their.turn.jump &&
         my.turn.step == their.turn.step && my.noise_seed == their.noise_seed;
}

bool feels_the_same(const PlacedObject& one, const PlacedObject& other) noexcept {
  return feels_alike(one, other) && same_numbers(one, other);
}

void step_towards(PlacedObject& felt, const PlacedObject& from, const PlacedObject& wanted,
                  double seconds, double pressing) noexcept {
  const double share = change_share(seconds, 0);
  double& stiffness = felt.force.stiffness;
  const double goal = wanted.force.stiffness;
  const double most = pressing > 0 ? change_rate * seconds * stiffness / pressing : any_step;
  stiffness = stepped(stiffness, from.force.stiffness, goal, share, most);
  const auto begin = numbers_of(from.effects), end = numbers_of(wanted.effects);
  const auto now = numbers_of(felt.effects);
  for (std::size_t i = 0; i < now.size(); ++i)
    *now[i] = stepped(*now[i], *begin[i], *end[i], share, any_step);
  step_texture(felt.effects.texture, from.effects.texture, wanted.effects.texture, share);
}

}  // namespace spm
