// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/report/stability_report.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "baker/base/bake_error.hpp"
#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/laboratory/contestants.hpp"
#include "tests/stability/laboratory/loop_energy.hpp"
#include "tests/stability/report/tried_case.hpp"
#include "tests/stability/sixdof/sixdof_laboratory.hpp"
#include "tests/stability/theory/theory_check.hpp"

namespace spm::stability {
namespace {

/// Share of the flat border at which stabilizers are expected to be idle.
constexpr double gentle_share = 0.5;
/// The range in which the flat borders are searched, N/m.
constexpr double min_flat = 200, max_flat = 60e3;

bool is_asked(const std::vector<std::string>& asked, const std::string& name) {
  return asked.empty() || std::find(asked.begin(), asked.end(), name) != asked.end();
}

/// One cell of the matrix.
struct Cell {
  const TriedCase* tried = nullptr;
  const Contender* contender = nullptr;
  const servo::SimProfile* profile = nullptr;
  double flat = 0;  ///< N/m
  double fraction = 0;
  bool torque = true;
};

class Measurement {
 public:
  Measurement(const StabilityPlan& plan, const bench::BenchProgress& progress)
      : plan_(plan), progress_(progress) {
    for (const servo::SimProfile& profile : servo::sim_profiles) {
      if (is_asked(plan.devices, std::string(profile.name))) profiles_.push_back(&profile);
    }
    for (const Contender& contender : all_contenders()) {
      if (is_asked(plan.methods, name_of(contender))) contenders_.push_back(contender);
    }
  }

  StabilityReport run() {
    prepare();
    find_flats();
    try_cases();
    weigh_energy();
    if (plan_.borders) find_borders();
    keep_worst();
    if (plan_.theory) check_theory();
    if (plan_.loops) measure_loops();
    if (plan_.maps) draw_maps();
    if (plan_.costs) weigh();
    return std::move(report_);
  }

 private:
  void tell(const std::string& what, double done) const {
    if (progress_) progress_(what, done);
  }

  void fail(const std::string& name, const std::string& method, const std::string& reason) {
    report_.failures.push_back({name, method, reason});
  }

  /// Bakes what the cases need, one after the other: each bake uses all threads.
  void prepare() {
    std::vector<TriedCase> all = tried_cases();
    for (TriedCase& one : all) {
      if (!is_asked(plan_.cases, one.name())) continue;
      one.coarsen(plan_.min_tolerance);
      tell("preparing " + one.name(), 0);
      const std::string reason = one.prepare(contenders_);
      if (!reason.empty()) {
        fail(one.name(), "all", reason);
        continue;
      }
      report_.catalogue.push_back({one.name(), one.title(), theme_of(one), one.degrees()});
      cases_.push_back(std::move(one));
    }
  }

  static std::string theme_of(const TriedCase& tried) {
    return tried.three() != nullptr ? tried.three()->theme : "six degrees of freedom";
  }

  void find_flats() {
    tell("flat borders", 0);
    const StabilityCase wall = wall_cases().front();
    report_.flats.resize(profiles_.size());
    tbb::parallel_for(std::size_t{0}, profiles_.size(), [&](std::size_t i) {
      RunSettings settings = settings_of(*profiles_[i]);
      report_.flats[i].device = profiles_[i]->name;
      report_.flats[i].linear = flat_theory(*profiles_[i]);
      report_.flats[i].measured = case_border(wall, settings, {"exact-penalty", {}}, min_flat,
                                              max_flat, plan_.border_share / 2);
    });
  }

  [[nodiscard]] RunSettings settings_of(const servo::SimProfile& profile) const {
    RunSettings settings;
    settings.profile = &profile;
    settings.seed = plan_.seed;
    return settings;
  }

  void add_cells(const TriedCase& tried, const Contender& contender, std::vector<Cell>& cells) {
    for (std::size_t i = 0; i < profiles_.size(); ++i) {
      const Cell cell{&tried, &contender, profiles_[i], report_.flats[i].measured, 0};
      const double fixed = tried.of_border();
      for (const double fraction : fixed > 0 ? std::vector<double>{fixed} : plan_.fractions) {
        // A device that turns the tool, and one that only pushes it.
        for (const bool torque : {true, false}) {
          if (tried.degrees() == 3 && !torque) continue;
          cells.push_back(cell);
          cells.back().fraction = fraction;
          cells.back().torque = torque;
        }
      }
    }
  }

