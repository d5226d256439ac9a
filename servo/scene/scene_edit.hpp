// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "servo/force/placed_contact.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/scene/scene_difference.hpp"
#include "servo/stabilize/stabilizer.hpp"

namespace spm::servo {

/// Slots for assets that a scene may name while it runs.
inline constexpr std::size_t spare_assets = 16;

/// An object that an edited scene adds or changes.
struct EditedObject {
  std::uint64_t id = 0;  ///< as applications know it
  PlacedObject settings;
  /// the scene gives it another pose, where it is at once; else it stays where it is
  bool moved = false;
};

/// The changes that an edited scene requests from the loop. The thread that watches the scene makes
/// and frees them; the loop only reads them. The loop takes up all of it in one tick, or nothing.
struct SceneEdit {
  std::vector<std::uint64_t> removed;  ///< ids
  std::vector<EditedObject> changed;
  std::vector<EditedObject> added;
  std::optional<StabilizationSettings> stabilization;  ///< if the scene has others
  std::size_t assets = 0;  ///< the number of the loop's slots in use from now on
};

/// The number of assets that a scene's objects name.
[[nodiscard]] std::size_t assets_of(std::span<const PlacedObject> objects) noexcept;

/// The number of assets that a scene names, its tool's among them.
[[nodiscard]] std::size_t assets_of(const ForceScene& scene) noexcept;

/// The ids of a scene's objects at the start: 0, 1, ...
[[nodiscard]] std::vector<std::uint64_t> first_ids(std::size_t count);

/// The ids of the `count` objects of an edited scene. Objects that are in both scenes keep their
/// ids (`ids`, of the scene before). A new object gets the lowest id that no object has, or had
/// before the edit.
[[nodiscard]] std::vector<std::uint64_t> edited_ids(const SceneDifference& difference,
                                                    std::span<const std::uint64_t> ids,
                                                    std::size_t count);

/// The edit that turns one scene into the other. `ids` are of the objects before; `objects` and
/// `ids_after` are those after it. The caller counts the slots.
[[nodiscard]] SceneEdit scene_edit(const SceneDifference& difference,
                                   std::span<const std::uint64_t> ids,
                                   std::span<const PlacedObject> objects,
                                   std::span<const std::uint64_t> ids_after);

/// The result of an edit.
enum class EditAnswer : std::uint8_t {
  none,     ///< the loop has not come to it yet
  done,     ///< taken up
  no_room,  ///< nothing changed: there is no room for so many objects
};

/// Hands one edit at a time to the loop from the thread that watches the scene, without a lock,
/// with one thread on each side.
class SceneEditSlot {
 public:
  /// Watching thread: offers an edit. It must live until it was answered, or the loop has ended.
  /// The one before must have been answered.
  void offer(const SceneEdit& edit) noexcept {
    answer_.store(EditAnswer::none, std::memory_order_relaxed);
    offered_.store(&edit, std::memory_order_release);
  }

  /// Watching thread: the result of the edit that was offered last. Once it is not `none`, the loop
  /// no longer uses the edit.
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
