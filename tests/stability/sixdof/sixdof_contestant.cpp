// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/sixdof/sixdof_contestant.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "servo/force/pressed_part.hpp"
#include "servo/force/sampled_tool.hpp"
#include "servo/force/scene_force.hpp"
#include "tests/bench/base/unwrap.hpp"
#include "tests/stability/laboratory/contestants.hpp"

namespace spm::stability {

namespace {

/// What the scene names as assets 0 and 1; of method paper they are `full`.
std::array<const AssetView*, 2> assets_of(const SixdofScene& scene, const ForceScene& forces) {
  if (forces.objects.front().force.method == Method::paper) {
    return {&scene.object().paper(), &scene.paper_tool()};
  }
  return {&scene.object().sparse(), &scene.tool_asset()};
}

/// The servo's own forces on a tool: SceneForce, with the loop's caps told to it.
class ServedTool final : public SixdofContestant {
 public:
  ServedTool(const SixdofScene& scene, const ForceScene& forces, const SixdofCase& tried,
             const RunSettings& settings)
      : plant_(sixdof_settings(tried, settings)),
        assets_(assets_of(scene, forces)),
        tool_(
            bench::unwrap(SampledTool::make(*assets_[1], *forces.tool, 1, forces.objects.size()))),
        force_(forces, settings.period, settings.profile->encoder_step, 0, {},
               turning_of(tried, settings)) {
    force_.take_tool(tool_.get(), 0);
  }

  void begin(const Eigen::Isometry3d&) override { force_.reset(); }
  SixdofAnswer next(const Eigen::Isometry3d& measured) override {
    const HandPose hand{measured.translation(), Eigen::Quaterniond(measured.linear()).normalized()};
    const ContactForce felt = force_.next(assets_, hand);
    const Wrench wrench{felt.force, felt.torque};
    force_.sent(plant_.reachable(wrench));
    return {wrench, force_.tool().pose, felt.depth, felt.contact};
  }

 private:
  SixdofPlant plant_;  ///< for its caps alone
  std::array<const AssetView*, 2> assets_;
  std::unique_ptr<SampledTool> tool_;
  SceneForce force_;
};

/// A field that remembers nothing.
class DistanceField final : public SampledField {
 public:
  explicit DistanceField(const bench::Method& method) : method_(method) {}
  std::optional<SampleDepth> at(std::size_t, const Vector3& place) override {
    const Answer answer = method_.query(place);
    if (!(answer.distance < 0)) return std::nullopt;
    return SampleDepth{-answer.distance, answer.normal};
  }

 private:
  const bench::Method& method_;
};

/// Every finest sample, asked one by one.
class EverySample final : public SixdofContestant {
 public:
  EverySample(const SixdofScene& scene, std::vector<std::unique_ptr<SampledField>> fields,
              double stiffness)
      : scene_(scene), fields_(std::move(fields)), stiffness_(stiffness) {}

  void begin(const Eigen::Isometry3d&) override {}
  SixdofAnswer next(const Eigen::Isometry3d& measured) override {
    const SampledContact found = scene_.contact(fields_, measured, stiffness_);
    return {found.wrench, measured, found.deepest, found.deepest > 0};
  }

