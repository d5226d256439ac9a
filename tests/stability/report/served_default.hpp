// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "servo/scene/force_choice.hpp"
#include "tests/stability/laboratory/laboratory.hpp"

namespace spm::stability {

/// What `spm-servo run --asset FILE --device sim:profile=NAME` serves with no other option; where
/// `probe_radius` (m) is not 0, with `--probe` too. Throws BakeError.
[[nodiscard]] servo::ForceChoice served_by_default(const servo::SimProfile& profile,
                                                   double probe_radius);

/// Why a case is of no asset that is served without options: it is about another stiffness, or
/// about effects that a scene names. Empty where it is.
[[nodiscard]] std::string why_not_by_default(const StabilityCase& tried);

/// How a case is served: the scene that is chosen, and the delay that the servo then measures,
/// which is the case's (`sim:delay=N`). The settings' stiffness is the one that is felt.
struct ServedLoop {
  ForceScene scene;
  RunSettings settings;
  FeltLimits limits;
  double delay_ticks = 0;
};
[[nodiscard]] ServedLoop served_loop(const StabilityCase& tried, const servo::SimProfile& profile);

/// Where the tool was at the end of the worst seed, which tells a tool that slid off from one that
/// was lost inside.
struct ToolEnd {
  double aside = 0;  ///< m, from the hand's target, across the case's normal
  double depth = 0;  ///< m, of its centre below the exact surface; below 0: outside
};

/// A case as it is served on a profile: all seeds, from 1 on. Throws BakeError.
[[nodiscard]] CaseVerdict served_verdict(const StabilityCase& tried,
                                         const servo::SimProfile& profile, ToolEnd* end = nullptr);

/// The cases on the teeth as they are served: `teeth-fissure` of the catalogue, with its ball; and
/// at each of `places` places a point that presses, taps at 0.5 m/s, and presses, slides and lifts,
/// with 1 N as the catalogue's cases on meshes. Places are corners of the mesh, far from each
/// other, from whose normal a way of 12 mm is free, and about which the surface falls away by 0.3
/// mm at most within 1.5 mm. Throws BakeError where there is no such mesh.
[[nodiscard]] std::vector<StabilityCase> teeth_cases(int places);

/// A row of the report: a case on a profile.
struct ServedRow {
  std::string name;  ///< of the case, without its place
  std::string device;
  Vector3 place = Vector3::Zero();  ///< m
  double probe_radius = 0;          ///< m
  double stiffness = 0;             ///< N/m, that is felt
  CaseVerdict verdict;
  ToolEnd end;
  std::string failure;  ///< why it could not be tried; else empty
};

/// Every case on every profile, in that order; runs in parallel.
[[nodiscard]] std::vector<ServedRow> serve_all(const std::vector<StabilityCase>& cases);

}  // namespace spm::stability
