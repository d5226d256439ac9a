// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "servo/force/placed_contact.hpp"

namespace spm::servo {

/// What of an object differs; bits. Their names, those of a scene's keys, are in names_of_aspects.
enum ObjectAspect : std::uint32_t {
  aspect_pose = 1U << 0U,
  aspect_scale = 1U << 1U,
  aspect_method = 1U << 2U,  ///< the paper's rule among it
  aspect_stiffness = 1U << 3U,
  aspect_probe = 1U << 4U,
  aspect_friction = 1U << 5U,
  aspect_damping = 1U << 6U,
  aspect_texture = 1U << 7U,
  aspect_smoothing = 1U << 8U,
  aspect_turn_limit = 1U << 9U,
  aspect_movable = 1U << 10U,
};

/// What a hand may feel of a difference.
inline constexpr std::uint32_t felt_aspects = ~std::uint32_t{aspect_movable};

/// Every bit in which two objects of the same asset differ.
[[nodiscard]] std::uint32_t aspects_of(const PlacedObject& before, const PlacedObject& after);

/// Such as "pose, stiffness".
[[nodiscard]] std::string names_of_aspects(std::uint32_t aspects);

/// An object of the one scene that goes on as one of the other.
struct KeptObject {
  std::size_t before = 0, after = 0;  ///< its place in the two lists
  std::uint32_t aspects = 0;          ///< in which it differs
};

/// What makes one list of objects the other.
struct SceneDifference {
  std::vector<KeptObject> kept;      ///< in the order of the new list
  std::vector<std::size_t> removed;  ///< places in the old list, ascending
  std::vector<std::size_t> added;    ///< places in the new list, ascending

  /// Whether nothing differs that the loop has to know; another order alone is nothing.
  [[nodiscard]] bool empty() const;
  /// Whether a hand may feel it.
  [[nodiscard]] bool felt() const;
};

/// Which object of a scene is which of an edited one; both number assets alike. An object goes on
/// as the same only with the same asset: first those that are equal, at the same place of the list
/// or else in order, so that one that was cut out of the middle is the one that is gone; then those
/// at the same place of the list; then those that are left of an asset, in order.
[[nodiscard]] SceneDifference scene_difference(std::span<const PlacedObject> before,
                                               std::span<const PlacedObject> after);

}  // namespace spm::servo
