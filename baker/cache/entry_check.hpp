// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/build/build_request.hpp"
#include "baker/cache/cache.hpp"
#include "common/base/error.hpp"

namespace spm::baker {

/// Holds an entry of a stranger against what was asked for. The asset must be intact, of this mesh
/// and these options; what it promises must be proven, as far as its certificate says so; and at
/// some thousand places its answers are compared with the mesh itself. `parts` are those of the
/// key. Errors: invalid_input, with the reason alone.
[[nodiscard]] Result<void> check_entry(const CacheEntry& entry, const nlohmann::ordered_json& parts,
                                       const BuildRequest& request);

}  // namespace spm::baker
