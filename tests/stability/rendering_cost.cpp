// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/rendering_cost.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/bench/slide_paths.hpp"
#include "tests/bench/tick_timing.hpp"
#include "tests/stability/catalogue.hpp"
#include "tests/stability/contestants.hpp"

namespace spm::stability {
namespace {

/// A contestant that is asked along a path, from each of its beginnings anew.
class AlongPath final : public bench::TickMethod {
 public:
  AlongPath(const Contender& contender, const StabilityCase& object, double stiffness,
            const bench::SlidePath& path)
      : path_(path), forces_(path.points.size(), Vector3::Zero()) {
    RunSettings settings;
    settings.stiffness = stiffness;
    contestant_ = make_contestant(contender, prepared_object(object), object, settings);
  }

  bool tick(std::size_t index, const Vector3& tool) override {
    if (path_.ticks[index].fresh) contestant_->begin(tool);
    const ContactForce contact = contestant_->next(tool, Vector3::Zero());
    forces_[index] = contact.force;
    return contact.contact;
  }

  [[nodiscard]] const std::vector<Vector3>& forces() const noexcept { return forces_; }

 private:
  const bench::SlidePath& path_;
  std::unique_ptr<Contestant> contestant_;
  std::vector<Vector3> forces_;
};

/// The first real object of the catalogue, for a point that reads without steps.
StabilityCase slid_object(const CostPlan& plan) {
  StabilityCase object;
  for (const StabilityCase& one : mesh_cases()) {
    if (one.mesh == plan.mesh) object = one;
  }
  object.probe_radius = 0;
  object.encoder_step = 0;
  return object;
}

}  // namespace

std::vector<CostRow> measure_costs(const std::vector<Contender>& contenders, const CostPlan& plan) {
  const StabilityCase object = slid_object(plan);
  const bench::Model& model = prepared_object(object).model();
  const bench::SlidePath path = bench::walked_slide(model, plan.depth, plan.ticks, plan.seed);
  std::vector<std::unique_ptr<bench::TickMethod>> methods;
  std::vector<const AlongPath*> asked;
  std::vector<CostRow> rows;
  for (const Contender& contender : contenders) {
    if (!why_not(contender, object).empty()) continue;
    auto method = std::make_unique<AlongPath>(contender, object, plan.stiffness, path);
    asked.push_back(method.get());
    methods.push_back(std::move(method));
    rows.push_back({name_of(contender)});
  }
  bench::TickPlan timing;
  timing.passes = 5;
  timing.most_seconds = 2;
  const std::vector<bench::TickTimes> times = bench::time_ticks(methods, path.points, timing);
  const bench::ForceRules rules{plan.stiffness, 0, object.max_depth, object.tolerance};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].relative_error = force_errors(path.ticks, asked[i]->forces(), rules).relative();
    rows[i].mean_us = times[i].mean;
    rows[i].p99_us = times[i].p99;
  }
  return rows;
}

IdleRow measure_idle(const Contender& contender, const servo::SimProfile& profile,
                     double stiffness) {
  StabilityCase wall = wall_cases().front();
  wall.hand.front().speed = gentle_speed;
  wall.seconds = (wall.hand.front().to - wall.start).norm() / gentle_speed + wall.hand.front().rest;
  RunSettings settings;
  settings.profile = &profile;
  settings.stiffness = stiffness;
  const Contender bare{contender.method == "default" ? "proxy" : contender.method, {}};
  const Trace trace = run_and_judge(wall, settings, bare).trace;
  const auto cured = make_contestant(contender, prepared_object(wall), wall, settings);
  cured->begin(trace.ticks.front().position);
  IdleRow row{name_of(contender), std::string(profile.name)};
  Vector3 last = Vector3::Zero(), last_bare = Vector3::Zero();
  for (const TraceTick& tick : trace.ticks) {
    const Vector3 force = cured->next(tick.measured, tick.surface).force;
    const double step = (force - last).norm(), bare_step = (tick.commanded - last_bare).norm();
    row.added_step_n = std::max(row.added_step_n, step - bare_step);
    last = force;
    last_bare = tick.commanded;
  }
  return row;
}

}  // namespace spm::stability
