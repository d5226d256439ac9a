// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/asset/asset_view.hpp"
#include "common/base/error.hpp"
#include "servo/force/placed_contact.hpp"
#include "servo/force/tool_settings.hpp"

namespace spm {

/// Whether the objects of a scene can be touched with a tool, by their methods and by the forms of
/// the assets; for loading. `assets` as the objects and the tool name them; those that are null are
/// not there yet and are not judged. Errors: invalid_input, with a sentence that names the cure.
[[nodiscard]] Result<void> check_tool(const ToolSettings& tool,
                                      std::span<const PlacedObject> objects,
                                      std::span<const AssetView* const> assets);

}  // namespace spm
