// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/asset/asset_view.hpp"
#include "common/base/error.hpp"

namespace spm {

/// Checks everything that a query reads of an asset. Every grid cell leads to a complete list, with
/// splits at most split_levels deep. Every list leads to maps, layers and triangles that
/// exist. No sample is NaN; no sample of a `sparse` asset and no triangle is infinite. Errors:
/// invalid_input, with `path` in front.
[[nodiscard]] Result<void> check_content(const AssetView& asset, const std::string& path);

}  // namespace spm
