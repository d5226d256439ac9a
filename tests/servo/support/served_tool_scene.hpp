// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "servo/scene/asset_slot.hpp"
#include "tests/servo/force/tool_scene.hpp"

namespace spm::test {

/// A tool scene as a loop is served it: each asset in its slot, the tool with its samples.
struct ServedToolScene {
  explicit ServedToolScene(Method method = Method::proxy) : world(method) {
    world.begin();
    served[0] = {&world.table.view};
    served[1] = {&world.tool_cube.view, nullptr, world.sampled.get()};
    for (std::size_t i = 0; i < slots.size(); ++i) slots[i].offer(&served[i]);
  }

  /// What a loop takes.
  [[nodiscard]] std::vector<servo::AssetSlot*> places() { return {&slots[0], &slots[1]}; }

  ToolScene world;
  std::array<servo::ServedAsset, 2> served;
  std::array<servo::AssetSlot, 2> slots;
};

}  // namespace spm::test
