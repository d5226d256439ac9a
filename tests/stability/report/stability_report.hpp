// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/base/bench_progress.hpp"
#include "tests/stability/laboratory/contenders.hpp"
#include "tests/stability/laboratory/judges.hpp"
#include "tests/stability/laboratory/rendering_cost.hpp"
#include "tests/stability/report/stability_maps.hpp"
#include "tests/stability/theory/theory_rows.hpp"

namespace spm::stability {

/// What `spm-bench stability` measures. An empty list stands for all there is.
struct StabilityPlan {
  std::vector<std::string> cases;
  std::vector<std::string> methods;         ///< names of contenders
  std::vector<std::string> devices;         ///< names of profiles
  std::vector<double> fractions{0.6, 1.7};  ///< of each profile's own flat border
  double border_share = 0.05;               ///< how exactly borders are found
  double min_tolerance = 0;                 ///< m: no bake is finer
  bool borders = true;
  bool theory = true;
  bool loops = true;
  bool maps = true;
  bool costs = true;
  int max_seeds = 30;            ///< of a verdict; 1 or more
  int max_border_seeds = 5;      ///< of one trial in a border's search
  int theory_loops = 120;        ///< number of loops that the plant is compared with
  std::size_t field_loops = 40;  ///< number of closed loops per object
  MapPlan map;
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< 0: one per core; changes no figure but times
};

/// Quick cases: shapes that are fast to make, from every theme that has such shapes and a loop.
[[nodiscard]] std::vector<std::string> quick_cases();
/// Cuts a plan down so that it ends in under 45 s on two cores; devices and cases that were named
/// stay.
void make_quick(StabilityPlan& plan);
/// Parts of a report that can be left out: borders, theory, loops, maps, costs.
[[nodiscard]] const std::vector<std::string>& part_names();
/// Keeps only the named parts, out of `part_names`, and everything that belongs to no part. Keeps
/// all parts where none is named.
void keep_parts(StabilityPlan& plan, const std::vector<std::string>& parts);

/// The largest good stiffness of a pressed flat wall by the exact penalty on a profile.
struct FlatBorder {
  std::string device;
  double measured = 0;  ///< N/m
  double linear = 0;    ///< N/m, by the exact eigenvalue, without friction and encoder steps
};

/// What a case is about.
struct CaseTitle {
  std::string name, title, theme;
  int degrees = 3;  ///< of freedom
};

/// One case, tried by one contender on one profile; the verdict is the worst seed's.
struct CaseRow {
  std::string name;    ///< of the case
  std::string method;  ///< of the contender
  std::string device;
  int degrees = 3;       ///< of freedom
  bool torque = false;   ///< in six: whether the device turns the tool
  double fraction = 0;   ///< of the profile's flat border
  double stiffness = 0;  ///< N/m
  int seeds = 0;
  int good_seeds = 0;
  std::uint64_t worst_seed = 1;
  Verdict verdict;
};

/// The range in which borders are searched, as shares of the profile's flat border.
inline constexpr double min_border_share = 0.05, max_border_share = 4;

/// The largest good stiffness of a case.
struct BorderRow {
  std::string name, method, device;
  int degrees = 3;
  double border = 0;  ///< N/m; 0 where it fails at the lowest stiffness tried
  double flat = 0;    ///< N/m, the profile's
};

/// Energy that the default generates in a case, at a stiffness that is the same for all cases; one
/// seed.
struct EnergyRow {
  std::string name, device;
  double stiffness = 1000;  ///< N/m
  Verdict verdict;
};

/// The energy that a static field gains on a closed loop of 10 mm, without dynamics.
struct LoopRow {
  std::string object, method;
  double tolerance = 0;  ///< m, of the object's bake
  double gained_j = 0;   ///< J, the most of all loops
  double median_j = 0;
  int loops = 0;
};

/// The run of a method's worst case on the worst profile.
struct WorstTrace {
  std::string method;
  CaseRow row;
  Trace trace;
  Vector3 normal = Vector3::UnitZ();
};

/// A contender or a case that gave no row, and why.
struct StabilityFailure {
  std::string name, method, reason;
};

struct StabilityReport {
  std::vector<CaseTitle> catalogue;  ///< of what was tried
  std::vector<FlatBorder> flats;
  std::vector<CaseRow> cases;
  std::vector<BorderRow> borders;
  std::vector<EnergyRow> energies;
  std::vector<TheoryRow> theory;
  std::vector<LoopRow> loops;
  std::vector<StabilityMap> maps;
  std::vector<CostRow> costs;
  std::vector<IdleRow> idle;
  std::vector<WorstTrace> worst;
  std::vector<StabilityFailure> failures;
};

/// The names that a plan's lists may hold.
[[nodiscard]] std::vector<std::string> case_names();
[[nodiscard]] std::vector<std::string> method_names();
[[nodiscard]] std::vector<std::string> device_names();

/// Measures everything in a plan. All figures except times are the same whatever the number of
/// threads. A case that cannot be prepared is reported as a failure of its rows. Throws BakeError
/// where a shared mesh is missing.
[[nodiscard]] StabilityReport measure_stability(const StabilityPlan& plan,
                                                const bench::BenchProgress& progress);

}  // namespace spm::stability
