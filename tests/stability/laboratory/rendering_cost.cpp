// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/laboratory/rendering_cost.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/bench/base/quantile.hpp"
#include "tests/bench/methods/tick_timing.hpp"
#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/laboratory/contestants.hpp"

namespace spm::stability {
namespace {

constexpr double tick_way = bench::walked_speed * 1e-3;  // m
/// If in one tick the direction turns by more than this, rad, or the nearest place of the surface
/// moves by more than this, m, the path passes from under one face to under another.
constexpr double passing_turn = 0.6, passing_way = 2.5 * tick_way;
/// Ticks that a tool rests after it was led in: by then braking stabilizers have forgotten the way
/// in.
constexpr int rest_ticks = 30;

/// A contestant that is run along a slide. It is led in from outside where the slide begins.
class AlongSlide final : public bench::TickMethod {
 public:
  AlongSlide(const Contender& contender, const StabilityCase& object, double stiffness,
             const HeldSlide& slide)
      : slide_(slide), forces_(slide.path.points.size(), Vector3::Zero()) {
    RunSettings settings;
    settings.stiffness = stiffness;
    contestant_ = make_contestant(contender, prepared_object(object), object, settings);
  }

  bool tick(std::size_t index, const Vector3& tool) override {
    if (slide_.path.ticks[index].fresh) lead_in(slide_.free_places[index], tool);
    const ContactForce contact = contestant_->next(tool, Vector3::Zero());
    forces_[index] = contact.force;
    return contact.contact;
  }

  /// The ticks that lead in do not count.
  [[nodiscard]] bool counts(std::size_t index) const override {
    return !slide_.path.ticks[index].fresh;
  }

  [[nodiscard]] const std::vector<Vector3>& forces() const noexcept { return forces_; }

 private:
  void lead_in(const Vector3& from, const Vector3& to) {
    contestant_->begin(from);
    const auto ticks = static_cast<int>(std::ceil((to - from).norm() / tick_way));
    for (int done = 0; done < ticks; ++done) {
      const double share = static_cast<double>(done) / ticks;
      static_cast<void>(contestant_->next(from + share * (to - from), Vector3::Zero()));
    }
    for (int i = 0; i < rest_ticks; ++i) {
      static_cast<void>(contestant_->next(to, Vector3::Zero()));
    }
  }

  const HeldSlide& slide_;
  std::unique_ptr<Contestant> contestant_;
  std::vector<Vector3> forces_;
};

Vector3 closest_point_of(const bench::SlidePath& path, std::size_t i) {
  return path.points[i] - path.ticks[i].distance * path.ticks[i].outward;
}

bool passes_an_edge(const bench::SlidePath& path, std::size_t i) {
  return path.ticks[i].outward.dot(path.ticks[i - 1].outward) < std::cos(passing_turn) ||
         (closest_point_of(path, i) - closest_point_of(path, i - 1)).norm() > passing_way;
}

/// A place above the surface, higher (m) than the bake's possible error, or lower where another
/// part is near.
Vector3 free_place(const bench::Model& model, const Vector3& closest_point, const Vector3& outward,
                   double height) {
  for (;; height /= 2) {
    Vector3 place = closest_point + height * outward;
    const double clearance = (place - model.truth.closest(place).position).norm();
    if ((!model.truth.inside(place) && clearance > 0.9 * height) || height < 1e-6) return place;
  }
}

/// Adds the median error of all judged ticks, relative to the exact force's RMS, and the share of
/// these ticks that are off by more than that RMS.
void add_spread(const bench::SlidePath& path, const std::vector<Vector3>& forces,
                const bench::ForceRules& rules, double exact_rms, CostRow& row) {
  std::vector<double> off;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const bench::ExactTick& tick = path.ticks[i];
    if (bench::count_judged({&tick, 1}, rules.max_depth, rules.radius).judged == 0) continue;
    off.push_back((forces[i] - exact_penalty(tick, rules.stiffness, rules.radius)).norm());
  }
  if (off.empty() || !(exact_rms > 0)) return;
  row.median_error = bench::quantile(off, 0.5) / exact_rms;
  row.lost_share = static_cast<double>(std::count_if(off.begin(), off.end(),
                                                     [&](double n) { return n > exact_rms; })) /
                   static_cast<double>(off.size());
}

}  // namespace

StabilityCase slid_teeth() {
  StabilityCase object;
  for (const StabilityCase& one : mesh_cases()) {
    if (one.mesh == "teeth.obj") object = one;
  }
  object.probe_radius = 0;
  object.encoder_step = 0;
  return object;
}

HeldSlide held_slide(const StabilityCase& object, const CostPlan& plan) {
  const bench::Model& model = prepared_object(object).model();
  HeldSlide slide;
  slide.path = bench::walked_slide(model, plan.depth, plan.ticks, plan.seed);
  bench::SlidePath& path = slide.path;
  slide.free_places.assign(path.points.size(), Vector3::Zero());
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    bench::ExactTick& tick = path.ticks[i];
    tick.fresh = tick.fresh || (i > 0 && passes_an_edge(path, i));
    if (!tick.fresh) continue;
    slide.free_places[i] =
        free_place(model, closest_point_of(path, i), tick.outward, 2 * object.tolerance);
  }
  return slide;
}

std::vector<CostRow> measure_costs(const std::vector<Contender>& contenders,
                                   const StabilityCase& object, const CostPlan& plan) {
  const HeldSlide slide = held_slide(object, plan);
  std::vector<std::unique_ptr<bench::TickMethod>> methods;
  std::vector<const AlongSlide*> asked;
  std::vector<CostRow> rows;
  for (const Contender& contender : contenders) {
    if (!why_not(contender, object).empty()) continue;
    auto method = std::make_unique<AlongSlide>(contender, object, plan.stiffness, slide);
    asked.push_back(method.get());
    methods.push_back(std::move(method));
    rows.push_back({name_of(contender)});
  }
  bench::TickPlan timing;
  timing.passes = 5;
  timing.max_seconds = 2;
  const std::vector<bench::TickTimes> times = bench::time_ticks(methods, slide.path.points, timing);
  const bench::ForceRules rules{plan.stiffness, 0, object.max_depth, object.tolerance};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::vector<Vector3>& forces = asked[i]->forces();
    const bench::ForceErrors errors = force_errors(slide.path.ticks, forces, rules);
    rows[i].relative_error = errors.relative();
    add_spread(slide.path, forces, rules, errors.exact_rms, rows[i]);
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
  const auto stabilized = make_contestant(contender, prepared_object(wall), wall, settings);
  stabilized->begin(trace.ticks.front().position);
  IdleRow row{name_of(contender), std::string(profile.name)};
  Vector3 last = Vector3::Zero(), last_bare = Vector3::Zero();
  for (const TraceTick& tick : trace.ticks) {
    const Vector3 force = stabilized->next(tick.measured, tick.surface).force;
    const double step = (force - last).norm(), bare_step = (tick.commanded - last_bare).norm();
    row.added_step_n = std::max(row.added_step_n, step - bare_step);
    last = force;
    last_bare = tick.commanded;
  }
  return row;
}

}  // namespace spm::stability
