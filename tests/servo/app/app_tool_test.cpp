// SPDX-License-Identifier: Apache-2.0
// Objects that an application adds to a scene with a tool.
#include <catch2/catch.hpp>
#include <memory>
#include <string>

#include "servo/app/app_scene.hpp"
#include "servo/client/state_reader.hpp"
#include "tests/servo/support/loop_stand_in.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace app_tool_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

constexpr double half = 0.01;  // m, of the box that is object and tool
constexpr std::int64_t tick_ns = 1'000'000;
/// Away from the scene's own object.
const Vector3 away(0.2, 0, 0);

/// A scene of one full box, by the paper's method, and the same box as the tool of one hand.
class PaperTool {
 public:
  explicit PaperTool(double tool_scale = 1)
      : asset_(box_asset(2 * half)), tables_(tables_of(asset_)) {
    scene_.objects.front().force.method = Method::paper;
    scene_.objects.front().placement.scale = tool_scale;
    scene_.added.force.method = Method::paper;
    scene_.tool = ToolSettings{};
    scene_.tool->placement.scale = tool_scale;
    auto made = SampledTool::make(tables_.view(), *scene_.tool, 1,
                                  objects_to_meet(scene_, AppScene::room(scene_)));
    REQUIRE(made);
    sampled_ = std::move(*made);
    HandTurning turning;
    turning.torque_cap = turning.force_cap = 100;
    force_ = std::make_unique<SceneForce>(scene_, 1e-3, 1e-6, AppScene::room(scene_), FeltLimits{},
                                          turning);
    force_->take_tool(sampled_.get(), 0);
    app_ = std::make_unique<AppScene>(*state_, scene_);
    app_->set_reach(0, 2 * half);
    app_->set_form(0, true, {});
    state_->rings()[0].offer(ring_.attached());
    tick();
  }

  /// Adds the box away from the other one.
  void add(double scale) {
    spm_shared_command command = move_command(connection << 32U | ++added_, away.x());
    command.kind = SPM_COMMAND_ADD;
    command.scale = scale;
    ring_.write(command);
    tick();
  }
  void tick() {
    SceneForce* const forces[] = {force_.get()};
    now_ns_ += tick_ns;
    static_cast<void>(app_->begin(now_ns_, forces));
    app_->end(1, now_ns_, {}, forces);
  }
  /// The force along z on a tool that is half a millimetre deep in the added box, once it has come.
  [[nodiscard]] double pressed(double scale) {
    const AssetView* view = &tables_.view();
    const HandPose hand{away + Vector3(0, 0, scale * 2 * half - 5e-4)};
    double last = 0;
    for (int i = 0; i < 200; ++i) last = force_->next({&view, 1}, hand).force.z();
    return last;
  }
  /// Why the last command was refused, where one was.
  [[nodiscard]] Refusal refusal() const {
    return static_cast<Refusal>(ring_.ring().refused == 0 ? 0 : ring_.ring().last_refusal);
  }
  [[nodiscard]] AppScene& app() { return *app_; }

 private:
  static constexpr std::uint64_t connection = 1;

  Asset asset_;
  AssetTables tables_;
  ForceScene scene_ = scene_of({});
  std::unique_ptr<AppState> state_ = small_state();
  RawRing ring_{connection};
  std::unique_ptr<SampledTool> sampled_;
  std::unique_ptr<SceneForce> force_;
  std::unique_ptr<AppScene> app_;
  std::uint64_t added_ = 0;
  std::int64_t now_ns_ = 1'000'000'000;
};

}  // namespace

TEST_CASE("An object that an application adds beside a full tool is felt, by the paper's method") {
  for (const double scale : {1.0, 2.0}) {
    PaperTool scene(scale);
    CHECK(scene.pressed(scale) == 0);
    scene.add(scale);
    CHECK(scene.refusal() == Refusal::none);
    CHECK(scene.pressed(scale) > 0.1);
  }
}

TEST_CASE("An object that the scene's tool cannot meet is refused, and the application told why") {
  PaperTool scene(1);
  scene.add(2);
  CHECK(scene.refusal() == Refusal::unlike_tool);
  CHECK(scene.pressed(2) == 0);
  PaperTool sparse(1);
  sparse.app().set_form(0, false, {});
  sparse.add(1);
  CHECK(sparse.refusal() == Refusal::unlike_tool);
  CHECK(sparse.pressed(1) == 0);
  CHECK(std::string(to_sentence(Refusal::unlike_tool)).find("sparse") != std::string::npos);
}

}  // namespace app_tool_test
