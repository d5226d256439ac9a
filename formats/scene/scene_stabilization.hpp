// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/device_profile.hpp"
#include "common/contact/stabilization_settings.hpp"
#include "formats/scene/table_reader.hpp"

namespace spm {

/// The keys of `[stabilization]`.
inline constexpr std::initializer_list<const char*> stabilization_keys{
    "recommended",      "damping",   "delay",    "coupling",
    "coupling_damping", "passivity", "velocity", "potential"};

/// Reads `[stabilization]` of a scene; formats/scene/KEYS.md lists its keys. `device` is the
/// profile whose mass bounds the damping; null where the scene names none. Errors go to the reader.
[[nodiscard]] StabilizationSettings read_stabilization(TableReader& stabilization,
                                                       const DeviceProfile* device);

}  // namespace spm