  void try_cases() {
    std::vector<Cell> cells;
    for (const TriedCase& tried : cases_) {
      for (const Contender& contender : contenders_) {
        const std::string reason = tried.why_not(contender);
        if (reason.empty()) add_cells(tried, contender, cells);
      }
    }
    report_.cases.resize(cells.size());
    in_parallel("cases", cells.size(), [&](std::size_t i) { report_.cases[i] = row_of(cells[i]); });
  }

  [[nodiscard]] CaseRow row_of(const Cell& cell) const {
    RunSettings settings = settings_of(*cell.profile);
    settings.stiffness = cell.fraction * cell.flat;
    settings.torque = cell.torque;
    const CaseVerdict found = cell.tried->verdict(settings, *cell.contender, plan_.max_seeds);
    CaseRow row;
    row.name = cell.tried->name();
    row.method = name_of(*cell.contender);
    row.device = cell.profile->name;
    row.degrees = cell.tried->degrees();
    row.torque = row.degrees == 6 && cell.torque;
    row.fraction = cell.fraction;
    row.stiffness = settings.stiffness;
    row.seeds = found.seeds;
    row.good_seeds = found.good_seeds;
    row.worst_seed = found.worst_seed;
    row.verdict = found.worst;
    return row;
  }

  /// The energy that the default generates at 1 N/mm, wherever there is a loop in three degrees of
  /// freedom.
  void weigh_energy() {
    const auto product =
        std::find_if(contenders_.begin(), contenders_.end(),
                     [](const Contender& contender) { return contender.method == "default"; });
    if (product == contenders_.end()) return;
    std::vector<Cell> cells;
    for (const TriedCase& tried : cases_) {
      const bool counts = tried.degrees() == 3 && tried.has_border() && !(tried.of_border() > 0);
      if (!counts || !tried.why_not(*product).empty()) continue;
      for (const servo::SimProfile* profile : profiles_) {
        cells.push_back({&tried, &*product, profile, 0, 0});
      }
    }
    report_.energies.resize(cells.size());
    in_parallel("energy at 1 N/mm", cells.size(), [&](std::size_t i) {
      const Cell& cell = cells[i];
      EnergyRow& row = report_.energies[i];
      row.name = cell.tried->name();
      row.device = cell.profile->name;
      RunSettings settings = settings_of(*cell.profile);
      settings.stiffness = row.stiffness;
      row.verdict = cell.tried->verdict(settings, *cell.contender, 1).worst;
    });
  }

  /// On the worst profile for all contenders. On the others, in three degrees of freedom, for the
  /// default and for the same method without stabilizers.
  static bool has_border_on_all(const TriedCase& tried, const Contender& contender) {
    const bool is_asked_of = contender.method == "default" ||
                             (contender.method == "proxy" && contender.stabilization.empty());
    return is_asked_of && tried.degrees() == 3;
  }

  void find_borders() {
    std::vector<Cell> cells;
    for (const TriedCase& tried : cases_) {
      if (tried.of_border() > 0 || !tried.has_border()) continue;
      for (const Contender& contender : contenders_) {
        if (!tried.why_not(contender).empty()) continue;
        for (std::size_t i = 0; i < profiles_.size(); ++i) {
          if (i > 0 && !has_border_on_all(tried, contender)) break;
          cells.push_back(
              {&tried, &contender, profiles_[i], report_.flats[i].measured, max_border_share});
        }
      }
    }
    report_.borders.resize(cells.size());
    in_parallel("borders", cells.size(), [&](std::size_t i) {
      const Cell& cell = cells[i];
      const double border = cell.tried->border(
          settings_of(*cell.profile), *cell.contender, min_border_share * cell.flat,
          max_border_share * cell.flat, plan_.border_share, plan_.max_border_seeds);
      report_.borders[i] = {cell.tried->name(),
                            name_of(*cell.contender),
                            std::string(cell.profile->name),
                            cell.tried->degrees(),
                            border,
                            cell.flat};
    });
  }

  template <class Do>
  void in_parallel(const std::string& what, std::size_t count, const Do& one) {
    constexpr std::size_t parts = 50;
    for (std::size_t part = 0; part < parts; ++part) {
      tell(what, static_cast<double>(part) / parts);
      tbb::parallel_for(count * part / parts, count * (part + 1) / parts, one);
    }
  }

