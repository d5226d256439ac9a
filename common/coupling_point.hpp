// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/vector.hpp"

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
/// point lies nearer to the surface than the hand, and on the side that the hand came from, so that
/// there the contact is looked for; of a proxy it is a place between hand and proxy, and changes
/// nothing but what is felt. A hand that is pressed against a plane feels the same with and without
/// a coupling that is stiff enough, unless this has a damper. VirtualTool is the same for 6DoF.
class CouplingPoint {
 public:
  /// `asked`: the stiffness that the hand should feel, N/m; `tick` in s, above 0.
  CouplingPoint(const CouplingSettings& settings, double asked, double tick) noexcept;

  [[nodiscard]] bool on() const noexcept { return coupling_ > 0; }
  /// N/m that the hand should feel, and that it does.
  [[nodiscard]] double asked() const noexcept { return asked_; }
  [[nodiscard]] double felt() const noexcept { return felt_; }

  /// Where to look for the contact with the hand at `hand` (m): where the point is in balance if
  /// the surface is the plane that it touched last; at the hand where it touched nothing.
  [[nodiscard]] Vector3 expected(const Vector3& hand) const noexcept;
  /// Where the point is in balance between the hand and what holds it, m.
  [[nodiscard]] Vector3 balanced(const Vector3& hand, const Vector3& foot) const noexcept {
    return hand + share_ * (foot - hand);
  }

  /// Takes what held the point in this tick: `foot` (m), and the surface's normal there (unit).
  void touch(const Vector3& foot, const Vector3& normal) noexcept {
    foot_ = foot;
    normal_ = normal;
    touching_ = true;
  }
  /// Nothing holds it.
  void release() noexcept { touching_ = false; }

  /// Force on the hand, N, that the damper adds in this tick to that of the springs, which is
  /// felt() times `way`, from the hand to what holds the point (m; zero without contact). Together
  /// they never pull. To be asked once a tick.
  [[nodiscard]] Vector3 damped(const Vector3& way) noexcept;

  /// Forgets all.
  void reset() noexcept;

 private:
  double coupling_ = 0, inner_ = 0, damper_ = 0;  ///< N/m; the damper's over a tick
  double asked_, felt_;                           ///< N/m
  double share_ = 0;  ///< of the way to what holds it, that the coupling takes
  Vector3 foot_ = Vector3::Zero();
  Vector3 normal_ = Vector3::Zero();
  Vector3 stretch_ = Vector3::Zero();  ///< m, from the hand to the virtual point
  bool touching_ = false;
};

}  // namespace spm
