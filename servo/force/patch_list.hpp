// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>

#include "common/sixdof/object_contact.hpp"
#include "servo/force/tool_settings.hpp"

namespace spm {

/// The places where a tool touches, made of the clusters of samples that are pressed: neighbours
/// that face the same way are one place. The strongest are kept. No call allocates or throws.
class PatchList {
 public:
  /// `near`: m, clusters closer than this are neighbours.
  void begin(double near) noexcept {
    near_ = near;
    count_ = 0;
  }
  /// Adds what presses a tool at `pose`, while the hand wants it at `device`; `share` of it is
  /// felt.
  void add(const PressedPatch& pressed, const Eigen::Isometry3d& pose,
           const Eigen::Isometry3d& device, double share) noexcept;
  /// Adds one as it is.
  void add(const ContactPatch& patch) noexcept;
  /// Writes the strongest, in order.
  void write(ToolTick& tick) const noexcept;
  /// Of all of them, N: the sizes of their forces.
  [[nodiscard]] double pressing() const noexcept;

 private:
  struct Entry {
    ContactPatch patch;
    double pressing = 0;  ///< N
  };
  /// More than are told, so that a strong one is not lost while weak ones come first.
  static constexpr std::size_t room = 4 * max_patches;

  std::array<Entry, room> entries_{};
  std::size_t count_ = 0;
  double near_ = 0;

  void put(const Entry& made) noexcept;
};

}  // namespace spm
