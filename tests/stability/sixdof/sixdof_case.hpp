// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "servo/devices/sim/sixdof_plant.hpp"
#include "tests/stability/objects/stability_case.hpp"

namespace spm::stability {

using servo::orientation_of;
using servo::SixdofPlant;
using servo::SixdofSettings;
using servo::SixdofTarget;
using servo::SixdofTick;

/// One leg of a hand's motion: it moves straight from pose to pose and then rests there.
struct SixdofLeg {
  Vector3 to = Vector3::Zero();    ///< m, of the tool's origin
  Vector3 turn = Vector3::Zero();  ///< rad, axis times angle from the world's axes
  double speed = 0.05;             ///< m/s
  double turn_speed = 0.5;         ///< rad/s; a leg takes as long as the slower of both
  double rest = 0;                 ///< s, at the end of the leg
};

/// How far a drawn tool may move and turn once it lies still; judged where a time is given.
struct Creep {
  double from = 0;   ///< s; 0: it is not judged
  double place = 0;  ///< m
  double turn = 0;   ///< rad
};

/// One named way to fail with a tool that turns. Lengths are in metres, in the world frame. The
/// tool is given in its own frame; the hand holds it at the origin of that frame.
struct SixdofCase {
  std::string name;   ///< words joined by "-", as the reports name it
  std::string title;  ///< a sentence: what is done, and which failure it looks for
  test::Shape tool;
  test::Shape object;
  std::vector<Eigen::Isometry3d> places;  ///< where the object stands, one copy at each
  double tolerance = 40e-6;               ///< m, of the object's bake
  double max_depth = 4e-3;                ///< m, of the object's band
  double spacing = 1e-3;                  ///< m, of the tool's samples
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  std::vector<SixdofLeg> hand;
  double seconds = 3;       ///< of the run
  double mass_scale = 1;    ///< of the profile's mass
  bool has_weight = false;  ///< only the mass above the profile's own, which a device balances
  double grip_share = 1;    ///< of the hand's grip
  double delay_ticks = 1;
  Vector3 normal = Vector3::UnitZ();  ///< unit, outward, where the hand presses
  /// The pose in which the tool just touches one surface of the object as in the case, and the
  /// direction into it (unit). There the stiffness by area is set to the stiffness that the hand is
  /// to feel.
  Eigen::Isometry3d touch = Eigen::Isometry3d::Identity();
  Vector3 press = -Vector3::UnitZ();
  double compared_depth = 2e-3;  ///< m, how far it is pressed in for that; less where it is thin
  double friction = 0;           ///< mu of Coulomb friction, at rest and in motion
  /// Two hands with a tool each, by sixdof_handover.hpp, which leads them; `hand` says nothing.
  bool two_hands = false;
  Creep creep;
  Judged judged;
  int seeds = 3;
};

/// The hand's target, tick by tick.
class SixdofScript {
 public:
  /// `tried` must outlive this. `period` is the length of a tick, s. `offset` (m) moves the whole
  /// path.
  SixdofScript(const SixdofCase& tried, double period, const Vector3& offset);

  /// Where the hand wants the tool at a time (s, 0 or more), and how it moves there.
  [[nodiscard]] SixdofTarget at(double time) const;

 private:
  struct Part {
    double begin = 0, end = 0;  ///< s; it rests until the next begins
    Vector3 from = Vector3::Zero(), to = Vector3::Zero();
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< at the start of the part
    Vector3 turn = Vector3::Zero();                                   ///< over the whole part
  };
  std::vector<Part> parts_;
};

/// Those of them with long rests, threads and thin parts.
[[nodiscard]] std::vector<SixdofCase> thin_sixdof_cases();

/// A box that one hand hands over to another (sixdof_handover.hpp).
[[nodiscard]] SixdofCase handed_case();

/// The catalogue's cases in six degrees of freedom.
[[nodiscard]] std::vector<SixdofCase> sixdof_catalogue();

/// A pose by its place, m, and its turn, axis times angle (rad).
[[nodiscard]] Eigen::Isometry3d pose_of(const Vector3& place,
                                        const Vector3& turn = Vector3::Zero());

/// The case of that name. Throws std::out_of_range where there is none.
[[nodiscard]] SixdofCase sixdof_case(const std::string& name);

}  // namespace spm::stability
