// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/commands/build_request.hpp"
#include "common/base/error.hpp"

namespace spm::baker {

/// One `[[asset]]` of a manifest.
struct ManifestEntry {
  std::string name;
  BuildRequest request;  ///< paths made relative to the manifest's folder
};

/// Reads a manifest (TOML): `[[asset]]` tables with `mesh`, `output` and optionally `name`
/// (default: the output's file name up to its first dot). Any option of `build` may stand there by
/// its long name, with its unit in a string. Errors: file_or_device; invalid_input, which names the
/// line and, for a misspelt key, the key that was probably meant.
[[nodiscard]] Result<std::vector<ManifestEntry>> read_manifest(const std::string& path);

}  // namespace spm::baker
