// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/device_profile.hpp"
#include "common/contact/stabilization_settings.hpp"
#include "formats/scene/table_reader.hpp"

namespace spm {

/// The keys of `[cures]`.
inline constexpr std::initializer_list<const char*> cure_keys{
    "advised",          "damping",   "delay",    "coupling",
    "coupling_damping", "passivity", "velocity", "potential"};

/// Reads `[cures]` of a scene; formats/scene/KEYS.md lists its keys. `device` is the profile whose
/// mass bounds the damping; null where the scene names none. Errors go to the reader.
[[nodiscard]] CureSettings read_cures(TableReader& cures, const DeviceProfile* device);

}  // namespace spm
