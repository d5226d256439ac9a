// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/vector.hpp"

namespace spm {

/// A spring and a damper between the hand and a point that has no mass.
struct CouplingSettings {
  double stiffness = 0;  ///< N/m, K_c; 0: no coupling, the hand itself touches
  double damping = 0;    ///< N s/m, parallel to the spring; 0 or more
};

/// The largest stiffness that may be felt, as a fraction of the coupling's stiffness.
inline constexpr double max_felt_share = 0.8;

/// The stiffness that a hand feels through a coupling of stiffness K_c, all in N/m. A contact of
/// stiffness K_s behind the coupling is felt as K_s K_c / (K_s + K_c). To be felt as K, the contact
/// is therefore made stiffer: K_s = K K_c / (K_c - K). The limit is K = 0.8 K_c (K_s = 4 K_c),
/// which is the most that is felt.
[[nodiscard]] constexpr double felt_stiffness(double asked, double coupling) noexcept {
  return coupling > 0 && asked > max_felt_share * coupling ? max_felt_share * coupling : asked;
}

/// Virtual coupling of a point (3DoF; Colgate, Stanley and Brown 1995, with a point that has no
/// mass and is in balance at each tick): hand - spring and damper - virtual point - contact.
///
/// The virtual point lies between the hand and what holds it. Therefore the contact is looked for
/// at the hand, and the hand feels the two springs in series. If the contact were looked for at the
/// virtual point, its position would depend on the contact of the last tick, and it would jump
/// where two walls alternate. A hand that presses against a surface feels the same with and without
/// a sufficiently stiff coupling, unless the coupling has a damper. VirtualTool is the same for
/// 6DoF.
class VirtualCoupling {
 public:
  /// `asked`: the stiffness that the hand is meant to feel, N/m; `tick` in s, above 0.
  VirtualCoupling(const CouplingSettings& settings, double asked, double tick) noexcept;

  [[nodiscard]] bool on() const noexcept { return coupling_ > 0; }
  /// The stiffness that the hand is meant to feel, and the one that it does feel, N/m.
  [[nodiscard]] double asked() const noexcept { return asked_; }
  [[nodiscard]] double felt() const noexcept { return felt_; }

  /// Force on the hand, N, that the damper adds in this tick to the force of the springs. That
  /// force is felt() times `way`, the displacement from the hand to what holds the point (m; zero
  /// without contact). Together they never pull. Call it once a tick.
  [[nodiscard]] Vector3 damped(const Vector3& way) noexcept;

  /// Goes on as another coupling, whose point is as far from the hand.
  void continue_from(const VirtualCoupling& other) noexcept { stretch_ = other.stretch_; }

  /// Forgets all state.
  void reset() noexcept { stretch_.setZero(); }

 private:
  double coupling_ = 0, inner_ = 0, damper_ = 0;  ///< N/m; for the damper: damping over a tick
  double asked_, felt_;                           ///< N/m
  Vector3 stretch_ = Vector3::Zero();             ///< m, from the hand to the virtual point
};

}  // namespace spm
