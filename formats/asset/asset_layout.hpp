// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "formats/asset/asset.hpp"
#include "formats/asset/asset_json.hpp"
#include "formats/exr/exr_index.hpp"

namespace spm {

/// Builds the tables of pointers into a mapped file from its indexed parts and its description.
/// Both were checked before; this function checks that they agree in parts, channels, sizes and
/// tiles. Errors: invalid_input, with `path` in front.
[[nodiscard]] Result<AssetTables> lay_out(std::span<const std::byte> bytes,
                                          const std::vector<ExrPart>& parts,
                                          const AssetDescription& description,
                                          const std::string& path);

}  // namespace spm
