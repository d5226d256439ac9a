// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/scene_keeper.hpp"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/smooth_change.hpp"
#include "servo/loop/loop.hpp"
#include "tests/servo/support/eventually.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace scene_keeper_test {

using namespace spm;
using namespace spm::servo;
using spm::test::contains;
using spm::test::eventually;

namespace {

constexpr double size = 0.04;
/// How deep the hand is inside the box at the origin, m.
constexpr double depth = 1e-3;

const std::string box = "[[object]]\nasset = \"box.spm.exr\"\n";
const std::string other = "[[object]]\nasset = \"other.spm.exr\"\n";

/// A folder with assets and a scene, its keeper, and what the keeper said.
class Edited {
 public:
  explicit Edited(const std::string& scene = box, std::size_t spare = spare_assets) {
    test::write(test::box_asset(size), folder_.file("box.spm.exr"));
    test::write(test::box_asset(size), folder_.file("other.spm.exr"));
    save(scene);
    ForceOptions force;
    force.scene = folder_.file("scene.toml");
    const auto choice = choose_forces(force);
    REQUIRE(choice);
    KeeperOptions each;
    each.lock = false;
    each.poll = each.retry = std::chrono::milliseconds(2);
    const auto say = [this](const std::string& text) {
      const std::lock_guard lock(mutex_);
      said_.push_back(text);
    };
    each.warn = say;
    auto opened = SceneAssets::open(each, *choice, spare);
    REQUIRE(opened);
    assets = std::move(*opened);
    SceneKeeperOptions options;
    options.force = force;
    options.poll = std::chrono::milliseconds(5);
    options.retry = std::chrono::milliseconds(20);
    options.tell = options.warn = say;
    options.taken_up = [this](const ServedScene& served) {
      const std::lock_guard lock(mutex_);
      served_ = served;
    };
    keeper = std::make_unique<SceneKeeper>(std::move(options), *assets);
  }

