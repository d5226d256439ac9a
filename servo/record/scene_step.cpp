// SPDX-License-Identifier: Apache-2.0
#include "servo/record/scene_step.hpp"

namespace spm::servo {

namespace {

constexpr std::size_t ring_steps = 16384;

}  // namespace

void apply(const SceneStep& step, SceneForce& force) noexcept {
  switch (step.kind) {
    case RecordedKind::placed:
      force.place(step.object, step.settings.placement.position, step.settings.placement.rotation);
      return;
    case RecordedKind::added:
      static_cast<void>(force.add(step.settings));
      return;
    case RecordedKind::changed:
      force.change(step.object, step.settings);
      return;
    case RecordedKind::removed:
      force.remove(step.object);
      return;
    case RecordedKind::stabilized:
      force.stabilize(step.stabilization);
      return;
    case RecordedKind::assets:
    case RecordedKind::lost:
      return;
  }
}

StepRing make_step_ring() {
  StepRing ring(ring_steps);
  SceneStep step;
  while (ring.try_enqueue(step)) {
  }
  while (ring.try_dequeue(step)) {
  }
  return ring;
}

ChangeTeller::ChangeTeller(StepRing& ring, std::size_t objects) : ring_(ring), last_(objects) {}

void ChangeTeller::put(const SceneStep& step) noexcept {
  if (lost_) {
    SceneStep gap;
    gap.tick = tick_;
    gap.kind = RecordedKind::lost;
    lost_ = !ring_.try_enqueue(gap);
  }
  lost_ = lost_ || !ring_.try_enqueue(step);
}

void ChangeTeller::forget(std::size_t object) noexcept {
  if (object < last_.size()) last_[object].known = false;
}

void ChangeTeller::placed(std::size_t object, const Vector3& position,
                          const Eigen::Quaterniond& rotation) noexcept {
  if (object < last_.size()) {
    Pose& last = last_[object];
    if (last.known && last.position == position && last.rotation.coeffs() == rotation.coeffs()) {
      return;
    }
    last = {true, position, rotation};
  }
  SceneStep step;
  step.tick = tick_;
  step.object = object;
  step.settings.placement.position = position;
  step.settings.placement.rotation = rotation;
  put(step);
}

void ChangeTeller::added(std::size_t object, const PlacedObject& settings) noexcept {
  forget(object);
  put({tick_, RecordedKind::added, object, settings});
}

void ChangeTeller::changed(std::size_t object, const PlacedObject& settings) noexcept {
  forget(object);
  put({tick_, RecordedKind::changed, object, settings});
}

void ChangeTeller::removed(std::size_t object) noexcept {
  forget(object);
  put({tick_, RecordedKind::removed, object, {}});
}

void ChangeTeller::stabilized(const StabilizationSettings& stabilization) noexcept {
  put({tick_, RecordedKind::stabilized, 0, {}, stabilization});
}

}  // namespace spm::servo
