// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/contact/effect_settings.hpp"
#include "common/contact/force_law.hpp"

namespace spm {

/// What settings ask for that their method does not have.
enum class MethodMismatch : std::uint8_t {
  none,
  probe,            ///< spm and proxy know a point and a ball
  ruled_probe,      ///< the paper's other rules are for a point
  volume_of_point,  ///< which has none
  friction,         ///< by `stick` and `slide`: not of paper
  texture,          ///< by amplitude and wavelength: not of paper
  paper_friction,   ///< by force and gain: of paper alone
  paper_texture,    ///< by noise: of paper alone
  density,          ///< of paper alone
  smoothing,        ///< of spm alone
};

/// The first that is found, in this order.
[[nodiscard]] MethodMismatch mismatch_of(const ForceSettings& settings,
                                         const EffectSettings& effects) noexcept;

}  // namespace spm
