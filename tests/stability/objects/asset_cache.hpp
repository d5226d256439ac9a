// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "baker/mesh/mesh.hpp"
#include "baker/pipeline/bake.hpp"
#include "formats/asset/mapped_asset.hpp"

namespace spm::stability {

/// Where baked files are kept: the folder that SPM_STABILITY_CACHE names, else spm-stability in the
/// user's cache folder, else in the system's temporary one.
[[nodiscard]] std::string cache_folder();

/// A mesh's `sparse` asset: opened where this very build of the program has baked it before,
/// otherwise baked and kept. `content` names the mesh's bytes; of the options tolerance, depth and
/// probe may differ. What earlier builds kept is removed: no asset outlives the baker that made it.
/// Throws BakeError.
[[nodiscard]] std::unique_ptr<MappedAsset> cached_asset(const baker::Mesh& mesh,
                                                        const std::string& content,
                                                        const baker::BakeOptions& options);

}  // namespace spm::stability
