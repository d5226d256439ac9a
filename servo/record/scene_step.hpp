// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <readerwriterqueue/readerwriterqueue.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/motion/recording.hpp"
#include "servo/force/scene_force.hpp"

namespace spm::servo {

/// One change of a running scene, in the form that the loop hands to the collecting thread.
struct SceneStep {
  std::uint64_t tick = 0;  ///< it came before the forces of this tick
  RecordedKind kind = RecordedKind::placed;
  std::size_t object = 0;
  PlacedObject settings;  ///< of `added` and `changed`; of `placed` the position and rotation
  StabilizationSettings stabilization{};  ///< of `stabilized`
};

/// Makes the change in the forces on a hand.
void apply(const SceneStep& step, SceneForce& force) noexcept;

/// Lock-free ring from the loop to the collecting thread.
using StepRing = moodycamel::ReaderWriterQueue<SceneStep>;

/// A ring whose pages were all touched, so that writing to it never faults. It holds what 64
/// objects that all move change in a quarter of a second, or one in sixteen seconds, at 1 kHz.
[[nodiscard]] StepRing make_step_ring();

/// Writes the changes of a scene into a ring, each with its tick. An object that is put where it
/// was is no change. Belongs to the loop; no call allocates after construction.
class ChangeTeller : public SceneListener {
 public:
  /// `objects`: the largest number of objects that the scene can have. `ring` must outlive this.
  ChangeTeller(StepRing& ring, std::size_t objects);

  /// What changes from now on comes before the forces of this tick.
  void begin(std::uint64_t tick) noexcept { tick_ = tick; }

  void placed(std::size_t object, const Vector3& position,
              const Eigen::Quaterniond& rotation) noexcept override;
  void added(std::size_t object, const PlacedObject& settings) noexcept override;
  void changed(std::size_t object, const PlacedObject& settings) noexcept override;
  void removed(std::size_t object) noexcept override;
  void stabilized(const StabilizationSettings& stabilization) noexcept override;

 private:
  struct Pose {
    bool known = false;
    Vector3 position = Vector3::Zero();
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  };

  void put(const SceneStep& step) noexcept;
  void forget(std::size_t object) noexcept;

  StepRing& ring_;
  std::vector<Pose> last_;
  std::uint64_t tick_ = 0;
  bool lost_ = false;  ///< the ring was full: the next step that fits says so
};

}  // namespace spm::servo
