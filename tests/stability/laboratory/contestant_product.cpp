// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include "baker/base/bake_error.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/stabilize/stabilizer.hpp"
#include "tests/stability/laboratory/contestants.hpp"

namespace spm::stability {
namespace {

/// The servo's scene of one object. The object is placed where it is moved to; where a step stands
/// for another asset in its place, the asset is exchanged.
class SceneContestant final : public Contestant {
 public:
  SceneContestant(const AssetView& asset, const ForceScene& scene, const StabilityCase& tried,
                  const RunSettings& settings, const FeltLimits& limits, double delay_ticks)
      : assets_{&asset},
        force_(scene, settings.period, judged_loop(tried, settings).encoder_step, 0, limits),
        is_exchanged_(tried.is_exchanged) {
    if (delay_ticks > 0) force_.set_delay(delay_ticks);
  }

  void begin(const Vector3&) override {
    force_.reset();
    place(Vector3::Zero());
  }

  ContactForce next(const Vector3& measured, const Vector3& moved) override {
    place(moved);
    return force_.next(assets_, measured);
  }

 private:
  void place(const Vector3& moved) noexcept {
    if (is_exchanged_ && moved != moved_) force_.reset();
    moved_ = moved;
    force_.place(0, moved, Eigen::Quaterniond::Identity());
  }

  std::array<const AssetView*, 1> assets_;
  SceneForce force_;
  bool is_exchanged_;
  Vector3 moved_ = Vector3::Zero();  ///< m
};

/// A case's effects as a method of the product has them.
EffectSettings effects_of(const StabilityCase& tried, Method method, const RunSettings& settings) {
  EffectSettings effects = tried.effects;
  if (effects.friction.stiffness == 0) effects.friction.stiffness = settings.stiffness;
  // By default the servo limits turns.
  if (method == Method::spm && effects.turn.rate == 0) effects.turn.rate = default_turn_rate;
  if (method == Method::paper) {
    effects.friction = {};
    effects.texture = {};
  }
  if (method != Method::paper || !tried.by_the_letter) {
    effects.friction_force = effects.friction_depth = effects.texture_noise = 0;
  }
  effects.noise_seed += settings.seed;
  return effects;
}

StabilizationSettings stabilization_of(const Contender& contender, const StabilityCase& tried,
                                       const RunSettings& settings) {
  StabilizationSettings stabilization;
  if (!contender.stabilization.empty() &&
      !parse_stabilization(contender.stabilization, stabilization)) {
    throw baker::BakeError(ExitCode::usage,
                           "unknown stabilizer in '" + contender.stabilization + "'");
  }
  stabilization.delay_ticks = tried.delay_ticks;
  stabilization.lag = judged_loop(tried, settings).lag;
  stabilization.device_mass = settings.profile->mass;
  return stabilization;
}

}  // namespace

std::unique_ptr<Contestant> product_contestant(const Contender& contender,
                                               const PreparedObject& object,
                                               const StabilityCase& tried,
                                               const RunSettings& settings) {
  const Method method = contender.method == "paper"   ? Method::paper
                        : contender.method == "proxy" ? Method::proxy
                                                      : Method::spm;
  StabilizationSettings stabilization = stabilization_of(contender, tried, settings);
  ForceSettings force;
  force.method = method;
  force.stiffness = settings.stiffness;
  force.probe_radius = tried.probe_radius;
  if (stabilization.coupling > 0) {
    // Two equal springs in series: the hand feels half of either. The scene makes the second.
    stabilization.coupling = 2 * settings.stiffness;
  }
  ForceScene scene = scene_of(force, effects_of(tried, method, settings));
  scene.stabilization = stabilization;
  const AssetView& asset = method == Method::paper ? object.paper() : object.sparse();
  return scene_contestant(asset, scene, tried, settings);
}

std::unique_ptr<Contestant> scene_contestant(const AssetView& asset, const ForceScene& scene,
                                             const StabilityCase& tried,
                                             const RunSettings& settings, const FeltLimits& limits,
                                             double delay_ticks) {
  return std::make_unique<SceneContestant>(asset, scene, tried, settings, limits, delay_ticks);
}

}  // namespace spm::stability
