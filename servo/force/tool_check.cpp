// SPDX-License-Identifier: Apache-2.0
#include "servo/force/tool_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace spm {

namespace {

/// Scales that were written as text may differ by rounding.
constexpr double scale_slack = 1e-9;

const AssetView* asset_of(std::size_t which, std::span<const AssetView* const> assets) {
  return which < assets.size() ? assets[which] : nullptr;
}

/// What is wrong with an object of method `paper`; empty if nothing is.
std::string paper_objection(const ToolSettings& tool, const PlacedObject& object,
                            const AssetView* asset, const AssetView* tool_asset) {
  if (asset != nullptr && !asset->maps_every_plane()) {
    return "method paper needs a full asset of the object; bake it with --form full, or take "
           "method proxy";
  }
  if (tool_asset != nullptr && !tool_asset->maps_every_plane()) {
    return "method paper needs a full asset of the tool; bake it with --form full, or take method "
           "proxy";
  }
  if (std::abs(object.placement.scale / tool.placement.scale - 1) > scale_slack) {
    return "method paper with a tool knows one scale for both; give tool and object the same";
  }
  return {};
}

}  // namespace

Result<void> check_tool(const ToolSettings& tool, std::span<const PlacedObject> objects,
                        std::span<const AssetView* const> assets) {
  const AssetView* const tool_asset = asset_of(tool.asset, assets);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const AssetView* const asset = asset_of(objects[i].asset, assets);
    std::string objection;
    if (objects[i].force.method == Method::paper) {
      objection = paper_objection(tool, objects[i], asset, tool_asset);
    } else if (asset != nullptr && asset->full) {
      objection =
          "a tool touches sparse assets by methods proxy and spm; bake the object without --form "
          "full, or take method paper";
    } else if (tool_asset != nullptr && tool_asset->full) {
      objection =
          "methods proxy and spm need a sparse asset of the tool; bake it without --form full, or "
          "take method paper";
    }
    if (!objection.empty()) {
      return fail(ExitCode::invalid_input, fmt::format("object {}: {}", i, objection));
    }
  }
  return {};
}

}  // namespace spm
