// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "servo/devices/sim/device_sim.hpp"
#include "servo/loop/loop.hpp"
#include "servo/realtime/realtime.hpp"
#include "tests/servo/support/intercepted_calls.hpp"
#include "tests/servo/support/shape_asset.hpp"
#include "tests/support/skip.hpp"

namespace tick_test {

using namespace spm;
using namespace spm::servo;

namespace {

/// The simulated device. From its first read on, everything that the loop's thread does is watched.
class WatchedSim final : public Device {
 public:
  WatchedSim() : sim_(SimOptions{}) {}

  [[nodiscard]] Result<void> open(const DeviceSetup& setup) override { return sim_.open(setup); }
  [[nodiscard]] const DeviceCapabilities& capabilities() const noexcept override {
    return sim_.capabilities();
  }
  [[nodiscard]] DeviceHealth read(DeviceState& state) noexcept override {
    if (reads_++ == 0) test::watch(true);
    return sim_.read(state);
  }
  [[nodiscard]] DeviceHealth write(const Wrench& wrench) noexcept override {
    return sim_.write(wrench);
  }
  [[nodiscard]] nlohmann::ordered_json describe() const override { return sim_.describe(); }

  [[nodiscard]] std::uint64_t reads() const { return reads_; }

 private:
  DeviceSim sim_;
  std::uint64_t reads_ = 0;
};

}  // namespace

TEST_CASE("The interception sees an allocation, a lock and an output") {
  test::watch(true);
  const auto before = test::intercepted_calls();
  {
    const auto on_heap = std::make_unique<std::vector<int>>(100);
    REQUIRE(on_heap->size() == 100);
  }
  std::mutex mutex;
  mutex.lock();
  mutex.unlock();
  REQUIRE(::write(STDOUT_FILENO, "", 0) == 0);
  const auto after = test::intercepted_calls();
  test::watch(false);
  REQUIRE(after.allocations >= before.allocations + 2);
  REQUIRE(after.locks > before.locks);
  REQUIRE(after.writes > before.writes);
}

TEST_CASE("A tick neither allocates, locks nor writes") {
  constexpr std::uint64_t ticks = 2000;
  const Asset box = test::box_asset(0.04);
  const AssetTables tables = tables_of(box);
  const ServedAsset served{&tables.view()};
  const std::array<const AssetView*, 1> assets{&tables.view()};
  for (const Method method : {Method::spm, Method::paper}) {
    AssetSlot slot;
    slot.offer(&served);
    LoopSettings settings;
    settings.ticks = ticks;
    settings.scene.objects.front().force.method = method;
    WatchedSim device;
    REQUIRE(device.open({settings.rate_hz, RealtimeMode::off, settings.scene, assets}));
    TickRing ring = make_tick_ring(settings.rate_hz, 1);
    const std::atomic<bool> stop{false};
    Loop loop(settings, {&device}, {&slot}, ring, stop);
    test::InterceptedCalls calls;
    std::thread thread([&] {
      const auto before = test::intercepted_calls();
      loop.run();
      test::watch(false);
      calls = test::intercepted_calls() - before;
    });
    thread.join();
    REQUIRE(device.reads() > 1000);
    REQUIRE(loop.counters().contact_ticks > 500);
    REQUIRE(calls.allocations == 0);
    REQUIRE(calls.locks == 0);
    REQUIRE(calls.writes == 0);
  }
}

TEST_CASE("A tick does not fault a page once the memory is locked") {
  const Asset box = test::box_asset(0.04);
  const AssetTables tables = tables_of(box);
  const ServedAsset served{&tables.view()};
  const std::array<const AssetView*, 1> assets{&tables.view()};
  AssetSlot slot;
  slot.offer(&served);
  LoopSettings settings;
  settings.ticks = 2000;
  DeviceSim device{SimOptions{}};
  REQUIRE(device.open({settings.rate_hz, RealtimeMode::off, settings.scene, assets}));
  TickRing ring = make_tick_ring(settings.rate_hz, 1);
  const std::atomic<bool> stop{false};
  Loop loop(settings, {&device}, {&slot}, ring, stop);
  Result<RealtimeState> realtime;
  std::thread thread([&] {
    realtime = enter_realtime(RealtimeMode::attempt);
    loop.run();
  });
  thread.join();
  REQUIRE(realtime);
  if (!realtime->memory_locked) {
    SPM_SKIP("the memory cannot be locked here; run as root or raise the memlock limit");
  }
  REQUIRE(loop.counters().page_faults == 0);
}

}  // namespace tick_test
