// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/scene_difference.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>

namespace spm::servo {

namespace {

constexpr std::size_t nobody = std::numeric_limits<std::size_t>::max();

// Members are bound by name and count, so that a member that is added to these structs does not
// compile here until it is compared.

bool same_pose(const Placement& a, const Placement& b) {
  return a.position == b.position && a.rotation.coeffs() == b.rotation.coeffs();
}

bool same_friction(const EffectSettings& a, const EffectSettings& b) {
  const auto& [stick_a, slide_a, stiffness_a] = a.friction;
  const auto& [stick_b, slide_b, stiffness_b] = b.friction;
  return std::tie(stick_a, slide_a, stiffness_a, a.friction_force, a.friction_depth) ==
         std::tie(stick_b, slide_b, stiffness_b, b.friction_force, b.friction_depth);
}

bool same_texture(const EffectSettings& a, const EffectSettings& b) {
  const auto& [amplitude_a, wavelength_a, seed_a] = a.texture;
  const auto& [amplitude_b, wavelength_b, seed_b] = b.texture;
  return std::tie(amplitude_a, wavelength_a, seed_a, a.texture_noise, a.noise_seed) ==
         std::tie(amplitude_b, wavelength_b, seed_b, b.texture_noise, b.noise_seed);
}

bool same_smoothing(const RuntimeSmoothing& a, const RuntimeSmoothing& b) {
  const auto& [sigma_a, samples_a] = a;
  const auto& [sigma_b, samples_b] = b;
  return std::tie(sigma_a, samples_a) == std::tie(sigma_b, samples_b);
}

bool same_turn(const TurnLimit& a, const TurnLimit& b) {
  const auto& [rate_a, jump_a, step_a] = a;
  const auto& [rate_b, jump_b, step_b] = b;
  return std::tie(rate_a, jump_a, step_a) == std::tie(rate_b, jump_b, step_b);
}

std::uint32_t bit(bool same, ObjectAspect aspect) { return same ? 0 : std::uint32_t{aspect}; }

std::uint32_t aspects_of_force(const ForceSettings& a, const ForceSettings& b) {
  const auto& [method_a, rule_a, stiffness_a, radius_a, kind_a, form_a, length_a, axis_a,
               density_a] = a;
  const auto& [method_b, rule_b, stiffness_b, radius_b, kind_b, form_b, length_b, axis_b,
               density_b] = b;
  return bit(std::tie(method_a, rule_a) == std::tie(method_b, rule_b), aspect_method) |
         bit(std::tie(stiffness_a, density_a) == std::tie(stiffness_b, density_b),
             aspect_stiffness) |
         bit(std::tie(form_a, kind_a, radius_a, length_a, axis_a) ==
                 std::tie(form_b, kind_b, radius_b, length_b, axis_b),
             aspect_probe);
}

std::uint32_t aspects_of_effects(const EffectSettings& a, const EffectSettings& b) {
  // Members that are not named here belong to friction and texture.
  const auto& [friction_a, damping_a, texture_a, smoothing_a, turn_a, force_a, depth_a, noise_a,
               seed_a] = a;
  return bit(same_friction(a, b), aspect_friction) | bit(damping_a == b.damping, aspect_damping) |
         bit(same_texture(a, b), aspect_texture) |
         bit(same_smoothing(smoothing_a, b.smoothing), aspect_smoothing) |
         bit(same_turn(turn_a, b.turn), aspect_turn_limit);
}

/// Matches the objects of one list with those of the other.
class Matching {
 public:
  Matching(std::span<const PlacedObject> before, std::span<const PlacedObject> after)
      : before_(before), after_(after), taken_(before.size(), false), like_(after.size(), nobody) {}

  /// Matches objects that satisfy `alike` and are at the same place of both lists.
  template <class Alike>
  void at_same_place(const Alike& alike) {
    for (std::size_t i = 0; i < std::min(before_.size(), after_.size()); ++i) {
      if (like_[i] == nobody && !taken_[i] && alike(before_[i], after_[i])) match(i, i);
    }
  }

  /// Matches objects that satisfy `alike`, in the order of the lists.
  template <class Alike>
  void in_order(const Alike& alike) {
    for (std::size_t after = 0; after < after_.size(); ++after) {
      for (std::size_t i = 0; i < before_.size() && like_[after] == nobody; ++i) {
        if (!taken_[i] && alike(before_[i], after_[after])) match(i, after);
      }
    }
  }

  [[nodiscard]] SceneDifference difference() const {
    SceneDifference difference;
    for (std::size_t after = 0; after < after_.size(); ++after) {
      const std::size_t i = like_[after];
      if (i == nobody) {
        difference.added.push_back(after);
      } else {
        difference.kept.push_back({i, after, aspects_of(before_[i], after_[after])});
      }
    }
    for (std::size_t i = 0; i < before_.size(); ++i) {
      if (!taken_[i]) difference.removed.push_back(i);
    }
    return difference;
  }

 private:
  void match(std::size_t before, std::size_t after) {
    like_[after] = before;
    taken_[before] = true;
  }

  std::span<const PlacedObject> before_, after_;
  std::vector<bool> taken_;        ///< of the old list
  std::vector<std::size_t> like_;  ///< for the new list: the place in the old one
};

}  // namespace

std::uint32_t aspects_of(const PlacedObject& before, const PlacedObject& after) {
  const auto& [asset, placement, force, effects, movable, chosen] = before;
  return bit(same_pose(placement, after.placement), aspect_pose) |
         bit(placement.scale == after.placement.scale, aspect_scale) |
         aspects_of_force(force, after.force) | aspects_of_effects(effects, after.effects) |
         bit(chosen == after.stiffness_chosen, aspect_stiffness) |
         bit(movable == after.movable, aspect_movable);
}

std::string names_of_aspects(std::uint32_t aspects) {
  constexpr std::array names{"pose",    "scale",   "method",    "stiffness",  "probe",  "friction",
                             "damping", "texture", "smoothing", "turn_limit", "movable"};
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (((aspects >> i) & 1U) != 0) text += (text.empty() ? "" : ", ") + std::string(names[i]);
  }
  return text;
}

bool SceneDifference::empty() const {
  return removed.empty() && added.empty() &&
         std::all_of(kept.begin(), kept.end(),
                     [](const KeptObject& object) { return object.aspects == 0; });
}

SceneDifference scene_difference(std::span<const PlacedObject> before,
                                 std::span<const PlacedObject> after) {
  const auto same_asset = [](const PlacedObject& a, const PlacedObject& b) {
    return a.asset == b.asset;
  };
  const auto equal = [](const PlacedObject& a, const PlacedObject& b) {
    return a.asset == b.asset && aspects_of(a, b) == 0;
  };
  Matching matching(before, after);
  matching.at_same_place(equal);
  matching.in_order(equal);
  matching.at_same_place(same_asset);
  matching.in_order(same_asset);
  return matching.difference();
}

}  // namespace spm::servo
