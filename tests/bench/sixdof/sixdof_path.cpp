// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/sixdof/sixdof_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "baker/base/bake_error.hpp"
#include "common/base/random.hpp"
#include "common/query/query.hpp"
#include "common/sixdof/object_contact.hpp"

namespace spm::bench {
namespace {

using Eigen::Isometry3d;

constexpr std::uint64_t stroke_ticks = 500;
constexpr double approach_height = 3e-3;  // m
constexpr int settle_steps = 80;
constexpr int follow_steps = 3;
/// A stroke ends if its depth is too large by more than this, m: the tool is wedged.
constexpr double wedged = 4e-4;
/// Weight of the object's new normal at each tick: a hand does not follow every facet.
constexpr double follow_share = 0.02;
/// Rotation of the tool about its contact per tick, rad.
constexpr double twist = 5e-4;
constexpr std::uint64_t max_trials = 400;

Vector3 to_vector(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

/// One stroke: where the tool stands on the object, and how it is turned.
class Stroke {
 public:
  Stroke(const SurfaceSamples& tool, const AssetView& object, const SurfaceSamples& places,
         const PathPlan& plan, std::uint64_t which)
      : tool_(tool),
        object_(object),
        plan_(plan),
        seed_(plan.seed * 1000003 + which),
        contact_(tool, ObjectContactSettings{}) {
    const std::uint32_t on_tool = draw(tool), on_object = draw(places);
    at_ = to_vector(places.places[on_object].position);
    normal_ = places.shares[on_object].normal();
    own_place_ = to_vector(tool.places[on_tool].position);
    own_normal_ = tool.shares[on_tool].normal();
    along_ = normal_.cross(direction_of(unit(), unit())).normalized();
    const Eigen::AngleAxisd about(2 * std::numbers::pi * unit(), normal_);
    turn_ = about * Eigen::Quaterniond::FromTwoVectors(own_normal_, -normal_);
    // Start well above the object, so that no other part of the tool is inside.
    lift_ = 2e-3;
  }

  /// Presses the tool onto the start of the stroke; false if it does not fit there.
  [[nodiscard]] bool settle() {
    for (int step = 0; step < settle_steps; ++step) press(plan_.min_depth, 5e-4);
    return std::abs(deepest_ - plan_.min_depth) < wedged / 4;
  }

  /// A pose on the way down, `above` metres above the settled pose.
  [[nodiscard]] Isometry3d approach(double above) const {
    Isometry3d made = pose();
    made.pretranslate(above * normal_);
    return made;
  }

  /// The pose at a tick of the stroke; none if the stroke ends early.
  [[nodiscard]] std::optional<Isometry3d> step(std::uint64_t tick) {
    at_ += along_ * plan_.speed / plan_.rate;
    const Answer answer = query_point(object_, at_);
    if (answer.status != Status::exact) return std::nullopt;
    at_ -= answer.distance * answer.normal;
    // Turned on from where it is: a turn told anew from the two normals jumps where they are alike.
    const Vector3 before = normal_;
    normal_ = (normal_ + follow_share * answer.normal).normalized();
    turn_ = (Eigen::AngleAxisd(twist, normal_) *
             Eigen::Quaterniond::FromTwoVectors(before, normal_) * turn_)
                .normalized();
    along_ = (along_ - along_.dot(answer.normal) * answer.normal).normalized();
    const double phase = 2 * std::numbers::pi * static_cast<double>(tick) / 250;
    const double target =
        plan_.min_depth + (plan_.max_depth - plan_.min_depth) * (1 - std::cos(phase)) / 2;
    for (int k = 0; k < follow_steps; ++k) press(target, 5e-5);
    if (deepest_ > target + wedged) return std::nullopt;
    return pose();
  }

 private:
  const SurfaceSamples& tool_;
  const AssetView& object_;
  const PathPlan& plan_;
  std::uint64_t seed_, drawn_ = 0;
  ObjectContact contact_;
  Vector3 at_, normal_, along_, own_place_, own_normal_;
  Eigen::Quaterniond turn_;
  double lift_ = 0, deepest_ = 0;

  double unit() { return random_unit(seed_, drawn_++); }
  std::uint32_t draw(const SurfaceSamples& samples) {
    const SampleLevel& finest = samples.levels.back();
    return finest.first + static_cast<std::uint32_t>(unit() * finest.count);
  }

  [[nodiscard]] Isometry3d pose() const {
    Isometry3d made = Isometry3d::Identity();
    made.linear() = turn_.toRotationMatrix();
    made.translation() = at_ + lift_ * normal_ - made.linear() * own_place_;
    return made;
  }

  /// Moves the tool along the object's normal towards a depth.
  void press(double depth, double most) {
    const std::array objects{ContactObject{&object_, Isometry3d::Identity()}};
    deepest_ = contact_.tick(pose(), objects).sum.deepest;
    lift_ += std::clamp(deepest_ - depth, -most, most);
  }
};

}  // namespace

std::vector<Isometry3d> press_and_slide(const SurfaceSamples& samples, const AssetView& object,
                                        const SurfaceSamples& object_samples,
                                        const PathPlan& plan) {
  std::vector<Isometry3d> poses;
  for (std::uint64_t trial = 0; poses.size() < plan.ticks; ++trial) {
    if (trial == max_trials) {
      throw baker::BakeError(ExitCode::invalid_input,
                             "the tool finds no place on the object where it can slide; give "
                             "another tool or a smaller one");
    }
    Stroke stroke(samples, object, object_samples, plan, trial);
    if (!stroke.settle()) continue;
    const double a_tick = plan.speed / plan.rate;
    for (double above = approach_height; above > 0 && poses.size() < plan.ticks; above -= a_tick) {
      poses.push_back(stroke.approach(above));
    }
    for (std::uint64_t tick = 0; tick < stroke_ticks && poses.size() < plan.ticks; ++tick) {
      const auto pose = stroke.step(tick);
      if (!pose) break;
      poses.push_back(*pose);
    }
  }
  return poses;
}

std::vector<Isometry3d> pressed_in(const std::vector<Isometry3d>& path,
                                   const SurfaceSamples& samples, const AssetView& object,
                                   double share) {
  ObjectContact contact(samples, ObjectContactSettings{});
  const std::array objects{ContactObject{&object, Isometry3d::Identity()}};
  // The way in, followed slowly.
  std::vector<Vector3> ways;
  Vector3 way = Vector3::Zero();
  for (const Isometry3d& pose : path) {
    const Vector3 force = contact.tick(pose, objects).sum.forces().force;
    if (force.norm() > 0) way = (way + follow_share * force.normalized()).normalized();
    ways.push_back(way);
  }
  const double all = static_cast<double>(samples.levels.back().count);
  const auto touching = [&](double depth) {
    constexpr std::size_t looked_at = 40;
    double sum = 0;
    for (std::size_t k = 0; k < looked_at; ++k) {
      const std::size_t tick = (k + 1) * (path.size() - 1) / looked_at;
      Isometry3d pose = path[tick];
      pose.pretranslate(-depth * ways[tick]);
      sum += static_cast<double>(contact.tick(pose, objects).sum.contacts) / all;
    }
    return sum / looked_at;
  };
  double low = 0, high = samples.radius;
  for (int k = 0; k < 20; ++k) {
    const double middle = (low + high) / 2;
    (touching(middle) < share ? low : high) = middle;
  }
  std::vector<Isometry3d> made = path;
  for (std::size_t i = 0; i < path.size(); ++i) made[i].pretranslate(-high * ways[i]);
  return made;
}

}  // namespace spm::bench
