// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/error.hpp"
#include "common/force_law.hpp"
#include "formats/asset.hpp"

namespace spm::servo {

[[nodiscard]] const char* to_string(Method method) noexcept;
[[nodiscard]] const char* to_string(PaperRule rule) noexcept;
[[nodiscard]] const char* to_string(AssetForm form) noexcept;

/// Refuses settings that no asset could serve. Errors: usage.
[[nodiscard]] Result<void> check_settings(const ForceSettings& settings);

/// Refuses an asset that cannot serve the settings: `paper` on a sparse one, a probe larger than it
/// was baked for. `path` is for the message. Errors: invalid_input.
[[nodiscard]] Result<void> check_asset(const AssetMetadata& asset, const ForceSettings& settings,
                                       const std::string& path);

}  // namespace spm::servo
