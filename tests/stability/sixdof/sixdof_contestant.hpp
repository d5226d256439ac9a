// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>

#include "tests/stability/laboratory/laboratory.hpp"
#include "tests/stability/sixdof/sixdof_scene.hpp"

namespace spm::stability {

/// m: forces at this lever are compared with torques, and lengths with turns. The virtual tool's
/// own: 1 N m/rad for 1000 N/m.
inline constexpr double sixdof_lever = 0.0316227766;

/// The plant that a case runs on.
[[nodiscard]] SixdofSettings sixdof_settings(const SixdofCase& tried, const RunSettings& settings);

/// A tick of a force law with a tool.
struct SixdofAnswer {
  Wrench wrench;  ///< on the hand, about the tool's origin as it was measured, world frame
  Eigen::Isometry3d drawn = Eigen::Isometry3d::Identity();  ///< where it shows the tool
  double depth = 0;                                         ///< m, that the law used
  bool contact = false;
  double stiffness = 0;  ///< N/m, along the force; 0 where the law does not tell
  double turning = 0;    ///< N m/rad, about the torque
  double stored = 0;     ///< J, in all springs together
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

/// Why a contender has no form in six degrees of freedom, in words; empty where it has.
/// `mesh-proxy` knows a point and a ball; `coupling` is what `proxy` is here, and `potential` what
/// all laws here are but for the fields' own errors.
[[nodiscard]] std::string why_not_sixdof(const Contender& contender);

/// `proxy` is the virtual tool, whose coupling is the stiffness that is felt, and turns by it times
/// sixdof_lever squared. All others push with every sample's depth, by the stiffness of area that
/// SixdofScene::area_stiffness gives: `spm` by ObjectContact; `exact-penalty`, `distance-field` and
/// `paper` ask each finest sample of the exact surface, of trilinear distances and of the paper's
/// maps. `default` is `proxy` with those of the default's stabilizers that have a form here. The
/// scene outlives the contestant. Throws BakeError where `why_not_sixdof` says a reason.
[[nodiscard]] std::unique_ptr<SixdofContestant> make_sixdof_contestant(const Contender& contender,
                                                                       const SixdofScene& scene,
                                                                       const SixdofCase& tried,
                                                                       const RunSettings& settings);

}  // namespace spm::stability
