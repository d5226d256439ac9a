// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "servo/force/placed_contact.hpp"

namespace spm::servo {

/// In what an object differs, as bits. Their names, which are those of a scene's keys, are in
/// names_of_aspects.
enum ObjectAspect : std::uint32_t {
  aspect_pose = 1U << 0U,
  aspect_scale = 1U << 1U,
  aspect_method = 1U << 2U,  ///< includes the paper's rule
  aspect_stiffness = 1U << 3U,
  aspect_probe = 1U << 4U,  ///< includes its axis, and the form of the paper's force on it
  aspect_friction = 1U << 5U,
  aspect_damping = 1U << 6U,
  aspect_texture = 1U << 7U,
  aspect_smoothing = 1U << 8U,
  aspect_turn_limit = 1U << 9U,
  aspect_movable = 1U << 10U,
};

/// The differences that a hand may feel.
inline constexpr std::uint32_t felt_aspects = ~std::uint32_t{aspect_movable};

/// All bits in which two objects of the same asset differ.
[[nodiscard]] std::uint32_t aspects_of(const PlacedObject& before, const PlacedObject& after);

/// The names of aspects, such as "pose, stiffness".
[[nodiscard]] std::string names_of_aspects(std::uint32_t aspects);

/// An object that is in both scenes.
struct KeptObject {
  std::size_t before = 0, after = 0;  ///< its place in the two lists
  std::uint32_t aspects = 0;          ///< in which it differs
};

/// The changes that turn one list of objects into the other.
struct SceneDifference {
  std::vector<KeptObject> kept;      ///< in the order of the new list
  std::vector<std::size_t> removed;  ///< places in the old list, ascending
  std::vector<std::size_t> added;    ///< places in the new list, ascending

  /// Whether nothing differs that the loop has to know. A different order alone is no difference.
  [[nodiscard]] bool empty() const;
};

/// Which object of a scene is which object of an edited scene; both must number assets alike. An
/// object is the same only if its asset is the same. Objects are matched in this order: equal
/// objects, at the same place of the list or else in order, so that if one was deleted from the
/// middle, it is that one which is missing; then those at the same place of the list; then the
/// remaining ones of an asset, in order.
[[nodiscard]] SceneDifference scene_difference(std::span<const PlacedObject> before,
                                               std::span<const PlacedObject> after);

}  // namespace spm::servo
