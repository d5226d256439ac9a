// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/vector.hpp"

namespace spm {

/// A spring and a damper between the hand and a point without mass.
struct CouplingSettings {
  double stiffness = 0;  ///< N/m, K_c; 0: there is none, and the hand itself touches
  double damping = 0;    ///< N s/m, beside the spring; 0 or more
};

/// Of the coupling's stiffness, the most that may be felt.
inline constexpr double most_felt_share = 0.8;

/// What a hand feels through a coupling of K_c: a contact of stiffness K_s behind it is felt as
/// K_s K_c / (K_s + K_c). So the contact is made as stiff as it takes to be felt as it was asked,
/// K_s = K K_c / (K_c - K), up to 0.8 K_c (K_s = 4 K_c), which is the most that is felt. All N/m.
[[nodiscard]] constexpr double felt_stiffness(double asked, double coupling) noexcept {
  return coupling > 0 && asked > most_felt_share * coupling ? most_felt_share * coupling : asked;
}

/// Virtual coupling of a point (3DoF; Colgate, Stanley and Brown 1995, with a point that has no
/// mass, in balance at each tick): hand - spring and damper - virtual point - contact. The virtual
/// point lies between the hand and what holds it, so the contact is looked for at the hand, and
/// what is felt of it is the two springs in series. A contact that is looked for at the virtual
/// point needs the last tick's to say where that is, and jumps between two walls that take turns. A
/// hand that is pressed against a surface feels the same with and without a coupling that is stiff
/// enough, unless this has a damper. VirtualTool is the same for 6DoF.
class CouplingPoint {
 public:
  /// `asked`: the stiffness that the hand should feel, N/m; `tick` in s, above 0.
  CouplingPoint(const CouplingSettings& settings, double asked, double tick) noexcept;

  [[nodiscard]] bool on() const noexcept { return coupling_ > 0; }
  /// N/m that the hand should feel, and that it does.
  [[nodiscard]] double asked() const noexcept { return asked_; }
  [[nodiscard]] double felt() const noexcept { return felt_; }

  /// Force on the hand, N, that the damper adds in this tick to that of the springs, which is
  /// felt() times `way`, from the hand to what holds the point (m; zero without contact). Together
  /// they never pull. To be asked once a tick.
  [[nodiscard]] Vector3 damped(const Vector3& way) noexcept;

  /// Forgets all.
  void reset() noexcept { stretch_.setZero(); }

 private:
  double coupling_ = 0, inner_ = 0, damper_ = 0;  ///< N/m; the damper's over a tick
  double asked_, felt_;                           ///< N/m
  Vector3 stretch_ = Vector3::Zero();             ///< m, from the hand to the virtual point
};

}  // namespace spm
