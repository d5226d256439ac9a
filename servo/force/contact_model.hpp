// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/contact/effect_settings.hpp"
#include "common/contact/force_law.hpp"
#include "common/contact/potential_lattice.hpp"
#include "common/contact/proxy.hpp"
#include "servo/force/force_budget.hpp"
#include "servo/stabilize/velocity_estimate.hpp"
#include "servo/stabilize/virtual_coupling.hpp"

namespace spm {

/// Fixed while the loop runs.
struct ContactSettings {
  ForceSettings force;
  EffectSettings effects;
  double tick = 1e-3;           ///< s, above 0
  double encoder_step = 0;      ///< m, 0 or more: largest error of a position
  CouplingSettings coupling{};  ///< between the hand and the point that touches the object
  VelocityMethod velocity = VelocityMethod::estimate;
  /// m, 0 or more: spacing of the lattice for the potential that gives the force of `spm`
  /// (PotentialLattice); 0 is off.
  double potential = 0;
};

/// The force on one probe at one object, tick by tick: the reaction by the chosen method, then
/// friction, damping and texture on it (eq. 18). Through a coupling the hand feels no more than
/// felt_stiffness; the method is evaluated at the hand, see VirtualCoupling. The state that these
/// effects need is kept in the object's frame. No call allocates or throws.
class ContactModel {
 public:
  explicit ContactModel(const ContactSettings& settings) noexcept;

  /// Force for a probe centred at `point` (object's frame, m), `ticks` after the last one. Without
  /// effects, for `spm` and `paper`, it is that of contact_force. Never NaN. There is no force if
  /// the stiffness is below 0 or not a number; if the stiffness is 0 there is contact without
  /// force. Not `exact`: as cheaply as the object allows (care); friction, damping and texture act
  /// all the same. The force makes no step thereby: a held plane is that of the last exact tick. A
  /// `paper` with effects is always exact, since those need its own query.
  [[nodiscard]] ContactForce next(const AssetView& asset, const Vector3& point,
                                  std::uint64_t ticks = 1, bool exact = true) noexcept;
  /// How the last force was computed.
  [[nodiscard]] Care care() const noexcept { return care_; }
  /// Turns the probe's long side, unit, object's frame, from now on.
  void turn_probe(const Vector3& axis) noexcept { settings_.force.probe_axis = axis; }

  /// Forgets all state: at the start, and where the hand was away.
  void reset() noexcept;
  /// A tick without force: keeps what holds the hand, and forgets motion and friction.
  void rest() noexcept;
  /// Keeps what holds the hand, and forgets what was remembered of the asset: it was exchanged.
  void exchange() noexcept {
    lattice_.forget();
    held_.contact = false;
  }
  /// Goes on with a contact of the same asset at the same scale that has other settings, so that
  /// the hand stays on the side on which it is.
  void continue_from(const ContactModel& other) noexcept;

  /// As they were given, except for the stiffness, which is the one that is felt.
  [[nodiscard]] const ContactSettings& settings() const noexcept { return settings_; }

 private:
  ContactSettings settings_;
  ProxyState proxy_;
  FrictionState friction_;
  VelocityEstimate velocity_;
  VirtualCoupling coupling_;
  PotentialLattice lattice_;
  Vector3 last_point_ = Vector3::Zero();
  Vector3 last_normal_ = Vector3::Zero();  ///< unit; zero where the last tick had no contact
  Vector3 last_turned_at_ = Vector3::Zero();
  bool last_known_ = false;
  Care care_ = Care::exact;
  ContactForce held_;                  ///< that of the last exact tick, if it had contact
  Vector3 held_at_ = Vector3::Zero();  ///< m, where the probe was then

  [[nodiscard]] ContactForce surface(const AssetView& asset, const Vector3& point,
                                     bool exact) noexcept;
  [[nodiscard]] ContactForce held_force(const Vector3& point) noexcept;
  [[nodiscard]] ContactForce reaction(const AssetView& asset, const Vector3& point,
                                      bool exact) noexcept;
  void limit_turn(const Vector3& point, ContactForce& contact) noexcept;
  [[nodiscard]] ContactForce proxy_force(const AssetView& asset, const Vector3& point,
                                         bool exact) noexcept;
  void add_effects(const AssetView& asset, const Vector3& point, std::uint64_t ticks,
                   ContactForce& contact) noexcept;
  void add_paper_effects(const AssetView& asset, const Vector3& point, const Vector3& motion,
                         std::uint64_t ticks, ContactForce& contact) noexcept;
};

}  // namespace spm
