// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/batch/manifest.hpp"
#include "common/base/error.hpp"

namespace spm::baker {

/// What one output is made from.
struct Dependencies {
  std::string output;
  std::vector<std::string> inputs;
};

[[nodiscard]] Dependencies dependencies_of(const BuildRequest& request);

/// Of every asset: its mesh, its scene, the manifest, and the folders where patterns look for
/// meshes, but for those that outputs are written to.
[[nodiscard]] std::vector<Dependencies> dependencies_of(const Manifest& manifest);

/// Rules as make and ninja read them, with an empty rule for each input, so that one that was
/// deleted ends no build.
[[nodiscard]] std::string depfile_text(const std::vector<Dependencies>& dependencies);

/// Writes such a file; it is left alone where it has that text already. Errors: file_or_device.
[[nodiscard]] Result<void> write_depfile(const std::string& path,
                                         const std::vector<Dependencies>& dependencies);

}  // namespace spm::baker
