// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/asset_keeper.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "servo/devices/sim/device_sim.hpp"
#include "servo/loop/loop.hpp"
#include "servo/scene/asset_watch.hpp"
#include "tests/servo/support/eventually.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace asset_keeper_test {

using namespace spm;
using namespace spm::servo;
using spm::test::eventually;
using spm::test::TemporaryFolder;

namespace {

constexpr double size = 0.04;

/// A damage to a file, as another process may do it.
struct Damage {
  const char* name;
  std::function<void(const std::string&)> apply;
};

void truncate_file(const std::string& path) {
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 3);
}

void edit_file(const std::string& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path) / 2));
  file.write("edited in place", 15);
}

void replace_file(const std::string& path) {
  std::ofstream(path + ".new") << "something else";
  std::filesystem::rename(path + ".new", path);
}

void delete_file(const std::string& path) { std::filesystem::remove(path); }

/// Of the bytes that are mapped.
const std::vector<Damage> damages{{"truncated", truncate_file}, {"edited", edit_file}};
/// Of the name alone.
const std::vector<Damage> losses_of_the_name{{"replaced", replace_file}, {"deleted", delete_file}};

KeeperOptions options_for(const std::string& path) {
  KeeperOptions options;
  options.path = path;
  options.lock = false;
  options.retry = std::chrono::milliseconds(10);
  options.longest_retry = std::chrono::milliseconds(20);
  return options;
}

/// A baked box that is served and watched.
struct WatchedBox {
  explicit WatchedBox(const std::function<void(KeeperOptions&)>& set = {}) {
    test::write(test::box_asset(size), path);
    KeeperOptions options = options_for(path);
    if (set) set(options);
    auto opened = AssetKeeper::open(options, slot);
    REQUIRE(opened);
    keeper = std::move(*opened);
    watch.add(*keeper);
    watch.start();
  }

  TemporaryFolder folder;
  std::string path = folder.file("box.spm.exr");
  AssetSlot slot;
  std::unique_ptr<AssetKeeper> keeper;
  AssetWatch watch{std::chrono::milliseconds(2)};
};

/// A loop whose hand presses on a box that is served and watched, 1 mm deep.
struct PressedBox {
  explicit PressedBox(const std::function<void(KeeperOptions&)>& set = {}) : box(set) {}
  ~PressedBox() { end(); }
  PressedBox(const PressedBox&) = delete;
  PressedBox& operator=(const PressedBox&) = delete;

  /// Waits for as many ticks more.
  [[nodiscard]] bool ticks_later(std::uint64_t count) {
    const std::uint64_t until = reads.load() + count;
    return eventually([&] { return reads.load() >= until; });
  }
  /// Ends the loop: what was sent can be looked at.
  void end() {
    stop.store(true);
    if (thread.joinable()) thread.join();
  }
  [[nodiscard]] std::uint64_t ticks_lost() const {
    return loop.device_counters(0).force_off[static_cast<std::size_t>(ForceOff::asset_lost)];
  }

  WatchedBox box;
  std::atomic<bool> stop{false};
  std::atomic<std::uint64_t> reads{0};
  test::ScriptedDevice device{[this](std::size_t, DeviceState& state, DeviceHealth&) {
    state.position = {0, 0, size / 2 - 1e-3};
    reads.fetch_add(1);
  }};
  TickRing ring = make_tick_ring(1000, 1);
  Loop loop{LoopSettings{}, {&device}, {&box.slot}, ring, stop};
  std::thread thread{[this] { loop.run(); }};
};

}  // namespace

TEST_CASE("One thread watches the files of several assets, also of one that is added later") {
  const TemporaryFolder folder;
  std::array<AssetSlot, 3> slots;
  std::vector<std::unique_ptr<AssetKeeper>> keepers;
  AssetWatch watch(std::chrono::milliseconds(2));
  const auto path_of = [&](std::size_t k) {
    return folder.file("box" + std::to_string(k) + ".spm.exr");
  };
  for (std::size_t k = 0; k < slots.size(); ++k) {
    test::write(test::box_asset(size), path_of(k));
    auto opened = AssetKeeper::open(options_for(path_of(k)), slots.at(k));
    REQUIRE(opened);
    keepers.push_back(std::move(*opened));
    watch.add(*keepers.back());
    if (k == 1) watch.start();
  }
  for (std::size_t k = 0; k < slots.size(); ++k) {
    truncate_file(path_of(k));
    REQUIRE(eventually([&] { return keepers[k]->report().losses == 1; }));
    REQUIRE_FALSE(keepers[k]->report().serving);
  }
  for (std::size_t k = 0; k < slots.size(); ++k) test::write(test::box_asset(size), path_of(k));
  for (std::size_t k = 0; k < slots.size(); ++k) {
    REQUIRE(eventually([&] { return keepers[k]->report().reloads == 1; }));
  }
}

