// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/sixdof/object_contact.hpp"

namespace spm {

/// The finest level of no more than `most` samples; else the coarsest.
[[nodiscard]] std::uint32_t level_within(const SurfaceSamples& tool, std::uint32_t most) noexcept;

/// How a tool leaves objects that it lies in so deep that their fields do not tell which way is
/// out: beyond the band each sample has the same depth, and the normals cancel. It is led out at a
/// fixed speed along one straight way: the shortest, to a fifth, of those in 26 directions of the
/// object's frame after which neither a level of the samples lies in any object, nor an
/// object in the tool. The way is looked for over several ticks, by counted work, so that a replay
/// finds the same. No call but the constructor allocates; none throws.
class ToolEscape {
 public:
  /// What a tick says of how the tool lies.
  struct Lie {
    bool deep = false;       ///< a sample is deeper than a field's band
    bool emerging = false;   ///< it still leaves what it was put into
    std::size_t object = 0;  ///< the one that it lies deepest in
  };

  /// `tool` must outlive this.
  explicit ToolEscape(const SurfaceSamples& tool) noexcept;

  /// The tool is somewhere else, or among other objects.
  void reset() noexcept;
  /// Whether the object lies in the tool as a whole, so that no sample touches it.
  [[nodiscard]] bool surrounds(const Eigen::Isometry3d& tool,
                               const ContactObject& object) const noexcept {
    return may_meet(tool, object) && has_in_it(tool, object);
  }
  /// Takes up how the tool lay in a tick in which it was not led. Where it lies so for long, or an
  /// object is in it where it was put, a way is looked for from now on.
  void note(const Lie& lie, const Eigen::Isometry3d& tool,
            std::span<const ContactObject> objects) noexcept;
  /// Whether the tool is led, or a way is looked for.
  [[nodiscard]] bool leads() const noexcept { return phase_ != Phase::none; }
  /// No sample lies in an object any more: the rest of the way need not be gone, unless an object
  /// is in the tool.
  void came_out() noexcept {
    if (!contains_) phase_ = Phase::none;
  }
  /// The motion of this tick, at most `most` (m); zero until a way is found. World frame.
  [[nodiscard]] Vector3 next(const Eigen::Isometry3d& tool, std::span<const ContactObject> objects,
                             double most) noexcept;

 private:
  enum class Phase : std::uint8_t { none, looks, leads };
  static constexpr std::size_t direction_count = 26;

  [[nodiscard]] bool has_in_it(const Eigen::Isometry3d& tool,
                               const ContactObject& object) const noexcept;
  [[nodiscard]] bool may_meet(const Eigen::Isometry3d& tool,
                              const ContactObject& object) const noexcept;
  [[nodiscard]] bool is_inside(std::uint32_t sample, const Eigen::Isometry3d& tool,
                               const ContactObject& object) const noexcept;
  void begin(std::size_t object, const Eigen::Isometry3d& tool,
             std::span<const ContactObject> objects) noexcept;
  void look(const Eigen::Isometry3d& tool, std::span<const ContactObject> objects) noexcept;
  void try_next() noexcept;

  const SurfaceSamples* tool_;
  SampleLevel level_;  ///< whose samples stand for the tool
  Phase phase_ = Phase::none;
  bool was_put_ = true;    ///< since the last note
  bool contains_ = false;  ///< it began since an object was in the tool
  std::uint32_t deep_ticks_ = 0, emerging_ticks_ = 0;
  std::array<Vector3, direction_count> directions_;  ///< unit, world
  Vector3 away_ = Vector3::UnitX();                  ///< where no way is found
  double farthest_ = 0;                              ///< m
  double distance_ = 0;                              ///< m, of the way in hand
  std::size_t direction_ = 0, object_ = 0;           ///< of the way in hand
  std::uint32_t sample_ = 0;       ///< of the level, the next to look at for that way and object
  std::uint32_t blocking_ = 0;     ///< which ended the last way that was tried
  Vector3 way_ = Vector3::Zero();  ///< unit, of the way that was found
  double left_ = 0;                ///< m, of that way
};

}  // namespace spm
