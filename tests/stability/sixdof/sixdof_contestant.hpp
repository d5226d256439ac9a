// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>

#include "servo/force/scene_force.hpp"
#include "servo/stabilize/turning_lever.hpp"
#include "tests/stability/laboratory/laboratory.hpp"
#include "tests/stability/sixdof/sixdof_scene.hpp"

namespace spm::stability {

/// m: forces at this lever are compared with torques, and lengths with turns. The virtual tool's
/// own: 1 N m/rad for 1000 N/m.
inline constexpr double sixdof_lever = turning_lever;

/// The plant that a case runs on.
[[nodiscard]] SixdofSettings sixdof_settings(const SixdofCase& tried, const RunSettings& settings);

/// The device as the servo knows it.
[[nodiscard]] HandTurning turning_of(const SixdofCase& tried, const RunSettings& settings);

/// A tick of a force law with a tool.
struct SixdofAnswer {
  Wrench wrench;  ///< on the hand, about the tool's origin as it was measured, world frame
  Eigen::Isometry3d drawn = Eigen::Isometry3d::Identity();  ///< where it shows the tool
  double depth = 0;                                         ///< m, that the law used
  bool contact = false;
};

/// A way to make wrenches that the laboratory judges. One tick after another, the tool's reading
/// in, the wrench out.
class SixdofContestant {
 public:
  SixdofContestant() = default;
  virtual ~SixdofContestant() = default;
  SixdofContestant(const SixdofContestant&) = delete;
  SixdofContestant& operator=(const SixdofContestant&) = delete;

  /// Forgets all; the tool is at `start`, which is free.
  virtual void begin(const Eigen::Isometry3d& start) = 0;
  [[nodiscard]] virtual SixdofAnswer next(const Eigen::Isometry3d& measured) = 0;
};

/// Why a contender is not run on a case in six degrees of freedom, in words; empty where it is.
/// `mesh-proxy` knows a point and a ball; `coupling` is what `proxy` is here, and `potential` what
/// all laws here are but for the fields' own errors; friction is the servo's alone.
[[nodiscard]] std::string why_not_sixdof(const Contender& contender, const SixdofCase& tried);

/// `spm`, `proxy`, `paper` and `default`, with and without stabilizers, are the servo's SceneForce
/// with a tool: objects of the stiffness that is felt, and for `proxy` a coupling of it that turns
/// by it times sixdof_lever squared; for `paper` tool and objects are `full` (eq. 12 to 15). The
/// others push with every sample's depth, by the stiffness of area that
/// SixdofScene::area_stiffness gives: `exact-penalty` and `distance-field` ask each finest sample
/// of the exact surface and of trilinear distances. The scene
/// outlives the contestant. Throws BakeError where `why_not_sixdof` says a reason.
[[nodiscard]] std::unique_ptr<SixdofContestant> make_sixdof_contestant(const Contender& contender,
                                                                       const SixdofScene& scene,
                                                                       const SixdofCase& tried,
                                                                       const RunSettings& settings);

/// The scene that the servo is given for a contender that it makes the forces of: the case's object
/// at its places, of asset 0, and its tool, asset 1.
[[nodiscard]] ForceScene served_scene(const Contender& contender, const SixdofScene& scene,
                                      const SixdofCase& tried, const RunSettings& settings);

}  // namespace spm::stability
