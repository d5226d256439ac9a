// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/contact/effect_settings.hpp"
#include "formats/scene/table_reader.hpp"

namespace spm {

/// Reads `friction`, `damping`, `texture`, `smoothing` and `turn_limit` of an object; these must be
/// among the reader's keys. formats/scene/KEYS.md describes their values. `stiffness` (N/m) holds a
/// point that sticks where the scene gives no other. Errors go to the reader.
[[nodiscard]] EffectSettings read_effects(TableReader& object, double stiffness);

}  // namespace spm
