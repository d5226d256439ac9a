// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "servo/devices/sim/sim_plant.hpp"
#include "servo/devices/sim/sim_profile.hpp"
#include "tests/stability/laboratory/contestant.hpp"
#include "tests/stability/laboratory/judges.hpp"
#include "tests/stability/objects/stability_case.hpp"

namespace spm::stability {

/// Which force law, by the contract's names: paper, spm, proxy, exact-penalty, mesh-proxy,
/// distance-field; and `default`, the product's with its default stabilizers.
struct Contender {
  std::string method;
  std::string
      stabilization;  ///< words joined by "+", of servo/stabilize/stabilizer.hpp; empty: none
};

/// One run's settings beside the case.
struct RunSettings {
  const servo::SimProfile* profile = &servo::sim_profiles[0];
  double stiffness = 1000;  ///< N/m, that the hand feels
  double damping = 0;       ///< N s/m, added to the device's own, for the maps
  double period = 1e-3;     ///< s
  std::uint64_t seed = 1;   ///< of noise, losses, and the path's offset between encoder steps
  servo::MovingMass mass = servo::MovingMass::constant;
  bool torque = true;  ///< in six degrees of freedom: whether the device's motors turn the tool
};

/// The plant that a case runs on.
[[nodiscard]] servo::PlantSettings plant_settings(const StabilityCase& tried,
                                                  const RunSettings& settings);

/// What the judges need to know of a case's loop.
[[nodiscard]] JudgedLoop judged_loop(const StabilityCase& tried, const RunSettings& settings);

/// Runs a case: the plant (servo/devices/sim/sim_plant.hpp) and the contestant, tick by tick. The
/// same settings give the same trace, bit by bit.
[[nodiscard]] Trace run_case(const StabilityCase& tried, const RunSettings& settings,
                             Contestant& contestant);

/// A run and the judges' verdict on it.
struct CaseResult {
  Trace trace;
  Verdict verdict;
};

/// Prepares the case's object (once a process), runs a seed and judges it. From any thread. Throws
/// BakeError where the object cannot be prepared or the contender does not apply (contestants.hpp).
[[nodiscard]] CaseResult run_and_judge(const StabilityCase& tried, const RunSettings& settings,
                                       const Contender& contender);

/// The combined verdict of all seeds of a case.
struct CaseVerdict {
  int seeds = 0;
  int good_seeds = 0;
  int bad_seeds = 0;
  std::uint64_t worst_seed = 1;  ///< bad is worse than between, between than good; then by ripple
  Verdict worst;                 ///< of that seed

  [[nodiscard]] bool good() const noexcept { return good_seeds == seeds; }
  [[nodiscard]] bool bad() const noexcept { return bad_seeds == seeds; }
  [[nodiscard]] bool agree() const noexcept {
    return good_seeds == seeds || bad_seeds == seeds || good_seeds + bad_seeds == 0;
  }
};

/// The combined verdict of consecutive seeds; at least one.
[[nodiscard]] CaseVerdict gathered(const std::vector<Verdict>& verdicts, std::uint64_t first_seed);

/// The largest stiffness (N/m) that is good, with everything tried below it good as well, except
/// low stiffnesses at which nothing holds yet. The search climbs a ladder from `low`, each step a
/// fourth root of 2, from the first good stiffness to the first that is not. Between these it
/// bisects until they are within `share`. Good and bad may alternate there, so all contenders are
/// tried at the same steps. A stiffness that fails alone, between two good ones 1 % away, counts as
/// good. 0 where none is good, `high` where all are.
[[nodiscard]] double stiffest(const std::function<bool(double)>& is_good, double low, double high,
                              double share);

/// Runs all seeds of a case, starting at the settings' seed, or at most `max_seeds` of them. Runs
/// in parallel, with the same result whatever the number of threads. Throws as run_and_judge does.
[[nodiscard]] CaseVerdict case_verdict(const StabilityCase& tried, const RunSettings& settings,
                                       const Contender& contender,
                                       int max_seeds = std::numeric_limits<int>::max());

/// True where all seeds of a case are good; it stops at the first that is not.
[[nodiscard]] bool all_good(const StabilityCase& tried, const RunSettings& settings,
                            const Contender& contender,
                            int max_seeds = std::numeric_limits<int>::max());

/// The largest stiffness (N/m) at which a case is good, by `stiffest`; all seeds must agree.
[[nodiscard]] double case_border(const StabilityCase& tried, const RunSettings& settings,
                                 const Contender& contender, double low, double high, double share,
                                 int max_seeds = std::numeric_limits<int>::max());

}  // namespace spm::stability