  /// For each method, the case that fails worst on the first profile at the lowest fraction.
  void keep_worst() {
    for (const Contender& contender : contenders_) {
      const CaseRow* worst = nullptr;
      for (const CaseRow& row : report_.cases) {
        const bool counts = row.method == name_of(contender) && row.degrees == 3 &&
                            row.device == profiles_.front()->name &&
                            row.fraction == plan_.fractions.front();
        if (counts && (worst == nullptr || badness(row) > badness(*worst))) worst = &row;
      }
      if (worst != nullptr) report_.worst.push_back(trace_of(*worst, contender));
    }
  }

  static double badness(const CaseRow& row) {
    const Findings& found = row.verdict.findings;
    return (row.verdict.bad    ? 100
            : row.verdict.good ? 0
                               : 10) +
           (found.popped ? 50 : 0) + std::min(found.ripple_n, 9.0);
  }

  [[nodiscard]] WorstTrace trace_of(const CaseRow& row, const Contender& contender) const {
    RunSettings settings = settings_of(*profiles_.front());
    settings.stiffness = row.stiffness;
    settings.seed = row.worst_seed;
    WorstTrace worst{row.method, row, {}, Vector3::UnitZ()};
    for (const TriedCase& tried : cases_) {
      if (tried.name() != row.name || tried.three() == nullptr) continue;
      worst.trace = run_and_judge(*tried.three(), settings, contender).trace;
      worst.normal = tried.three()->normal;
    }
    return worst;
  }

  void check_theory() {
    tell("theory", 0);
    report_.theory = validate_plant(plan_.theory_loops, plan_.seed);
    const std::vector<TheoryRow> formulas = validate_formulas(plan_.theory_loops / 4, plan_.seed);
    report_.theory.insert(report_.theory.end(), formulas.begin(), formulas.end());
  }

  /// Every real object once, for methods without stabilizers and the default.
  void measure_loops() {
    LoopPlan loops;
    loops.loops = plan_.field_loops;
    loops.seed = plan_.seed;
    std::vector<std::string> done;
    for (const TriedCase& tried : cases_) {
      const StabilityCase* one = tried.three();
      if (one == nullptr || one->mesh.empty()) continue;
      if (std::find(done.begin(), done.end(), one->mesh) != done.end()) continue;
      done.push_back(one->mesh);
      for (const Contender& contender : contenders_) {
        if (contender.method != "default" && !contender.stabilization.empty() &&
            contender.stabilization != "potential") {
          continue;
        }
        if (!tried.why_not(contender).empty()) continue;
        tell("closed loops on " + one->mesh, 0);
        const LoopEnergy energy = loop_energy(*one, contender, loops);
        report_.loops.push_back({one->mesh, name_of(contender), one->tolerance, energy.largest_j,
                                 energy.median_j, static_cast<int>(energy.loops)});
      }
    }
  }

  void draw_maps() {
    double done = 0;
    for (const Contender& contender : contenders_) {
      const std::vector<std::string>& mapped = plan_.map.methods;
      if (std::find(mapped.begin(), mapped.end(), name_of(contender)) == mapped.end()) continue;
      for (const servo::SimProfile* profile : profiles_) {
        tell("maps", done);
        done += 1 / static_cast<double>(mapped.size() * profiles_.size());
        report_.maps.push_back(measure_map(plan_.map, contender, *profile, plan_.seed));
      }
    }
  }

  void weigh() {
    tell("times", 0);
    try {
      CostPlan costs;
      costs.seed = plan_.seed;
      report_.costs = measure_costs(contenders_, slid_teeth(), costs);
    } catch (const baker::BakeError& error) {
      fail("slide for errors and times", "all", error.what());
    }
    for (const Contender& contender : contenders_) {
      if (contender.method != "default" && contender.stabilization.empty()) continue;
      if (!why_not(contender, wall_cases().front()).empty()) continue;
      for (std::size_t i = 0; i < profiles_.size(); ++i) {
        report_.idle.push_back(
            measure_idle(contender, *profiles_[i], gentle_share * report_.flats[i].measured));
      }
    }
  }

  const StabilityPlan& plan_;
  const bench::BenchProgress& progress_;
  std::vector<const servo::SimProfile*> profiles_;
  std::vector<Contender> contenders_;
  std::vector<TriedCase> cases_;
  StabilityReport report_;
};

}  // namespace

StabilityReport measure_stability(const StabilityPlan& plan, const bench::BenchProgress& progress) {
  return Measurement(plan, progress).run();
}

}  // namespace spm::stability
