// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/sixdof/sixdof_contestant.hpp"

#include <utility>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "common/paper/paper_force.hpp"
#include "common/sixdof/virtual_tool.hpp"
#include "servo/force/stabilizer.hpp"
#include "tests/stability/laboratory/contestants.hpp"
#include "tests/stability/sixdof/sixdof_stabilized.hpp"

namespace spm::stability {

namespace {

/// Stiffness of the contact between the virtual tool and the objects, N/m3: its samples, of about a
/// square millimetre each, are far stiffer than any coupling.
constexpr double virtual_contact = 5e10;

/// m. If the virtual tool is farther from the device than this, something holds it off.
constexpr double free_stretch = 1e-6;

ObjectContactSettings contact_settings(const SixdofScene& scene, double stiffness) {
  ObjectContactSettings settings;
  settings.stiffness = stiffness;
  settings.objects = static_cast<std::uint32_t>(scene.places().size());
  return settings;
}

/// A symmetric stiffness along a direction; 0 where there is no direction.
double stiffness_along(const Eigen::Matrix3d& stiffness, const Vector3& direction) {
  const double square = direction.squaredNorm();
  return square > 0 ? direction.dot(stiffness * direction) / square : 0;
}

/// ObjectContact at the device's pose.
class DirectPenalty final : public SixdofContestant {
 public:
  DirectPenalty(const SixdofScene& scene, double stiffness)
      : contact_(scene.tool(), contact_settings(scene, stiffness)),
        objects_(scene.contact_objects()) {}

  void begin(const Eigen::Isometry3d&) override {
    for (std::uint32_t i = 0; i < objects_.size(); ++i) contact_.forget(i);
  }
  SixdofAnswer next(const Eigen::Isometry3d& measured) override {
    const ContactSum sum = contact_.tick(measured, objects_).sum;
    const Wrench wrench = sum.forces();
    return {wrench,
            measured,
            sum.deepest,
            sum.contacts > 0,
            stiffness_along(sum.stiffness.topLeftCorner<3, 3>(), wrench.force),
            stiffness_along(sum.stiffness.bottomRightCorner<3, 3>(), wrench.torque),
            sum.energy};
  }

 private:
  ObjectContact contact_;
  std::vector<ContactObject> objects_;
};

/// The product's virtual tool.
class CoupledTool final : public SixdofContestant {
 public:
  CoupledTool(const SixdofScene& scene, const VirtualToolSettings& settings)
      : contact_(scene.tool(), contact_settings(scene, virtual_contact)),
        settings_(settings),
        tool_(contact_, settings, scene.tool_radius()),
        objects_(scene.contact_objects()) {}

  void begin(const Eigen::Isometry3d& start) override {
    for (std::uint32_t i = 0; i < objects_.size(); ++i) contact_.forget(i);
    tool_.place(start);
  }
  SixdofAnswer next(const Eigen::Isometry3d& measured) override {
    const VirtualToolReport report = tool_.tick(measured, objects_);
    const ContactSum& sum = report.contact.sum;
    // A tool just off a surface that it cannot go back into is held up as well as a tool in it.
    const bool held = report.wrench.force.norm() > free_stretch * settings_.stiffness;
    return {report.wrench,       report.pose,       sum.deepest,  sum.contacts > 0 || held,
            settings_.stiffness, settings_.turning, report.energy};
  }

 private:
  ObjectContact contact_;
  VirtualToolSettings settings_;
  VirtualTool tool_;
  std::vector<ContactObject> objects_;
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

/// The paper's rule and eq. 9 at every sample.
class PaperField final : public SampledField {
 public:
  explicit PaperField(const AssetView& asset) : asset_(asset) {}
  std::optional<SampleDepth> at(std::size_t, const Vector3& place) override {
    const PaperContact contact = paper_contact(asset_, place, PaperRule::closest_plane);
    if (!contact.contact) return std::nullopt;
    return SampleDepth{contact.depth, contact.normal};
  }

 private:
  const AssetView& asset_;
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
    if (contender.method == "paper") {
      fields.push_back(std::make_unique<PaperField>(scene.object().paper()));
    } else {
      fields.push_back(std::make_unique<DistanceField>(scene.object().distance_field()));
    }
  }
  return std::make_unique<EverySample>(scene, std::move(fields), stiffness);
}

VirtualToolSettings tool_settings(const SixdofCase& tried, const RunSettings& settings) {
  const SixdofPlant plant(sixdof_settings(tried, settings));
  VirtualToolSettings made;
  made.stiffness = settings.stiffness;
  made.turning = settings.stiffness * sixdof_lever * sixdof_lever;
  // The device's limits. Without them, a held weight would tear the coupling before the device
  // gives way.
  made.max_force = settings.profile->force_cap;
  made.max_torque = plant.torque_cap();
  return made;
}

}  // namespace

std::string why_not_sixdof(const Contender& contender) {
  const std::string reason = why_not(contender, StabilityCase{});
  if (!reason.empty()) return reason;
  if (contender.method == "mesh-proxy") return "mesh-proxy knows a point and a ball alone";
  const StabilizationSettings stabilization = stabilization_of(contender);
  if (stabilization.coupling > 0) return "the coupling of a tool that turns is what proxy is";
  if (stabilization.potential > 0) return "the force of samples is one potential's already";
  return {};
}

std::unique_ptr<SixdofContestant> make_sixdof_contestant(const Contender& contender,
                                                         const SixdofScene& scene,
                                                         const SixdofCase& tried,
                                                         const RunSettings& settings) {
  const std::string reason = why_not_sixdof(contender);
  if (!reason.empty()) throw baker::BakeError(ExitCode::usage, tried.name + ": " + reason);
  std::unique_ptr<SixdofContestant> made;
  if (contender.method == "proxy" || contender.method == "default") {
    made = std::make_unique<CoupledTool>(scene, tool_settings(tried, settings));
  } else if (contender.method == "spm") {
    made = std::make_unique<DirectPenalty>(scene, scene.area_stiffness(settings.stiffness));
  } else {
    made = every_sample(contender, scene, scene.area_stiffness(settings.stiffness));
  }
  StabilizationSettings stabilization = stabilization_of(contender);
  if (!stabilization.any()) return made;
  const SixdofPlant plant(sixdof_settings(tried, settings));
  stabilization.delay_ticks = tried.delay_ticks;
  stabilization.lag = judged_loop(StabilityCase{}, settings).lag;
  stabilization.device_mass = settings.profile->mass;
  const SixdofLoop loop{settings.period, settings.profile->encoder_step, plant.turn_step(),
                        plant.inertia().minCoeff()};
  return std::make_unique<StabilizedWrench>(std::move(made), stabilization, loop);
}

}  // namespace spm::stability