TEST_CASE("An asset that is damaged under the loop is taken away and loaded when it is back") {
  for (const Damage& damage : damages) {
    CAPTURE(damage.name);
    WatchedBox box;
    REQUIRE(box.slot.acquire() != nullptr);

    damage.apply(box.path);
    REQUIRE(eventually([&] { return box.slot.acquire() == nullptr; }));
    REQUIRE(eventually([&] { return box.keeper->report().losses == 1; }));
    REQUIRE_FALSE(box.keeper->report().serving);
    REQUIRE(box.keeper->report().reloads == 0);

    test::write(test::box_asset(size), box.path);
    REQUIRE(eventually([&] { return box.slot.acquire() != nullptr; }));
    REQUIRE(eventually([&] { return box.keeper->report().reloads == 1; }));
    REQUIRE(box.keeper->report().serving);
    box.slot.release();
  }
}

TEST_CASE("A file that is replaced by another intact asset is served instead") {
  WatchedBox box;
  const std::string before = box.keeper->report().content_sha256;
  test::write(test::box_asset(size / 2), box.path);
  REQUIRE(eventually([&] {
    static_cast<void>(box.slot.acquire());
    return box.keeper->report().reloads == 1;
  }));
  const ServedAsset* served = box.slot.acquire();
  REQUIRE(served != nullptr);
  REQUIRE(served->mapping->metadata().box_max.x() == Approx(size / 4));
  REQUIRE(box.keeper->report().content_sha256 != before);
  box.slot.release();
}

TEST_CASE("An asset is served on from its old bytes where its file lost the name") {
  for (const Damage& damage : losses_of_the_name) {
    CAPTURE(damage.name);
    std::atomic<int> refusals{0};
    WatchedBox box([&](KeeperOptions& options) {
      options.warn = [&](const std::string&) { refusals.fetch_add(1); };
    });
    const ServedAsset* before = box.slot.acquire();
    damage.apply(box.path);
    REQUIRE(eventually([&] { return refusals.load() > 0; }));
    REQUIRE(box.slot.acquire() == before);
    REQUIRE(box.keeper->report().losses == 0);
    REQUIRE(box.keeper->report().serving);

    test::write(test::box_asset(size / 2), box.path);
    REQUIRE(eventually([&] { return box.keeper->report().reloads == 1; }));
    REQUIRE(box.keeper->report().losses == 0);
    REQUIRE(box.slot.acquire()->mapping->metadata().box_max.x() == Approx(size / 4));
    box.slot.release();
  }
}

TEST_CASE("Bytes that are served on after a loss of the name are taken away once they change") {
  WatchedBox box;
  const std::string other = box.folder.file("kept.spm.exr");
  std::filesystem::rename(box.path, other);
  REQUIRE(box.slot.acquire() != nullptr);
  edit_file(other);
  REQUIRE(eventually([&] { return box.slot.acquire() == nullptr; }));
  REQUIRE(eventually([&] { return box.keeper->report().losses == 1; }));
}

TEST_CASE("A sealed asset is served on from its old bytes, whatever becomes of the file") {
  std::vector<Damage> all = damages;
  all.insert(all.end(), losses_of_the_name.begin(), losses_of_the_name.end());
  for (const Damage& damage : all) {
    CAPTURE(damage.name);
    std::atomic<int> refusals{0};
    WatchedBox box([&](KeeperOptions& options) {
      options.mode = MapMode::sealed;
      options.warn = [&](const std::string&) { refusals.fetch_add(1); };
    });
    damage.apply(box.path);
    REQUIRE(eventually([&] { return refusals.load() > 0; }));
    REQUIRE(box.slot.acquire() != nullptr);
    REQUIRE(box.keeper->report().losses == 0);

    test::write(test::box_asset(size / 2), box.path);
    REQUIRE(eventually([&] { return box.keeper->report().reloads == 1; }));
    REQUIRE(box.slot.acquire()->mapping->metadata().box_max.x() == Approx(size / 4));
    box.slot.release();
  }
}

