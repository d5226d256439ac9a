// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "baker/build/build_request.hpp"

namespace spm::baker {

/// What decides the bytes of an asset and the report of its build.
// NOLINTNEXTLINE(bugprone-exception-escape): a JSON value allocates while it is destroyed.
struct CacheKey {
  nlohmann::ordered_json parts;  ///< each thing by its name
  std::string digest;            ///< SHA-256 of the parts: 64 hex digits
};

/// The key of a build of mesh bytes. `request.bake` must have its limits derived already, so that a
/// change of a scene that leaves them alone changes no key. No path, thread count or time limit is
/// in it.
[[nodiscard]] CacheKey cache_key(const BuildRequest& request, const std::string& mesh_sha256);

/// Which parts differ, in words: "max_depth was 0.002 and is 0.001". Empty where none does.
[[nodiscard]] std::string difference(const nlohmann::ordered_json& before,
                                     const nlohmann::ordered_json& after);

}  // namespace spm::baker
