// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/asset/asset_view.hpp"
#include "common/base/error.hpp"

namespace spm {

/// Checks what a query reads of an asset: that every grid cell leads to a whole list, splits at
/// most split_levels deep, every list to maps, layers, tiles and triangles that exist, and that no
/// sample is NaN, none of a `sparse` asset and no triangle infinite. Errors: invalid_input, `path`
/// in front.
[[nodiscard]] Result<void> check_content(const AssetView& asset, const std::string& path);

}  // namespace spm