 private:
  const SixdofScene& scene_;
  std::vector<std::unique_ptr<SampledField>> fields_;
  double stiffness_;
};

/// The stabilizers that a contender names. Those of the default that have no form here are left
/// out.
StabilizationSettings stabilization_of(const Contender& contender) {
  StabilizationSettings stabilization;
  std::string words = contender.stabilization;
  if (contender.method == "default") {
    words = default_contender().stabilization;
    if (!contender.stabilization.empty()) words += "+" + contender.stabilization;
  }
  if (!words.empty() && !parse_stabilization(words, stabilization)) {
    throw baker::BakeError(ExitCode::usage, "unknown stabilizer in '" + words + "'");
  }
  if (contender.method == "default") stabilization.coupling = stabilization.potential = 0;
  return stabilization;
}

std::unique_ptr<SixdofContestant> every_sample(const Contender& contender, const SixdofScene& scene,
                                               double stiffness) {
  if (contender.method == "exact-penalty") {
    return std::make_unique<EverySample>(scene, scene.exact_fields(), stiffness);
  }
  std::vector<std::unique_ptr<SampledField>> fields;
  for (std::size_t i = 0; i < scene.places().size(); ++i) {
    fields.push_back(std::make_unique<DistanceField>(scene.object().distance_field()));
  }
  return std::make_unique<EverySample>(scene, std::move(fields), stiffness);
}

/// Whether the servo makes the forces.
bool is_served(const Contender& contender) {
  return contender.method == "spm" || contender.method == "proxy" || contender.method == "paper" ||
         contender.method == "default";
}

}  // namespace

HandTurning turning_of(const SixdofCase& tried, const RunSettings& settings) {
  const SixdofPlant plant(sixdof_settings(tried, settings));
  HandTurning turning;
  turning.reads = true;
  turning.torque_cap = plant.torque_cap();
  turning.turn_step = plant.turn_step();
  turning.inertia = plant.inertia().minCoeff();
  turning.force_cap = settings.profile->force_cap;
  return turning;
}

ForceScene served_scene(const Contender& contender, const SixdofScene& scene,
                        const SixdofCase& tried, const RunSettings& settings) {
  ForceScene made;
  PlacedObject object = default_object(settings.stiffness, {});
  object.force.method = contender.method == "spm"     ? Method::spm
                        : contender.method == "paper" ? Method::paper
                                                      : Method::proxy;
  if (contender.method == "spm") {
    // An object of method spm is as stiff as it says where a part of the tool presses, and is felt
    // nowhere steeper. What presses here is another part, and the hand is to feel the same force.
    const double asked =
        scene.area_stiffness(settings.stiffness) * pressed_part * scene.tool().area;
    object.force.stiffness =
        std::max({settings.stiffness, asked, scene.steepness(settings.stiffness)});
  }
  FrictionSettings& friction = object.effects.friction;
  friction.stick = friction.slide = tried.friction;
  friction.stiffness = settings.stiffness;
  for (const Eigen::Isometry3d& place : scene.places()) {
    object.placement.position = place.translation();
    object.placement.rotation = Eigen::Quaterniond(place.linear());
    made.objects.push_back(object);
  }
  ToolSettings tool;
  tool.asset = 1;
  tool.coupling = settings.stiffness;
  tool.turning = settings.stiffness * sixdof_lever * sixdof_lever;
  tool.spacing = tried.spacing;
  made.tool = tool;
  made.stabilization = stabilization_of(contender);
  made.stabilization.delay_ticks = tried.delay_ticks;
  made.stabilization.lag = judged_loop(StabilityCase{}, settings).lag;
  made.stabilization.device_mass = settings.profile->mass;
  return made;
}

std::string why_not_sixdof(const Contender& contender, const SixdofCase& tried) {
  std::string reason = why_not(contender, StabilityCase{});
  if (!reason.empty()) return reason;
  if (contender.method == "mesh-proxy") return "mesh-proxy knows a point and a ball alone";
  if (tried.two_hands && !is_served(contender)) return contender.method + " knows one tool alone";
  const bool letter = contender.method == "paper";
  if (tried.two_hands && letter) return "the laboratory gives two hands no full tools";
  if (tried.friction > 0 && (letter || !is_served(contender))) {
    return contender.method + " has no friction";
  }
  const StabilizationSettings stabilization = stabilization_of(contender);
  if (stabilization.coupling > 0) return "the coupling of a tool that turns is what proxy is";
  if (stabilization.potential > 0) return "the force of samples is one potential's already";
  return {};
}

std::unique_ptr<SixdofContestant> make_sixdof_contestant(const Contender& contender,
                                                         const SixdofScene& scene,
                                                         const SixdofCase& tried,
                                                         const RunSettings& settings) {
  const std::string reason = why_not_sixdof(contender, tried);
  if (!reason.empty()) throw baker::BakeError(ExitCode::usage, tried.name + ": " + reason);
  if (!is_served(contender)) {
    return every_sample(contender, scene, scene.area_stiffness(settings.stiffness));
  }
  const ForceScene forces = served_scene(contender, scene, tried, settings);
  return std::make_unique<ServedTool>(scene, forces, tried, settings);
}

}  // namespace spm::stability
