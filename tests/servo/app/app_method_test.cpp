// SPDX-License-Identifier: Apache-2.0
// Methods and stabilization that applications choose while the loop runs.
#include <array>
#include <catch2/catch.hpp>
#include <memory>
#include <string>

#include "servo/app/app_scene.hpp"
#include "servo/force/default_settings.hpp"
#include "servo/force/scene_listener.hpp"
#include "tests/servo/support/loop_beside.hpp"

namespace app_method_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

constexpr double half = 0.01;  // m, of the box
constexpr std::int64_t tick_ns = 1'000'000;

spm_client_feel feel_of(const Connected& application) {
  auto feel = sized<spm_client_feel>();
  static_cast<void>(spm_client_read_feel(application.client, 0, &feel));
  return feel;
}

/// What the force of a hand was told last.
class Told : public SceneListener {
 public:
  void placed(std::size_t, const Vector3&, const Eigen::Quaterniond&) noexcept override {}
  void added(std::size_t, const PlacedObject&) noexcept override {}
  void changed(std::size_t, const PlacedObject& settings) noexcept override {
    method = settings.force.method;
  }
  void removed(std::size_t) noexcept override {}
  void stabilized(const StabilizationSettings& settings) noexcept override {
    stabilization = settings;
  }

  explicit Told(const ForceScene& scene)
      : method(scene.objects.front().force.method), stabilization(scene.stabilization) {}

  Method method;
  StabilizationSettings stabilization;
};

/// A scene of one object of a full asset, and commands of one application.
class Box {
 public:
  explicit Box(const ForceScene& scene = scene_of({}), bool supervisor = false)
      : told_(scene),
        attached_(*ring_.attached()),
        force_(scene, 1e-3, 1e-6, AppScene::room(scene)),
        app_(*state_, scene) {
    attached_.supervisor = supervisor;
    force_.tell(&told_);
    state_->rings()[0].offer(&attached_);
    app_.set_form(0, true, forces_);
    tick();
  }
  void send(std::uint32_t kind, std::uint32_t value) {
    spm_shared_command command = move_command(0, 0);
    command.kind = kind;
    (kind == SPM_COMMAND_METHOD ? command.index : command.on) = value;
    ring_.write(command);
    tick();
  }
  void rub() {
    spm_shared_command command = move_command(0, 0);
    command.kind = SPM_COMMAND_MATERIAL;
    command.fields = SPM_MATERIAL_FRICTION;
    command.friction_stick = command.friction_slide = 0.5;
    ring_.write(command);
    tick();
  }
  void tick() {
    now_ns_ += tick_ns;
    static_cast<void>(app_.begin(now_ns_, forces_));
    app_.end(1, now_ns_, {}, forces_);
  }
  void bake_sparse() { app_.set_form(0, false, forces_); }
  [[nodiscard]] Method method() const { return told_.method; }
  [[nodiscard]] const StabilizationSettings& stabilization() const { return told_.stabilization; }
  [[nodiscard]] Refusal refusal() const {
    return static_cast<Refusal>(ring_.ring().refused == 0 ? 0 : ring_.ring().last_refusal);
  }

 private:
  std::unique_ptr<AppState> state_ = small_state();
  RawRing ring_{1};
  Told told_;
  AttachedRing attached_;
  SceneForce force_;
  std::array<SceneForce*, 1> forces_{&force_};
  AppScene app_;
  std::int64_t now_ns_ = 1'000'000'000;
};

}  // namespace

TEST_CASE("A method that an application chooses is felt from the next tick on, and told") {
  LoopBeside beside;
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  for (const std::uint32_t method :
       {SPM_CLIENT_METHOD_PROXY, SPM_CLIENT_METHOD_PAPER, SPM_CLIENT_METHOD_SPM}) {
    REQUIRE(spm_client_set_method(beside.here->client, 0, method) == SPM_CLIENT_OK);
    REQUIRE(eventually([&] { return feel_of(*beside.here).method == method; }));
    // A millimetre deep in a flat face all three are alike.
    CHECK(beside.comes_to(1));
  }
  CHECK(spm_client_set_method(beside.here->client, 0, 3) == SPM_CLIENT_BAD_ARGUMENT);
  CHECK(spm_client_set_method(nullptr, 0, 0) == SPM_CLIENT_BAD_ARGUMENT);
}

TEST_CASE("A method that the object's asset or effects do not have is refused") {
  Box box;
  box.send(SPM_COMMAND_METHOD, SPM_CLIENT_METHOD_PROXY);
  CHECK(box.method() == Method::proxy);
  box.rub();
  box.send(SPM_COMMAND_METHOD, SPM_CLIENT_METHOD_PAPER);
  CHECK(box.refusal() == Refusal::unlike_method);
  CHECK(box.method() == Method::proxy);
  Box sparse;
  sparse.bake_sparse();
  sparse.send(SPM_COMMAND_METHOD, SPM_CLIENT_METHOD_PAPER);
  CHECK(sparse.refusal() == Refusal::unlike_method);
  CHECK(std::string(to_sentence(Refusal::unlike_method)).find("full asset") != std::string::npos);
}

TEST_CASE("An object by the paper's method whose asset becomes sparse goes back to the default") {
  Box box;
  box.send(SPM_COMMAND_METHOD, SPM_CLIENT_METHOD_PAPER);
  REQUIRE(box.method() == Method::paper);
  box.bake_sparse();
  CHECK(box.method() == default_method);
}

TEST_CASE("A supervisor switches the scene's stabilization off and on, and nobody else") {
  ForceScene scene = scene_of({});
  const bool own = GENERATE(false, true);
  if (own) scene.stabilization.passivity = true;
  Box other(scene);
  other.send(SPM_COMMAND_STABILIZE, 1);
  CHECK(other.refusal() == Refusal::supervisor_only);
  CHECK(other.stabilization().any() == own);
  Box box(scene, true);
  for (const bool on : {false, true, false, true}) {
    box.send(SPM_COMMAND_STABILIZE, on ? 1 : 0);
    CHECK(box.refusal() == Refusal::none);
    CHECK(box.stabilization().any() == on);
  }
  CHECK(spm_client_stabilize(nullptr, 0) == SPM_CLIENT_BAD_ARGUMENT);
}

TEST_CASE("Stabilization that is switched on where a scene has none is that for its device") {
  ForceScene scene = scene_of({});
  scene.stabilization.lag = 2e-3;
  scene.stabilization.device_mass = 0.3;
  Box box(scene, true);
  box.send(SPM_COMMAND_STABILIZE, 1);
  CHECK(box.stabilization() == in_loop_of(scene.stabilization, recommended_stabilization));
}

}  // namespace app_method_test
