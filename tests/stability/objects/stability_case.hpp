// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "servo/devices/sim/hand_model.hpp"
#include "servo/force/contact_model.hpp"
#include "tests/support/shapes.hpp"

namespace spm::stability {

/// One leg of a hand's motion: it moves straight to a point at a speed and then rests there.
struct HandLeg {
  Vector3 to = Vector3::Zero();  ///< m
  double speed = 0.05;           ///< m/s
  double rest = 0;               ///< s, at the end of the leg
};

/// What is judged of a run; see judges.hpp. Fixed before any result was seen.
struct Judged {
  bool ripple = true;   ///< in hold, over the last 0.7 s
  bool pop = true;      ///< the surface must keep holding the hand: see pop_share
  bool energy = true;   ///< net energy generated against its bound
  bool settles = true;  ///< ends at rest
  double longest_penetration = std::numeric_limits<double>::infinity();  ///< m
  /// The work that a field may do on a tool that is carried, by the trapezoid rule over its forces:
  /// J at 1 N/mm, and in proportion to the stiffness. NaN: the bound of judges.hpp holds.
  double max_gained = std::numeric_limits<double>::quiet_NaN();
};

/// One named way to fail, small enough to understand. Lengths are in m, in the world frame, in
/// which the object stands as its shape gives it.
struct StabilityCase {
  std::string name;   ///< words joined by "-", as the reports name it
  std::string theme;  ///< what it shares with others, for tables: walls, thin, grooves, ...
  std::string title;  ///< a sentence: what is done, and which failure it looks for
  test::Shape shape;  ///< triangle mesh; empty where `asset_path` or `mesh` names one
  std::string mesh;   ///< a file of the shared meshes, for real objects; empty for shapes
  double mesh_scale = 1;
  double tolerance = 10e-6;  ///< m, of its bake
  double max_depth = 5e-3;   ///< m, of its bake's band
  double probe_radius = 0;   ///< m
  Vector3 start = Vector3::Zero();
  std::vector<HandLeg> hand;
  double seconds = 2;                               ///< of the run
  servo::HandModel holder = servo::HandModel::arm;  ///< how the hand holds the tool
  bool is_carried = false;  ///< no dynamics: the tool is taken along the hand's path exactly
  /// The friction, texture or damping that the case is about. A friction stiffness of 0 means the
  /// stiffness of the contact.
  EffectSettings effects;
  bool by_the_letter = false;  ///< effects by eq. 17 and 19 where the method knows them
  /// How far the object has been moved (m) at a time (s); null: it rests. A step is a reload.
  std::function<Vector3(double)> surface;
  /// If true, a step of `surface` means that another asset takes the place of the first: the servo
  /// then forgets what its method remembers. Otherwise the object itself moves, and takes along
  /// what touches it.
  bool is_exchanged = false;
  double delay_ticks = 1;
  double encoder_step = -1;   ///< m; below 0: the profile's
  double noise = 0;           ///< m, standard deviation added to the reading (seeded)
  double friction_scale = 1;  ///< of the device's own Coulomb friction; 0: none
  double lost_share = 0;      ///< of ticks that bring no new force
  /// The stiffness as a share of the profile's own flat border, where the case is about that; 0:
  /// the run sets the stiffness.
  double of_border = 0;
  Vector3 normal = Vector3::UnitZ();  ///< outward, where the hand presses: pops are judged along it
  /// How far (m), along `normal`, the hand's final target lies below the place where the surface
  /// would hold the tool. NaN: measured from where the tool first touched, which is the same on one
  /// flat face.
  double pressed = std::numeric_limits<double>::quiet_NaN();
  Judged judged;
  int seeds = 1;
};

}  // namespace spm::stability
