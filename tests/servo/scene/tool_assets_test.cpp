// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "servo/scene/scene_assets.hpp"
#include "servo/scene/scene_keeper.hpp"
#include "tests/servo/support/eventually.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace tool_assets_test {

using namespace spm;
using namespace spm::servo;
using spm::test::eventually;

namespace {

const std::string text =
    "[tool]\nasset = \"peg.spm.exr\"\nsamples = 400\n[[object]]\nasset = \"ball.spm.exr\"\n";

/// A scene of a peg, which is the tool, and a ball, opened.
struct Opened {
  test::TemporaryFolder folder;
  ForceOptions options;
  std::unique_ptr<SceneAssets> assets;

  explicit Opened(const std::string& scene = text) {
    test::write(test::shape_asset(test::box({6e-3, 24e-3, 6e-3})), file("peg.spm.exr"));
    test::write(test::shape_asset(test::sphere(0.02, 2)), file("ball.spm.exr"));
    save(scene);
    options.scene = file("scene.toml");
  }
  [[nodiscard]] Result<std::unique_ptr<SceneAssets>> open() const {
    const auto choice = choose_forces(options);
    REQUIRE(choice);
    KeeperOptions each;
    each.lock = false;
    each.poll = each.retry = std::chrono::milliseconds(2);
    return SceneAssets::open(each, *choice, 0, {2, 3});
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder.file(name); }
  void save(const std::string& scene) const {
    std::ofstream(file("new.toml")) << scene;
    std::filesystem::rename(file("new.toml"), file("scene.toml"));
  }
};

}  // namespace

TEST_CASE("The tool's asset is sampled when it is opened, and no other is") {
  const Opened opened;
  const auto assets = opened.open();
  REQUIRE(assets);
  const auto reports = (*assets)->reports();
  REQUIRE(reports.size() == 2);
  CHECK(reports[0].tools.empty());
  REQUIRE(reports[1].tools.size() == 1);
  CHECK(reports[1].tools[0].samples > 50);
  CHECK(reports[1].tools[0].samples <= 400);
  CHECK(reports[1].tool_bytes > 0);
  const std::vector<AssetSlot*> slots = (*assets)->slots();
  CHECK(slots[0]->acquire()->tool == nullptr);
  const ServedAsset* peg = slots[1]->acquire();
  REQUIRE(peg->tool != nullptr);
  CHECK(peg->tool == (*assets)->tool());
  CHECK(peg->tool->samples().levels.back().count == reports[1].tools[0].samples);
}

TEST_CASE("Two hands' tools of one file are told each with its own samples") {
  const std::string peg = "[[tool]]\nasset = \"peg.spm.exr\"\nsamples = ";
  const Opened opened(peg + "400\n" + peg + "100\n[[object]]\nasset = \"ball.spm.exr\"\n");
  const auto assets = opened.open();
  if (!assets) FAIL(assets.error().message);
  const std::vector<ToolReport> tools = (*assets)->reports()[1].tools;
  REQUIRE(tools.size() == 2);
  CHECK(tools[0].samples > 100);
  CHECK(tools[1].samples <= 100);
  CHECK(tools[1].spacing > tools[0].spacing);
}

TEST_CASE(
    "A tool that was baked again is sampled again, and the old one lives while it is in use") {
  const Opened opened;
  auto assets = opened.open();
  REQUIRE(assets);
  AssetSlot& slot = *(*assets)->slots()[1];
  const ServedAsset* before = slot.acquire();
  const SurfaceSamples& old = before->tool->samples();
  const double radius = old.radius;
  (*assets)->watch();
  test::write(test::shape_asset(test::box({6e-3, 30e-3, 6e-3})), opened.file("peg.spm.exr"));
  REQUIRE(eventually([&] { return (*assets)->reports()[1].reloads == 1; }));
  // Not taken up yet: what the loop uses is still there.
  CHECK(old.radius == radius);
  const ServedAsset* after = slot.acquire();
  REQUIRE(after != before);
  CHECK(after->tool->samples().radius > radius + 2e-3);
  slot.release();
}

TEST_CASE("A full tool of method paper is opened, and has no samples") {
  const Opened opened(
      "[tool]\nasset = \"full.spm.exr\"\n[[object]]\nasset = \"object.spm.exr\"\nmethod = "
      "\"paper\"\n");
  test::write(test::box_asset(0.02), opened.file("full.spm.exr"));
  test::write(test::box_asset(0.04), opened.file("object.spm.exr"));
  const auto assets = opened.open();
  if (!assets) FAIL(assets.error().message);
  const std::vector<ToolReport> tools = (*assets)->reports()[1].tools;
  REQUIRE(tools.size() == 1);
  CHECK(tools[0].samples == 0);
  CHECK((*assets)->tool() != nullptr);
}

TEST_CASE("A tool that cannot be sampled is refused with its line and its file") {
  const Opened opened(
      "[tool]\nasset = \"peg.spm.exr\"\nspacing = \"1um\"\n[[object]]\nasset = \"ball.spm.exr\"\n");
  const auto assets = opened.open();
  REQUIRE_FALSE(assets);
  INFO(assets.error().message);
  CHECK(assets.error().message.find("scene.toml: line 2: ") != std::string::npos);
  CHECK(assets.error().message.find("peg.spm.exr: ") != std::string::npos);
}

TEST_CASE("Another tool needs a restart, the same in another order does not") {
  const Opened opened;
  auto assets = opened.open();
  REQUIRE(assets);
  std::vector<std::string> said;
  std::mutex mutex;
  SceneKeeperOptions options;
  options.force = opened.options;
  options.poll = std::chrono::milliseconds(5);
  options.tell = options.warn = [&](const std::string& sentence) {
    const std::lock_guard lock(mutex);
    said.push_back(sentence);
  };
  const auto told = [&](std::size_t nth) {
    static_cast<void>(eventually([&] {
      const std::lock_guard lock(mutex);
      return said.size() > nth;
    }));
    const std::lock_guard lock(mutex);
    return said.size() > nth ? said[nth] : std::string();
  };
  SceneKeeper keeper(options, **assets);
  keeper.watch();
  opened.save("[[object]]\nasset = \"ball.spm.exr\"\n[tool]\nasset = \"peg.spm.exr\"\nscale = 2\n");
  CHECK(told(0).find("[tool] is another now") != std::string::npos);
  opened.save(
      "[[object]]\nasset = \"ball.spm.exr\"\n[tool]\nasset = \"peg.spm.exr\"\nsamples = 400\n");
  CHECK(told(1).find("nothing is different") != std::string::npos);
  opened.save("[[object]]\nasset = \"ball.spm.exr\"\n");
  CHECK(told(2).find("[tool] is another now") != std::string::npos);
}

}  // namespace tool_assets_test
