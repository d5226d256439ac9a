// SPDX-License-Identifier: Apache-2.0
// An edited scene beside what applications did to its objects.
#include <catch2/catch.hpp>
#include <map>
#include <memory>

#include "servo/app/app_scene.hpp"
#include "servo/client/state_reader.hpp"
#include "tests/servo/support/loop_stand_in.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace app_scene_edit_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

constexpr double half = 0.02;
constexpr std::int64_t second = 1'000'000'000;

/// A scene of boxes, far from each other along x, as the loop has it, and an application.
class Edited {
 public:
  explicit Edited(std::size_t objects)
      : asset_(box_asset(2 * half)), tables_(tables_of(asset_)), scene_(scene_of_boxes(objects)) {
    force_ = std::make_unique<SceneForce>(scene_, 1e-3, 1e-6, AppScene::room(scene_));
    app_ = std::make_unique<AppScene>(*state_, scene_);
    state_->rings()[0].offer(ring_.attached());
    tick();
  }

  void send(const spm_shared_command& command) { ring_.write(command); }
  /// Runs a tick one second later, when everything has reached the place it was sent to.
  void tick() {
    now_ns_ += second;
    changes_ = app_->begin(now_ns_, forces());
    app_->end(1, now_ns_, {}, forces());
  }
  [[nodiscard]] bool edit(const SceneEdit& edit) { return app_->edit(edit, now_ns_, forces()); }

  /// The force along z of a hand 1 mm deep in the top of a box at x.
  [[nodiscard]] double force_at(double x) {
    force_->reset();
    const AssetView* view = &tables_.view();
    return force_->next({&view, 1}, Vector3(x, 0, half - 1e-3)).force.z();
  }
  /// What applications are told of the objects, by their ids.
  [[nodiscard]] std::map<std::uint64_t, spm_shared_object> told() const {
    std::map<std::uint64_t, spm_shared_object> all;
    const auto& shared = *static_cast<const spm_shared_state*>(state_->memory().data());
    REQUIRE(read_newest(shared, [&all](const auto& snapshot) {
              all.clear();
              for (std::uint32_t i = 0; i < object_count(snapshot); ++i) {
                all[snapshot.objects[i].id] = snapshot.objects[i];
              }
              return true;
            }) == ReadResult::fine);
    return all;
  }
  [[nodiscard]] PlacedObject settings(std::size_t object) const { return scene_.objects[object]; }
  [[nodiscard]] const AppScene& app() const { return *app_; }
  /// What the last tick told the loop.
  [[nodiscard]] const AppChanges& changes() const { return changes_; }

 private:
  static ForceScene scene_of_boxes(std::size_t count) {
    ForceScene scene;
    for (std::size_t i = 0; i < count; ++i) {
      PlacedObject object;
      object.placement.position.x() = static_cast<double>(i);
      object.movable = true;
      scene.objects.push_back(object);
    }
    return scene;
  }
  std::vector<SceneForce*> forces() { return {force_.get()}; }

  Asset asset_;
  AssetTables tables_;
  ForceScene scene_;
  std::unique_ptr<AppState> state_ = small_state();
  RawRing ring_{1};
  std::unique_ptr<SceneForce> force_;
  std::unique_ptr<AppScene> app_;
  AppChanges changes_;
  std::int64_t now_ns_ = 0;
};

SceneEdit change_of(std::uint64_t id, const PlacedObject& settings, bool moved) {
  SceneEdit edit;
  edit.changed.push_back({id, settings, moved});
  edit.assets = 1;
  return edit;
}

}  // namespace

TEST_CASE("An object that an application moved stays there unless its pose was edited") {
  Edited scene(1);
  scene.send(move_command(0, 0.3));
  scene.tick();
  scene.tick();
  REQUIRE(scene.force_at(0.3) == Approx(1));

  PlacedObject edited = scene.settings(0);
  edited.force.stiffness = 500;
  REQUIRE(scene.edit(change_of(0, edited, false)));
  CHECK(scene.force_at(0.3) == Approx(0.5));
  scene.tick();
  CHECK(scene.force_at(0.3) == Approx(0.5));
  CHECK(scene.told().at(0).position[0] == Approx(0.3));

  edited.placement.position.x() = -0.4;
  REQUIRE(scene.edit(change_of(0, edited, true)));
  // The object moves at once, however far.
  CHECK(scene.force_at(-0.4) == Approx(0.5));
  CHECK(scene.force_at(0.3) == 0);
  scene.tick();
  CHECK(scene.force_at(-0.4) == Approx(0.5));
  CHECK(scene.told().at(0).position[0] == Approx(-0.4));

  // The application goes on from there.
  scene.send(move_command(0, 0.1));
  scene.tick();
  scene.tick();
  CHECK(scene.force_at(0.1) == Approx(0.5));
}

