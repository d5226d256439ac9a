// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene_effects.hpp"

#include <limits>

namespace spm {

namespace {

constexpr double max_friction = 10;  // dry rubber has about 1
constexpr auto largest_seed = static_cast<std::uint64_t>(
    std::numeric_limits<std::int64_t>::max());  // the largest integer of TOML

void read_paper_friction(TableReader& friction, EffectSettings& effects) {
  for (const char* key : {"stick", "slide", "stiffness"}) {
    if (friction.has(key)) {
      return friction.refuse(key,
                             "'force' and 'depth_gain' are the paper's friction, 'stick', 'slide' "
                             "and 'stiffness' Coulomb's; give those of one kind");
    }
  }
  if (!friction.has("force")) {
    return friction.refuse("depth_gain", "'depth_gain' needs 'force', such as \"0.3N\"");
  }
  effects.friction_force =
      friction.quantity("force", Quantity::force, "0.3N", 0, TableReader::Minimum::zero);
  effects.friction_depth =
      friction.quantity("depth_gain", Quantity::per_length, "100/m", 0, TableReader::Minimum::zero);
}

void read_friction(TableReader& object, double stiffness, EffectSettings& effects) {
  auto friction = object.table("friction", "{ stick = 0.5, slide = 0.4 }",
                               {"stick", "slide", "stiffness", "force", "depth_gain"});
  if (!friction) return;
  if (friction->has("force") || friction->has("depth_gain")) {
    return read_paper_friction(*friction, effects);
  }
  if (!friction->has("stick") && !friction->has("slide")) {
    return object.refuse("friction",
                         "'friction' needs 'slide', mu in motion, or 'stick', mu at rest; or, for "
                         "method paper, 'force'");
  }
  // Where one of the two is not given, both are the same.
  FrictionSettings& read = effects.friction;
  read.stick = friction->number("stick", 0, max_friction, 0);
  read.slide = friction->number("slide", 0, max_friction, read.stick);
  if (!friction->has("stick")) read.stick = read.slide;
  read.stiffness = friction->quantity("stiffness", Quantity::stiffness, "2N/mm", stiffness);
  if (read.stick < read.slide) {
    friction->refuse("stick",
                     "'stick' is less than 'slide'; friction at rest is at least that in "
                     "motion");
  }
}

void read_texture(TableReader& object, EffectSettings& effects) {
  auto texture = object.table("texture", "{ amplitude = \"50um\", wavelength = \"1mm\" }",
                              {"amplitude", "wavelength", "seed", "noise"});
  if (!texture) return;
  const std::uint64_t seed = texture->whole("seed", 0, largest_seed, 0);
  if (texture->has("noise")) {
    if (texture->has("amplitude") || texture->has("wavelength")) {
      return texture->refuse("noise",
                             "'noise' is the paper's texture, 'amplitude' and 'wavelength' that in "
                             "space; give those of one kind");
    }
    effects.texture_noise =
        texture->quantity("noise", Quantity::length, "10um", 0, TableReader::Minimum::zero);
    effects.noise_seed = seed;
    return;
  }
  for (const char* key : {"amplitude", "wavelength"}) {
    if (!texture->has(key)) {
      return object.refuse("texture",
                           "'texture' needs 'amplitude' and 'wavelength'; or, for method paper, "
                           "'noise'");
    }
  }
  effects.texture.amplitude =
      texture->quantity("amplitude", Quantity::length, "50um", 0, TableReader::Minimum::zero);
  effects.texture.wavelength = texture->quantity("wavelength", Quantity::length, "1mm", 1);
  effects.texture.seed = seed;
}

void read_smoothing(TableReader& object, EffectSettings& effects) {
  auto smoothing = object.table("smoothing", "{ sigma = \"0.2mm\" }", {"sigma", "samples"});
  if (!smoothing) return;
  if (!smoothing->has("sigma")) {
    return object.refuse("smoothing", "'smoothing' needs 'sigma', such as \"0.2mm\"");
  }
  effects.smoothing.sigma =
      smoothing->quantity("sigma", Quantity::length, "0.2mm", 0, TableReader::Minimum::zero);
  effects.smoothing.samples = static_cast<std::uint32_t>(
      smoothing->whole("samples", 1, max_smoothing_samples, effects.smoothing.samples));
}

}  // namespace

EffectSettings read_effects(TableReader& object, double stiffness) {
  EffectSettings effects;
  read_friction(object, stiffness, effects);
  effects.damping =
      object.quantity("damping", Quantity::damping, "2Ns/m", 0, TableReader::Minimum::zero);
  read_texture(object, effects);
  read_smoothing(object, effects);
  effects.turn.rate = object.quantity("turn_limit", Quantity::angular_speed, "120rad/s",
                                      default_turn_rate, TableReader::Minimum::zero);
  return effects;
}

}  // namespace spm