TEST_CASE("An intact asset that does not fit the settings is not loaded") {
  const TemporaryFolder folder;
  const std::string path = folder.file("box.spm.exr");
  test::write(test::box_asset(size), path);
  AssetSlot slot;
  KeeperOptions options = options_for(path);
  options.accept = [](const AssetMetadata&) -> Result<void> {
    return fail(ExitCode::invalid_input, "not this one");
  };
  const auto keeper = AssetKeeper::open(options, slot);
  REQUIRE_FALSE(keeper);
  REQUIRE(keeper.error().message == "not this one");
}

TEST_CASE("A file that is no asset is refused with exit code 3, a missing one with 2") {
  const TemporaryFolder folder;
  AssetSlot slot;
  std::ofstream(folder.file("text.spm.exr")) << "no asset";
  const auto text = AssetKeeper::open(options_for(folder.file("text.spm.exr")), slot);
  REQUIRE(text.error().code == ExitCode::invalid_input);
  const auto missing = AssetKeeper::open(options_for(folder.file("none.spm.exr")), slot);
  REQUIRE(missing.error().code == ExitCode::file_or_device);
}

TEST_CASE("The loop outlives an asset that is damaged while it is felt") {
  for (const Damage& damage : damages) {
    CAPTURE(damage.name);
    PressedBox pressed;
    const WatchedBox& box = pressed.box;
    CHECK(pressed.ticks_later(150));
    damage.apply(box.path);
    CHECK(eventually([&] { return box.keeper->report().losses == 1; }));
    CHECK(pressed.ticks_later(20));
    test::write(test::box_asset(size), box.path);
    CHECK(eventually([&] { return box.keeper->report().reloads == 1; }));
    CHECK(pressed.ticks_later(150));
    pressed.end();

    REQUIRE(pressed.ticks_lost() >= 15);
    const auto& forces = pressed.device.forces();
    REQUIRE(forces.back() == Vector3::Zero());
    REQUIRE(forces[forces.size() - 4].z() > 0.9);
    // Nothing but the box's own force, faded or whole, was ever sent.
    for (const Vector3& force : forces) REQUIRE(force.norm() <= 1.001);
  }
}

TEST_CASE("However long a new bake takes to be checked, no tick is without force") {
  PressedBox pressed([](KeeperOptions& options) {
    options.accept = [](const AssetMetadata&) -> Result<void> {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      return {};
    };
  });
  const WatchedBox& box = pressed.box;
  CHECK(pressed.ticks_later(150));
  for (std::uint64_t time = 1; time <= 5; ++time) {
    test::write(test::box_asset(size), box.path);
    CHECK(eventually([&] { return box.keeper->report().reloads == time; }));
    CHECK(pressed.ticks_later(20));
  }
  pressed.end();
  CHECK(pressed.ticks_lost() == 0);
}

TEST_CASE("A hand that presses on an asset feels force in every tick while it is baked again") {
  PressedBox pressed;
  const WatchedBox& box = pressed.box;
  CHECK(pressed.ticks_later(150));
  // Another bake, with other bytes; then a file that no servo can read; then a bake again.
  test::write(test::box_asset(size * 1.001), box.path);
  CHECK(eventually([&] { return box.keeper->report().reloads == 1; }));
  CHECK(pressed.ticks_later(20));
  replace_file(box.path);
  CHECK(pressed.ticks_later(50));
  test::write(test::box_asset(size), box.path);
  CHECK(eventually([&] { return box.keeper->report().reloads == 2; }));
  CHECK(pressed.ticks_later(150));
  pressed.end();
  REQUIRE(pressed.ticks_lost() == 0);
  const auto& forces = pressed.device.forces();
  for (std::size_t i = 150; i + 4 < forces.size(); ++i) REQUIRE(forces[i].z() > 0.9);
}

}  // namespace asset_keeper_test
