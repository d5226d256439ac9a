// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/asset/mapped_asset.hpp"

namespace spm::baker {

/// What is in an asset, as `spm-bake info --json` says it; `pictures` are the paths of those that
/// were made of it.
[[nodiscard]] nlohmann::ordered_json to_json(const MappedAsset& asset,
                                             const std::vector<std::string>& pictures);

}  // namespace spm::baker