  /// Saves as an editor does: writes another file and renames it over the old one.
  void save(const std::string& scene) const {
    write("scene.toml.new", scene);
    std::filesystem::rename(file("scene.toml.new"), file("scene.toml"));
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(file(name)) << text;
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

  [[nodiscard]] std::vector<std::string> said() const {
    const std::lock_guard lock(mutex_);
    return said_;
  }
  /// Waits for the nth message, counted from 0, and returns it.
  [[nodiscard]] std::string said(std::size_t nth) const {
    static_cast<void>(eventually([&] { return said().size() > nth; }));
    const auto all = said();
    return all.size() > nth ? all[nth] : "";
  }
  [[nodiscard]] bool has_said(const std::string& text) const {
    const auto all = said();
    return std::any_of(all.begin(), all.end(),
                       [&](const std::string& each) { return contains(each, text); });
  }
  /// Waits for a message that contains `text`, whichever it is.
  [[nodiscard]] bool comes_to_say(const std::string& text) const {
    return eventually([&] { return has_said(text); });
  }
  [[nodiscard]] ServedScene served() const {
    const std::lock_guard lock(mutex_);
    return served_;
  }

  /// Acts as the loop: waits for the next edit, answers it and returns it.
  [[nodiscard]] SceneEdit take(EditAnswer answer = EditAnswer::done) const {
    const SceneEdit* edit = nullptr;
    REQUIRE(eventually([&] { return (edit = keeper->edits().pending()) != nullptr; }));
    SceneEdit copy = *edit;
    keeper->edits().answer_with(answer);
    return copy;
  }

 private:
  test::TemporaryFolder folder_;
  mutable std::mutex mutex_;
  std::vector<std::string> said_;
  ServedScene served_;

 public:
  std::unique_ptr<SceneAssets> assets;
  std::unique_ptr<SceneKeeper> keeper;  ///< its thread ends first
};

}  // namespace

TEST_CASE("A scene that was edited is handed to the loop, and told in a sentence") {
  const Edited edited(box + "stiffness = \"1N/mm\"\n" + other);
  edited.keeper->watch();
  edited.save(box + "stiffness = \"2N/mm\"\n" + other + "pose = [0, 0, 1]\n");
  const SceneEdit edit = edited.take();
  REQUIRE(edit.changed.size() == 2);
  CHECK(edit.changed[0].id == 0);
  CHECK(edit.changed[0].settings.force.stiffness == 2000);
  CHECK_FALSE(edit.changed[0].moved);
  CHECK(edit.changed[1].moved);
  CHECK(edit.changed[1].settings.asset == 1);
  CHECK(edit.added.empty());
  CHECK(edit.removed.empty());
  CHECK(edit.assets == 2);
  CHECK(edited.said(0) ==
        edited.file("scene.toml") + ": taken up again: object 0: stiffness; object 1: pose");
  CHECK(edited.said().size() == 1);
}

TEST_CASE("An edit in place is taken up as one that replaces the file") {
  const Edited edited;
  edited.keeper->watch();
  edited.write("scene.toml", box + "damping = \"3Ns/m\"\n");
  const SceneEdit edit = edited.take();
  REQUIRE(edit.changed.size() == 1);
  CHECK(edit.changed[0].settings.effects.damping == 3);
}

TEST_CASE("Other stabilizers of a scene are handed to the loop, and the same ones are nothing") {
  const Edited edited;
  edited.keeper->watch();
  edited.save("[stabilization]\ndamping = 0.8\npassivity = true\n" + box);
  const SceneEdit edit = edited.take();
  REQUIRE(edit.stabilization);
  CHECK(edit.stabilization->damping_share == 0.8);
  CHECK(edit.stabilization->passivity);
  CHECK(edit.changed.empty());
  CHECK(contains(edited.said(0), "taken up again: stabilization"));
  edited.save("[stabilization]\npassivity = true\ndamping = 0.8\n" + box);
  CHECK(contains(edited.said(1), "nothing is different"));
  edited.save("[stabilization]\npassivity = true\ndamping = 0.8\n" + box + "movable = true\n");
  CHECK_FALSE(edited.take().stabilization);
  edited.save("[stabilization]\n" + box);
  const SceneEdit off = edited.take();
  REQUIRE(off.stabilization);
  CHECK_FALSE(off.stabilization->any());
}

TEST_CASE("What was edited between the daemon's reading and its first look is taken up") {
  const Edited edited;
  edited.save(box + "movable = true\n");
  edited.keeper->watch();
  const SceneEdit edit = edited.take();
  REQUIRE(edit.changed.size() == 1);
  CHECK(edit.changed[0].settings.movable);
}

TEST_CASE("A scene that will not do is told once, with its line, and the old one stays") {
  struct Case {
    std::string scene;
    std::vector<std::string> names;
  };
  const std::vector<Case> cases{
      {box + "stiffness = \n", {"scene.toml: line 3", "not TOML"}},
      {box + "stifness = \"1N/mm\"\n", {"scene.toml: line 3", "did you mean 'stiffness'?"}},
      {box + "stiffness = \"2000N/mm\"\n", {"scene.toml: line 1", "out of range"}},
      {box + "[[object]]\nasset = \"none.spm.exr\"\n", {"none.spm.exr"}},
      {box + "method = \"spm\"\n[tool]\nprobe = \"capsule:1mm,5mm\"\n", {"knows no probe"}},
      {"[workspace]\nscale = 2\n" + box, {"[workspace]", "start it again"}},
      {"[device]\nforce_cap = \"1N\"\n" + box, {"'force_cap' of [device]", "start it again"}},
      {"[device]\nprofile = \"touch\"\n" + box, {"'profile' of [device]", "start it again"}},
      {"[tool]\nprobe = \"sphere:0.1mm\"\n" + box, {"'probe' of [tool]", "start it again"}},
      {"", {"[[object]]"}},
  };
  const Edited edited;
  edited.keeper->watch();
  std::size_t nth = 0;
  for (const Case& wrong : cases) {
    CAPTURE(wrong.scene);
    edited.save(wrong.scene);
    const std::string said = edited.said(nth++);
    CAPTURE(said);
    CHECK(contains(said, "the scene stays as it was"));
    for (const std::string& name : wrong.names) CHECK(contains(said, name));
  }
  std::filesystem::remove(edited.file("scene.toml"));
  CHECK(contains(edited.said(nth++), "cannot be opened"));
  CHECK(edited.keeper->edits().pending() == nullptr);

  edited.save(box);
  CHECK(contains(edited.said(nth), "nothing is different"));
  CHECK(edited.said().size() == nth + 1);
  CHECK(edited.keeper->edits().pending() == nullptr);
}

TEST_CASE("An asset that the scene names newly is there before the loop is told of its object") {
  const Edited edited;
  const std::vector<AssetSlot*> slots = edited.assets->slots();
  REQUIRE(slots.size() == 1 + spare_assets);
  CHECK(slots[1]->acquire() == nullptr);
  edited.keeper->watch();
  edited.save(other + box);
  const SceneEdit* edit = nullptr;
  REQUIRE(eventually([&] { return (edit = edited.keeper->edits().pending()) != nullptr; }));
  CHECK(edit->assets == 2);
  CHECK(edit->changed.empty());
  REQUIRE(edit->added.size() == 1);
  CHECK(edit->added[0].settings.asset == 1);
  CHECK(edit->added[0].id == 1);
  CHECK(slots[1]->acquire() != nullptr);
  edited.keeper->edits().answer_with(EditAnswer::done);
  CHECK(contains(edited.said(0), "object 1 added (other.spm.exr)"));
  REQUIRE(eventually([&] { return edited.served().ids == std::vector<std::uint64_t>{1, 0}; }));
  CHECK(edited.served().choice.assets.size() == 2);

  // The asset's object is removed again; the asset stays.
  edited.save(box);
  CHECK(edited.take().removed == std::vector<std::uint64_t>{1});
  CHECK(contains(edited.said(1), "object 1 removed"));
  CHECK(slots[1]->acquire() != nullptr);
  for (AssetSlot* slot : slots) slot->release();
}

TEST_CASE("A scene whose asset is not baked yet is taken up when it is") {
  const Edited edited;
  edited.keeper->watch();
  edited.save(box + "[[object]]\nasset = \"later.spm.exr\"\n");
  CHECK(contains(edited.said(0), "later.spm.exr"));
  test::write(test::box_asset(size), edited.file("later.spm.exr"));
  CHECK(edited.take().added.size() == 1);
  CHECK(contains(edited.said(1), "object 1 added (later.spm.exr)"));
}

TEST_CASE("Without a slot for another asset the scene stays as it was") {
  const Edited edited(box, 0);
  edited.keeper->watch();
  edited.save(box + other);
  CHECK(contains(edited.said(0), "other.spm.exr: no more new assets"));
}

TEST_CASE("An edit that the loop has no room for is told, and tried again") {
  const Edited edited;
  edited.keeper->watch();
  edited.save(box + box);
  CHECK(edited.take(EditAnswer::no_room).added.size() == 1);
  CHECK(contains(edited.said(0), "no room"));
  const SceneEdit again = edited.take();
  REQUIRE(again.added.size() == 1);
  CHECK(again.added[0].id == 1);
  CHECK(contains(edited.said(1), "object 1 added"));
}

TEST_CASE("An asset that is baked again has to serve the edited scene") {
  const Edited edited;
  edited.assets->watch();
  edited.keeper->watch();
  edited.save(box + "method = \"paper\"\n");
  CHECK(edited.take().changed.size() == 1);
  REQUIRE(contains(edited.said(0), "object 0: method"));
  // The first scene would have accepted a sparse asset.
  test::write(test::shape_asset(test::box({size, size, size})), edited.file("box.spm.exr"));
  // A file that is renamed into place while it is being opened is told of as well, and tried again.
  CHECK(edited.comes_to_say("--form full"));
  CHECK(edited.comes_to_say("served on as it was"));
  CHECK_FALSE(edited.has_said("loaded again"));
  test::write(test::box_asset(size), edited.file("box.spm.exr"));
  CHECK(edited.comes_to_say("loaded again"));
}

TEST_CASE("Edits in a row are felt by the hand, none as a step") {
  Edited edited;
  auto state = AppState::create(1000, {{"hand"}, {"box"}, {"box"}});
  REQUIRE(state);
  std::atomic<std::uint64_t> reads{0};
  test::ScriptedDevice device([&](std::size_t, DeviceState& hand, DeviceHealth&) {
    hand.position = {0, 0, size / 2 - depth};
    reads.fetch_add(1);
  });
  TickRing ring = make_tick_ring(1000, 1);
  std::atomic<bool> stop{false};
  LoopSettings settings;
  settings.scene = edited.assets->choice().scene;
  Loop loop(settings, {&device}, edited.assets->slots(), ring, stop, state->get(),
            &edited.keeper->edits());
  edited.assets->watch();
  edited.keeper->watch();
  std::thread thread([&] { loop.run(); });

  double largest_step = 0;  ///< N a tick, of what was sent
  double last = 0;          ///< N
  std::uint64_t last_tick = 0;
  TickRecord record;
  const auto comes_to = [&](double force) {
    // Once faded in it stays: a fade passes through every lesser value.
    int steady = 0;
    return eventually([&] {
      while (ring.try_dequeue(record)) {
        const double ticks = static_cast<double>(std::max<std::uint64_t>(
            record.tick - std::min(record.tick, std::exchange(last_tick, record.tick)), 1));
        const double step = (record.sent.force.z() - std::exchange(last, record.sent.force.z()));
        largest_step = std::max(largest_step, step / ticks);
        steady = std::abs(record.sent.force.z() - force) < 1e-3 ? steady + 1 : 0;
      }
      return steady > 20;
    });
  };
  CHECK(comes_to(1));
  edited.save(box + "stiffness = \"2N/mm\"\n");
  CHECK(comes_to(2));
  edited.save(box + "stiffness = \"2N/mm\"\npose = [0, 0, 0.0005]\n");
  CHECK(comes_to(3));
  edited.save(box + "stiffness = \"2N/mm\"\npose = [0, 0, 0.0005]\n" + other);
  CHECK(comes_to(4));
  edited.save("[stabilization]\ncoupling = \"1N/mm\"\n" + other);
  CHECK(comes_to(0.8));
  edited.save(other);
  CHECK(comes_to(1));
  // It does not matter what happens to the asset of an object that is gone.
  std::filesystem::resize_file(edited.file("box.spm.exr"), 100);
  CHECK(eventually([&] { return edited.assets->reports()[0].losses == 1; }));
  const std::uint64_t then = reads.load();
  CHECK(eventually([&] { return reads.load() > then + 50; }));
  CHECK(comes_to(1));
  // It does matter for an object that is still there.
  std::filesystem::resize_file(edited.file("other.spm.exr"), 100);
  CHECK(comes_to(0));
  stop.store(true);
  thread.join();

  // The surface came under the hand at once, and its force without a step.
  CHECK(largest_step > 0);
  CHECK(largest_step <= change_rate * 1e-3 + 1e-9);
  const std::vector<std::string> said = edited.said();
  CHECK(std::count_if(said.begin(), said.end(), [](const std::string& text) {
          return contains(text, "taken up again");
        }) == 5);
}

}  // namespace scene_keeper_test
