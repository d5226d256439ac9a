// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/base/vector.hpp"

namespace spm {

/// Coulomb friction of an object, as its samples feel it.
struct GripSettings {
  double stick = 0;   ///< mu at rest, 0 or more
  double slide = 0;   ///< mu in motion, 0 or more
  double spring = 1;  ///< of a bristle, in stiffnesses of the sample's own spring
  [[nodiscard]] bool on() const noexcept { return stick > 0 || slide > 0; }
  [[nodiscard]] bool operator==(const GripSettings&) const noexcept = default;
};

/// What holds a sample that touches: a bristle from its anchor, which gives way at a force.
struct Bristle {
  Vector3 stretch = Vector3::Zero();  ///< m, from the anchor, along the surface
  double most = 0;                    ///< N; 0: nothing holds it
};

/// The bristles of samples that touch (LuGre's picture without its bristle dynamics; the spring
/// from a sliding anchor of common/contact's coulomb_friction, sample by sample). So a tool that
/// rests does neither creep nor spin, and one that rolls is not held.
///
/// While a tick looks for its balance, anchors and the forces at which they give way stay those of
/// the last tick's end: then friction has an energy. `settle` moves them. A sample that touches
/// anew takes its object's mean stretch, so that the load does not drop where the samples that
/// carry a tool alternate. Built at load time (allocates); everything else neither allocates nor
/// throws.
class ContactGrip {
 public:
  ContactGrip(std::size_t samples, std::size_t objects);

  /// Of a sample at `place` (object's frame), where it was `before` at the end of the last tick.
  /// `coarse`: N/m, the bristle's spring of one above the finest, which may stand for several that
  /// touched then; 0 of the finest.
  [[nodiscard]] Bristle bristle(std::uint32_t sample, std::uint32_t object, const Vector3& place,
                                const Vector3& before, const Vector3& normal,
                                double coarse = 0) const noexcept;

  /// Begins the end of a tick.
  void begin() noexcept {
    ++now_;
    moved_ = false;
  }
  /// Then for each object `begin`, `settle` for each sample that touches it, and `end`.
  void begin(std::uint32_t object) noexcept;
  /// `force`: N, of the normal; `spring`: N/m, of the bristle.
  void settle(const GripSettings& settings, std::uint32_t sample, std::uint32_t object,
              const Vector3& place, const Vector3& before, const Vector3& normal, double force,
              double spring) noexcept;
  /// `pressed`: N, of the normals of all that touch; those that were not settled are held as the
  /// others are.
  void end(std::uint32_t object, double pressed) noexcept;

  /// Whether the last end of a tick changed anything that a bristle or its object is told by.
  [[nodiscard]] bool moved() const noexcept { return moved_; }

  void forget(std::uint32_t object) noexcept;
  /// N: what all bristles of an object may hold together.
  [[nodiscard]] double most(std::uint32_t object) const noexcept { return means_[object].all; }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return anchors_.capacity() * sizeof(Anchor) + means_.capacity() * sizeof(Mean);
  }

 private:
  struct Anchor {
    std::uint32_t sample = 0xFFFFFFFFU;
    std::uint32_t object = 0;
    std::array<float, 3> away{};   ///< m, from the sample to its anchor at the last settling
    std::array<float, 3> place{};  ///< m, object's frame, of the sample then
    float most = 0;                ///< N
    std::uint32_t seen = 0;        ///< tick
    bool sliding = false;
    /// The same but for when it was seen.
    [[nodiscard]] bool rests_as(const Anchor& other) const noexcept {
      return sample == other.sample && object == other.object && away == other.away &&
             place == other.place && most == other.most && sliding == other.sliding;
    }
  };
  /// Of an object's bristles.
  struct Mean {
    Vector3 stretch = Vector3::Zero();  ///< m
    double most = 0;                    ///< N, of a sample
    double all = 0;                     ///< N, of all
    double spring = 0;                  ///< N/m, of a bristle
    Vector3 sum = Vector3::Zero();
    double weight = 0, load = 0, pressed = 0;
    std::uint32_t count = 0;
    bool anchored = false;  ///< there may be anchors of it
  };
  static constexpr std::uint32_t kept_ticks = 64;
  static constexpr std::size_t tried = 8;

  [[nodiscard]] const Anchor* find(std::uint32_t sample, std::uint32_t object) const noexcept;
  /// As `anchor` tells it, or without one as its object does.
  [[nodiscard]] Bristle bristle_at(const Anchor* anchor, std::uint32_t object, const Vector3& place,
                                   const Vector3& before, const Vector3& normal) const noexcept;
  [[nodiscard]] Anchor& make(std::uint32_t sample, std::uint32_t object) noexcept;
  [[nodiscard]] std::size_t slot_of(std::uint32_t sample, std::uint32_t object) const noexcept;

  std::vector<Anchor> anchors_;
  std::vector<Mean> means_;
  std::uint32_t now_ = kept_ticks + 1;
  bool moved_ = false;
};

}  // namespace spm
