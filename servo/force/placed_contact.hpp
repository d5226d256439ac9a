// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "servo/force/contact_model.hpp"
#include "common/base/placement.hpp"

namespace spm {

/// One object as it lies in the world, and how it feels. Lengths, forces, stiffnesses and damping
/// are the world's: a scale makes the object larger, not softer.
struct PlacedObject {
  std::size_t asset = 0;  ///< which of the scene's assets it is
  Placement placement;    ///< of the asset's frame
  ForceSettings force;
  EffectSettings effects;
  bool movable = false;  ///< an application may move it
};

/// What a contact model in the asset's frame is given, so that the world feels the settings of the
/// object: lengths divided by its scale, forces a length multiplied. `tick` in s, above 0;
/// `encoder_step` in m of the world; `coupling` and `potential` (m) are the world's too.
[[nodiscard]] ContactSettings in_asset_frame(const PlacedObject& object, double tick,
                                             double encoder_step,
                                             const CouplingSettings& coupling = {},
                                             VelocityBy velocity = VelocityBy::estimate,
                                             double potential = 0) noexcept;

/// The force of one object in the world, tick by tick. Where the hand is farther from the object
/// than its band it is not asked. Nothing in it allocates or throws.
class PlacedContact {
 public:
  /// `tick` in s, above 0; `encoder_step` in m of the world, 0 or more.
  PlacedContact(const PlacedObject& object, double tick, double encoder_step,
                const CouplingSettings& coupling = {}, VelocityBy velocity = VelocityBy::estimate,
                double potential = 0) noexcept;

  /// Force for a probe centred at `point` in the next tick; force, normal and depth in the world,
  /// as ContactModel says. `asset` must be the object's.
  [[nodiscard]] ContactForce next(const AssetView& asset, const Vector3& point) noexcept;

  /// Puts the object where it is from now on, m and a unit rotation; the scale stays. What touches
  /// it moves with it: a contact lives in the object's frame.
  void place(const Vector3& position, const Eigen::Quaterniond& rotation) noexcept {
    position_ = position;
    rotation_ = rotation.toRotationMatrix();
  }
  /// Puts the object where another is.
  void place_as(const PlacedContact& other) noexcept {
    position_ = seat_ = other.position_;
    rotation_ = seat_rotation_ = other.rotation_;
  }
  /// m, world.
  [[nodiscard]] const Vector3& position() const noexcept { return position_; }

  /// Forgets all: at the start, and when the asset was exchanged.
  void reset() noexcept;

  /// N/m that is felt, world.
  [[nodiscard]] double stiffness() const noexcept {
    return model_.settings().force.stiffness / scale_;
  }
  /// How far the object carried its place that is now at `point` since this was asked last, m,
  /// world.
  [[nodiscard]] Vector3 carried(const Vector3& point) noexcept;

  /// Which of the scene's assets it is.
  [[nodiscard]] std::size_t asset() const noexcept { return asset_; }

 private:
  std::size_t asset_;
  Eigen::Matrix3d rotation_;
  Vector3 position_;
  Eigen::Matrix3d seat_rotation_;  ///< where it was when `carried` was asked last
  Vector3 seat_;
  double scale_;
  double reach_;   ///< m, asset's frame: how far outside of the asset's box there may be contact
  bool may_skip_;  ///< there is none beyond
  ContactModel model_;
  Vector3 last_ = Vector3::Zero();  ///< m, asset's frame: where the hand was
  bool last_known_ = false;
  bool touching_ = false;
  bool away_ = false;  ///< it was not asked in the last tick

  [[nodiscard]] bool passes(const AssetView& asset, const Vector3& point) const noexcept;
};

}  // namespace spm
