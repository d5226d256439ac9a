// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/scene_edit.hpp"

#include <algorithm>
#include <numeric>
#include <set>

namespace spm::servo {

std::size_t assets_of(std::span<const PlacedObject> objects) noexcept {
  std::size_t count = 0;
  for (const PlacedObject& object : objects) count = std::max(count, object.asset + 1);
  return count;
}

std::size_t assets_of(const ForceScene& scene) noexcept {
  std::size_t count = assets_of(scene.objects);
  for (std::size_t k = 0; k < tools_of(scene); ++k) {
    count = std::max(count, tool_of(scene, k)->asset + 1);
  }
  return count;
}

std::vector<std::uint64_t> first_ids(std::size_t count) {
  std::vector<std::uint64_t> ids(count);
  std::iota(ids.begin(), ids.end(), 0);
  return ids;
}

std::vector<std::uint64_t> edited_ids(const SceneDifference& difference,
                                      std::span<const std::uint64_t> ids, std::size_t count) {
  std::vector<std::uint64_t> after(count);
  for (const KeptObject& object : difference.kept) after[object.after] = ids[object.before];
  // An application that still refers to the removed object must not get another one.
  const std::set<std::uint64_t> taken(ids.begin(), ids.end());
  std::uint64_t next = 0;
  for (const std::size_t added : difference.added) {
    while (taken.contains(next)) ++next;
    after[added] = next++;
  }
  return after;
}

SceneEdit scene_edit(const SceneDifference& difference, std::span<const std::uint64_t> ids,
                     std::span<const PlacedObject> objects,
                     std::span<const std::uint64_t> ids_after) {
  SceneEdit edit;
  for (const std::size_t removed : difference.removed) edit.removed.push_back(ids[removed]);
  for (const KeptObject& object : difference.kept) {
    if (object.aspects == 0) continue;
    edit.changed.push_back(
        {ids_after[object.after], objects[object.after], (object.aspects & aspect_pose) != 0});
  }
  for (const std::size_t added : difference.added) {
    edit.added.push_back({ids_after[added], objects[added], true});
  }
  return edit;
}

}  // namespace spm::servo
