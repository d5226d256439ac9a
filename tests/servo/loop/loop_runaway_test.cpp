// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <vector>

#include "servo/loop/loop.hpp"
#include "tests/servo/support/eventually.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace loop_runaway_test {

using namespace spm;
using namespace spm::servo;
using spm::test::ScriptedDevice;

namespace {

constexpr double half = 0.02;            // m, of the box
constexpr double tick = 1e-3;            // s
constexpr std::size_t pressed_at = 300;  // a button acknowledges
constexpr std::ptrdiff_t bounced_at = 150;

/// Nobody holds a Falcon above a box; it comes down slowly, and each wrench acts with a sign. In
/// the end it is held above the box, and its button is pressed.
std::vector<TickRecord> records_of(double sign) {
  const DeviceProfile& profile = *find_device_profile("falcon");
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  ServedAsset served{&tables.view()};
  AssetSlot slot;
  slot.offer(&served);
  TickRing ring = make_tick_ring(1000, 1);
  std::atomic<bool> stop{false};
  double height = half + 1e-3, speed = -0.02;
  const ScriptedDevice* self = nullptr;
  ScriptedDevice device(
      [&](std::size_t read, DeviceState& state, DeviceHealth&) {
        if (read > 0 && read < pressed_at - 100) {
          speed += tick * sign * self->forces()[read - 1].z() / profile.moving_mass;
          height = std::max(half - 10e-3, height + tick * speed);
        } else if (read >= pressed_at - 100) {
          height = std::min(half + 4e-3, height + 0.2e-3);
          state.buttons = read >= pressed_at ? 1 : 0;
        }
        state.position = {0, 0, height};
      },
      2);
  self = &device;
  device.can().profile = &profile;
  device.can().encoder_step = 10e-6;
  device.can().buttons = 1;
  device.end_after(400, stop);
  LoopSettings settings;
  Loop loop(settings, {&device}, {&slot}, ring, stop);
  loop.run();
  std::vector<TickRecord> records;
  TickRecord record;
  while (ring.try_dequeue(record)) records.push_back(record);
  return records;
}

std::ptrdiff_t count(const std::vector<TickRecord>& records, ForceOff cause) {
  return std::count_if(records.begin(), records.end(),
                       [cause](const TickRecord& record) { return record.cause == cause; });
}

using Record = std::vector<TickRecord>::const_iterator;

/// A tick that a busy machine leaves out is a leap for this hand, which moves by ticks.
bool has_leap(Record from, Record to) {
  return std::adjacent_find(from, to, [](const TickRecord& before, const TickRecord& after) {
           return after.tick != before.tick + 1;
         }) != to;
}

Record find_runaway(const std::vector<TickRecord>& records) {
  return std::find_if(records.begin(), records.end(),
                      [](const TickRecord& record) { return record.cause == ForceOff::runaway; });
}

}  // namespace

TEST_CASE("A device that pushes the wrong way gets no force until somebody acknowledges that") {
  std::vector<TickRecord> records;
  REQUIRE(test::eventually([&] {
    records = records_of(-1);
    return !has_leap(records.begin(), find_runaway(records));
  }));
  REQUIRE(count(records, ForceOff::runaway) == 1);
  const Record fired = find_runaway(records);
  // It was drawn in by the force, and no farther than half of the cap takes it.
  CHECK((fired - 1)->sent.force.norm() >= 1);
  CHECK(half - fired->hand.position.z() < 2e-3);
  for (auto after = fired; after != records.end(); ++after) {
    const auto read = static_cast<std::size_t>(after - records.begin());
    CHECK(after->sent.force == Vector3::Zero());
    if (after != fired && read < pressed_at) CHECK(after->cause == ForceOff::unacknowledged);
    if (read > pressed_at && after + 1 != records.end()) CHECK(after->cause == ForceOff::none);
  }
}

TEST_CASE("A device that pushes the right way bounces off") {
  std::vector<TickRecord> records;
  REQUIRE(test::eventually([&] {
    records = records_of(1);
    return !has_leap(records.begin(), records.begin() + bounced_at);
  }));
  CHECK(count(records, ForceOff::runaway) == 0);
  CHECK(std::any_of(records.begin(), records.end(),
                    [](const TickRecord& record) { return record.sent.force.z() > 0.1; }));
}

}  // namespace loop_runaway_test
