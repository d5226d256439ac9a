// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "servo/force/placed_contact.hpp"
#include "servo/force/stability_cures.hpp"
#include "servo/scene/scene_difference.hpp"

namespace spm::servo {

/// Slots for assets that a scene may name newly while it runs.
inline constexpr std::size_t spare_assets = 16;

/// An object that an edited scene adds or changes.
struct EditedObject {
  std::uint64_t id = 0;  ///< as applications know it
  PlacedObject settings;
  bool moved = false;  ///< the scene gives it another pose, where it is at once; else it stays
};

/// What an edited scene asks of the loop, made and freed by the thread that watches the scene, and
/// only read by the loop. All of it is taken up in one tick, or nothing.
struct SceneEdit {
  std::vector<std::uint64_t> removed;  ///< ids
  std::vector<EditedObject> changed;
  std::vector<EditedObject> added;
  std::optional<CureSettings> cures;  ///< where the scene has others
  std::size_t assets = 0;             ///< so many of the loop's slots are in use from now on
  bool felt = true;                   ///< forces have to fade in again
};

/// How many assets a scene's objects name.
[[nodiscard]] std::size_t assets_of(std::span<const PlacedObject> objects) noexcept;

/// The ids of a scene's objects at the start: 0, 1, ...
[[nodiscard]] std::vector<std::uint64_t> first_ids(std::size_t count);

/// The ids of an edited scene's objects, of which there are `count`: those that go on keep theirs
/// (`ids`, of the scene before), a new one gets the lowest that nobody has, nor had before the
/// edit.
[[nodiscard]] std::vector<std::uint64_t> edited_ids(const SceneDifference& difference,
                                                    std::span<const std::uint64_t> ids,
                                                    std::size_t count);

/// The edit that makes one scene the other: `ids` of the objects before, and `objects` and
/// `ids_after` of those after it. Slots are the caller's to count.
[[nodiscard]] SceneEdit scene_edit(const SceneDifference& difference,
                                   std::span<const std::uint64_t> ids,
                                   std::span<const PlacedObject> objects,
                                   std::span<const std::uint64_t> ids_after);

/// What became of an edit.
enum class EditAnswer : std::uint8_t {
  none,     ///< the loop has not come to it yet
  done,     ///< taken up
  no_room,  ///< left alone: there is no room for so many objects
};

/// Hands one edit at a time from the thread that watches the scene to the loop, without a lock: one
/// thread a side.
class SceneEditSlot {
 public:
  /// Watching thread: offers an edit, which must live until it was answered, or the loop has ended.
  /// The one before must have been answered.
  void offer(const SceneEdit& edit) noexcept {
    answer_.store(EditAnswer::none, std::memory_order_relaxed);
    offered_.store(&edit, std::memory_order_release);
  }

  /// Watching thread: what became of the edit that was offered last. Once it is not `none` the loop
  /// knows the edit no more.
  [[nodiscard]] EditAnswer answer() const noexcept {
    return answer_.load(std::memory_order_acquire);
  }

  /// Loop: the edit to take up now, or null.
  [[nodiscard]] const SceneEdit* pending() const noexcept {
    return offered_.load(std::memory_order_acquire);
  }

  /// Loop: lets go of the edit.
  void answer_with(EditAnswer answer) noexcept {
    offered_.store(nullptr, std::memory_order_relaxed);
    answer_.store(answer, std::memory_order_release);
  }

 private:
  std::atomic<const SceneEdit*> offered_{nullptr};
  std::atomic<EditAnswer> answer_{EditAnswer::none};
};

}  // namespace spm::servo
