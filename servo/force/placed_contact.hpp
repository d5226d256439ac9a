// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/placement.hpp"
#include "common/contact/hand_effect.hpp"
#include "servo/force/contact_model.hpp"

namespace spm {

/// One object as it lies in the world, and how it feels. Lengths, forces, stiffnesses and damping
/// are in world units: a scale makes the object larger, not softer. The probe's axis is in the
/// hand's frame.
struct PlacedObject {
  std::size_t asset = 0;  ///< which of the scene's assets it is
  Placement placement;    ///< of the asset's frame
  ForceSettings force;
  EffectSettings effects;
  bool movable = false;           ///< whether applications may move it
  bool stiffness_chosen = false;  ///< for the device: it follows the delay that is measured
};

/// The settings of a contact model in the asset's frame that make the object's settings hold in the
/// world. Lengths are divided by the object's scale; forces per length are multiplied by it. `tick`
/// in s, above 0; `encoder_step` in m of the world; `coupling` and `potential` (m) are in world
/// units too. The probe's axis stays the world's, since the object may turn.
[[nodiscard]] ContactSettings in_asset_frame(const PlacedObject& object, double tick,
                                             double encoder_step,
                                             const CouplingSettings& coupling = {},
                                             VelocityMethod velocity = VelocityMethod::estimate,
                                             double potential = 0) noexcept;

/// The force of one object in the world, tick by tick. If the hand is farther from the object than
/// its band, the model is not evaluated. No call allocates or throws.
class PlacedContact {
 public:
  /// `tick` in s, above 0; `encoder_step` in m of the world, 0 or more. `object` has its probe's
  /// axis in the world's frame.
  PlacedContact(const PlacedObject& object, double tick, double encoder_step,
                const CouplingSettings& coupling = {},
                VelocityMethod velocity = VelocityMethod::estimate, double potential = 0) noexcept;

  /// Force for a probe centred at `point`, `ticks` after the last one. Force, normal and depth are
  /// in the world, as ContactModel defines them, exact or not. `asset` must be the object's.
  [[nodiscard]] ContactForce next(const AssetView& asset, const Vector3& point,
                                  std::uint64_t ticks = 1, bool exact = true) noexcept;
  /// How the last force was computed.
  [[nodiscard]] Care care() const noexcept { return away_ ? Care::exact : model_.care(); }

  /// Sets the object's position, m, and its rotation, unit, from now on; the scale stays. What
  /// touches the object moves with it, because a contact is kept in the object's frame.
  void place(const Vector3& position, const Eigen::Quaterniond& rotation) noexcept {
    position_ = position;
    rotation_ = rotation.toRotationMatrix();
  }
  /// Puts the object at the position of another one, which moved as that did.
  void place_as(const PlacedContact& other) noexcept {
    position_ = other.position_;
    rotation_ = other.rotation_;
    seat_ = other.seat_;
    seat_rotation_ = other.seat_rotation_;
  }
  /// m, world.
  [[nodiscard]] const Vector3& position() const noexcept { return position_; }
  [[nodiscard]] Eigen::Isometry3d pose() const noexcept {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = rotation_;
    pose.translation() = position_;
    return pose;
  }

  /// Forgets all state: at the start, and where the hand was away.
  void reset() noexcept;
  /// A tick without force: the hand stays on its side.
  void rest() noexcept { model_.rest(); }
  /// Takes up that the asset was exchanged.
  void exchange() noexcept { model_.exchange(); }
  /// Goes on with the contact of an object that has other settings now. It begins anew if the
  /// asset, its scale or the method is another.
  void continue_from(const PlacedContact& other) noexcept;

  /// The stiffness that is felt, N/m, world.
  [[nodiscard]] double stiffness() const noexcept {
    return model_.settings().force.stiffness / scale_;
  }
  /// How far the object's motion carried the place that is now at `point`, since the last call, m,
  /// world.
  [[nodiscard]] Vector3 carried(const Vector3& point) noexcept;

  /// N/m and N s/m, world: of the friction's spring, 0 without friction, and of eq. 18's damping.
  [[nodiscard]] double friction_stiffness() const noexcept;
  [[nodiscard]] double damping() const noexcept {
    return model_.settings().effects.damping / scale_;
  }

  /// The object's surface as the probe at `point` sees it, m, world.
  [[nodiscard]] NearSurface near_surface(const AssetView& asset,
                                         const Vector3& point) const noexcept;

  /// Which of the scene's assets it is.
  [[nodiscard]] std::size_t asset() const noexcept { return asset_; }

 private:
  std::size_t asset_;
  Eigen::Matrix3d rotation_;
  Vector3 position_;
  Eigen::Matrix3d seat_rotation_;  ///< where it was when `carried` was last called
  Vector3 seat_;
  double scale_;
  bool turns_;          ///< whether the probe has a long side
  Vector3 probe_axis_;  ///< unit, world
  double
      contact_margin_;  ///< m, asset's frame: how far outside the asset's box there may be contact
  bool may_skip_;       ///< whether there is no contact beyond that
  ContactModel model_;
  Vector3 last_ = Vector3::Zero();  ///< m, asset's frame: where the hand was
  bool last_known_ = false;
  bool touching_ = false;
  bool away_ = false;  ///< the model was not evaluated in the last tick

  [[nodiscard]] bool passes(const AssetView& asset, const Vector3& point) const noexcept;
};

}  // namespace spm
