// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/contact/coulomb_friction.hpp"
#include "common/contact/runtime_smoothing.hpp"
#include "common/contact/surface_texture.hpp"
#include "common/contact/turn_limit.hpp"

namespace spm {

/// The effects beside the reaction force (section 4). Each is off where its first number is 0, and
/// then costs one comparison.
struct EffectSettings {
  FrictionSettings friction;  ///< Coulomb's, with stick and slip
  double damping = 0;         ///< N s/m, 0 or more: k_d of eq. 18, in contact
  TextureSettings texture;    ///< noise in space
  RuntimeSmoothing smoothing;
  TurnLimit turn;  ///< of the force direction of `spm`
  // The effects to the paper's letter, for the method `paper` only:
  double friction_force = 0;  ///< N: f_c of eq. 17
  double friction_depth = 0;  ///< 1/m: k_f of eq. 17
  double texture_noise = 0;   ///< m: standard deviation of n_g of eq. 19
  std::uint64_t noise_seed = 0;

  [[nodiscard]] bool any() const noexcept {
    return friction.stick > 0 || friction.slide > 0 || damping > 0 || texture.amplitude > 0 ||
           friction_force > 0 || texture_noise > 0;
  }
};

}  // namespace spm
