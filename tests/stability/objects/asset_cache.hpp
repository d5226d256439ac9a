// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "baker/mesh/mesh.hpp"
#include "baker/pipeline/bake.hpp"
#include "formats/asset/mapped_asset.hpp"

namespace spm::stability {

/// Where baked files are kept: the folder named by SPM_STABILITY_CACHE; else spm-stability in the
/// user's cache folder; else in the system's temporary folder.
[[nodiscard]] std::string cache_folder();

/// A mesh's `sparse` asset. It is opened if this very build of the program has baked it before,
/// otherwise baked and kept. `content` names the mesh's bytes. Of the options, only tolerance,
/// depth and probe may differ. Files kept by earlier builds are removed, so no asset outlives the
/// baker that made it. Throws BakeError.
[[nodiscard]] std::unique_ptr<MappedAsset> cached_asset(const baker::Mesh& mesh,
                                                        const std::string& content,
                                                        const baker::BakeOptions& options);

}  // namespace spm::stability
