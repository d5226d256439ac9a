// SPDX-License-Identifier: Apache-2.0
#include "common/contact/method_mismatch.hpp"

#include <algorithm>

namespace spm {

MethodMismatch mismatch_of(const ForceSettings& settings, const EffectSettings& effects) noexcept {
  const ProbeShape probe = settings.probe();
  if (settings.method == Method::paper) {
    if (settings.rule != PaperRule::closest_plane && probe.radius > 0) {
      return MethodMismatch::ruled_probe;
    }
    if (settings.form == PaperProbeForm::volume && probe.radius == 0) {
      return MethodMismatch::volume_of_point;
    }
    if (std::max(effects.friction.stick, effects.friction.slide) > 0) {
      return MethodMismatch::friction;
    }
    if (effects.texture.amplitude > 0) return MethodMismatch::texture;
  } else {
    if (probe.paper_only()) return MethodMismatch::probe;
    if (effects.friction_force > 0) return MethodMismatch::paper_friction;
    if (effects.texture_noise > 0) return MethodMismatch::paper_texture;
    if (settings.density != 1) return MethodMismatch::density;
  }
  const bool smooth = effects.smoothing.sigma > 0;
  return settings.method != Method::spm && smooth ? MethodMismatch::smoothing
                                                  : MethodMismatch::none;
}

}  // namespace spm