TEST_CASE("What an edit does not touch stays as an application made it") {
  Edited scene(2);
  spm_shared_command softer{};
  softer.kind = SPM_COMMAND_MATERIAL;
  softer.object = 1;
  softer.fields = SPM_MATERIAL_STIFFNESS;
  softer.stiffness = 250;
  scene.send(softer);
  scene.tick();
  PlacedObject edited = scene.settings(0);
  edited.force.stiffness = 3000;
  REQUIRE(scene.edit(change_of(0, edited, false)));
  CHECK(scene.force_at(0) == Approx(3));
  CHECK(scene.force_at(1) == Approx(0.25));
}

TEST_CASE("Objects of an edit come and go under their ids") {
  Edited scene(3);
  SceneEdit edit;
  edit.removed = {1};
  PlacedObject added = scene.settings(0);
  added.placement.position.x() = 7;
  edit.added.push_back({3, added, true});
  edit.assets = 1;
  REQUIRE(scene.edit(edit));
  scene.tick();
  CHECK(scene.force_at(1) == 0);
  CHECK(scene.force_at(7) == Approx(1));
  const auto told = scene.told();
  CHECK(told.size() == 3);
  CHECK(told.count(1) == 0);
  CHECK(told.at(3).position[0] == 7);

  scene.send(move_command(3, 5));
  scene.tick();
  scene.tick();
  scene.tick();
  scene.tick();
  CHECK(scene.force_at(5) == Approx(1));
  edit = {};
  edit.removed = {0, 2, 3};
  REQUIRE(scene.app().uses(0));
  REQUIRE(scene.edit(edit));
  CHECK_FALSE(scene.app().uses(0));
  CHECK(scene.force_at(0) == 0);
}

TEST_CASE("The loop is told how stiff the stiffest object is, whoever brought it or took it away") {
  Edited scene(2);
  const double before = scene.settings(0).force.stiffness;
  CHECK(scene.changes().stiffest == before);
  PlacedObject stiff = scene.settings(1);
  stiff.force.stiffness = 4 * before;
  REQUIRE(scene.edit(change_of(1, stiff, false)));
  scene.tick();
  CHECK(scene.changes().stiffest == 4 * before);

  stiff.force.stiffness = 5 * before;
  SceneEdit edit;
  edit.added.push_back({2, stiff, true});
  edit.removed = {1};
  edit.assets = 1;
  REQUIRE(scene.edit(edit));
  scene.tick();
  CHECK(scene.changes().stiffest == 5 * before);

  edit = {};
  edit.removed = {2};
  edit.assets = 1;
  REQUIRE(scene.edit(edit));
  scene.tick();
  CHECK(scene.changes().stiffest == before);

  spm_shared_command softer{};
  softer.kind = SPM_COMMAND_MATERIAL;
  softer.fields = SPM_MATERIAL_STIFFNESS;
  softer.stiffness = before / 2;
  scene.send(softer);
  scene.tick();
  CHECK(scene.changes().stiffest == before / 2);
}

TEST_CASE("An edit alone does not count as an application's doing, a move does from then on") {
  Edited scene(2);
  PlacedObject moved = scene.settings(1);
  moved.placement.position.y() = 3;
  REQUIRE(scene.edit(change_of(1, moved, true)));
  scene.tick();
  CHECK_FALSE(scene.changes().touched);
  scene.send(move_command(0, 5));
  scene.tick();
  CHECK(scene.changes().touched);
  REQUIRE(scene.edit(change_of(0, moved, true)));
  scene.tick();
  CHECK(scene.changes().touched);
}

TEST_CASE("An edit that there is no room for changes nothing, one that makes room is taken up") {
  Edited scene(2);
  SceneEdit edit;
  edit.assets = 1;
  PlacedObject added = scene.settings(0);
  for (std::uint64_t id = 2; id < SPM_MAX_OBJECTS; ++id) {
    added.placement.position.x() = static_cast<double>(id);
    edit.added.push_back({id, added, true});
  }
  edit.added.push_back({SPM_MAX_OBJECTS, added, true});
  PlacedObject softer = scene.settings(0);
  softer.force.stiffness = 100;
  edit.changed.push_back({0, softer, false});
  REQUIRE_FALSE(scene.edit(edit));
  CHECK(scene.force_at(0) == Approx(1));
  CHECK(scene.force_at(2) == 0);
  edit.removed = {1};
  REQUIRE(scene.edit(edit));
  scene.tick();
  CHECK(scene.force_at(0) == Approx(0.1));
  CHECK(scene.force_at(1) == 0);
  CHECK(scene.force_at(2) == Approx(1));
  CHECK(scene.told().size() == SPM_MAX_OBJECTS);
}

}  // namespace app_scene_edit_test
