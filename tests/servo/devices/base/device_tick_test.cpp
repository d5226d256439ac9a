// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "servo/base/clock.hpp"
#include "servo/devices/base/device_placed.hpp"
#include "servo/devices/falcon/device_falcon.hpp"
#include "servo/devices/falcon/falcon_kinematics.hpp"
#include "servo/devices/wooden/device_wooden.hpp"
#include "tests/servo/devices/falcon/falcon_counts.hpp"
#include "tests/servo/support/intercepted_calls.hpp"

namespace device_tick_test {

using namespace spm;
using namespace spm::servo;
using spm::test::falcon_counts;

namespace {

/// What the connection of a device under test carried.
template <class Command>
struct Carried {
  std::atomic<std::uint64_t> sent{0}, pushing{0};
};

bool pushes(const FalconCommand& command) { return command.motors != FalconCommand{}.motors; }
bool pushes(const WoodenCommand& command) { return command.currents != WoodenCommand{}.currents; }

/// A connection that brings one report a millisecond.
template <class Report, class Command>
class StreamingPort final : public Port<Report, Command> {
 public:
  StreamingPort(const Report& report, Carried<Command>& carried)
      : report_(report), carried_(carried) {}

  [[nodiscard]] Received receive(Report& report) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    report = report_;
    return Received::report;
  }
  [[nodiscard]] bool send(const Command& command) override {
    carried_.sent.fetch_add(1);
    carried_.pushing.fetch_add(pushes(command) ? 1 : 0);
    return true;
  }

 private:
  Report report_;
  Carried<Command>& carried_;
};

template <class Driver, class Report, class Command>
void start(Driver& device, const Report& report, Carried<Command>& carried) {
  REQUIRE(device.start(
      [&carried, report](const std::atomic<bool>&)
          -> Result<std::unique_ptr<typename Driver::Threads::DevicePort>> {
        return std::make_unique<StreamingPort<Report, Command>>(report, carried);
      },
      RealtimeMode::off));
}

/// Ticks that follow the device's reports until so many were good, and so many commands were sent
/// that push; the time only ends a test that has failed.
template <class Command>
test::InterceptedCalls calls_of_ticks(Device& device, std::uint64_t good_ticks,
                                      const Carried<Command>& carried) {
  test::InterceptedCalls calls;
  std::thread loop([&] {
    const std::int64_t end = now_ns() + 20'000'000'000;
    const auto before = test::intercepted_calls();
    test::watch(true);
    const auto sent = [&carried] { return std::min(carried.sent.load(), carried.pushing.load()); };
    for (std::uint64_t good = 0; (good < good_ticks || sent() <= 100) && now_ns() < end;) {
      static_cast<void>(device.wait_for_report(now_ns() + 5'000'000));
      DeviceState state;
      const DeviceHealth health = device.read(state);
      const bool is_good = health == DeviceHealth::ok && state.position.allFinite();
      good += device.write({Vector3(1, 0.5, 0.2), Vector3::Zero()}) == health && is_good ? 1 : 0;
    }
    test::watch(false);
    calls = test::intercepted_calls() - before;
  });
  loop.join();
  return calls;
}

template <class Command>
void check(Device& device, Carried<Command>& carried) {
  const test::InterceptedCalls calls = calls_of_ticks(device, 300, carried);
  CHECK(calls.allocations == 0);
  CHECK(calls.locks == 0);
  CHECK(calls.writes == 0);
  CHECK(carried.sent.load() > 100);
  CHECK(carried.pushing.load() > 100);
  const auto latency = device.describe().at("latency_us");
  for (const char* what : {"report_age", "command_sent", "report_to_command"}) {
    CAPTURE(what, latency.dump());
    const auto& counted = latency.at(what);
    CHECK(counted.at("p50").get<double>() > 0);
    CHECK(counted.at("p50").get<double>() <= counted.at("p99").get<double>());
    CHECK(counted.at("p99").get<double>() <= counted.at("max").get<double>());
  }
}

FalconReport falcon_at_centre() {
  const auto angles = falcon_inverse(Vector3::Zero());
  REQUIRE(angles);
  const Vector3 counts = falcon_counts(*angles);
  FalconReport report;
  for (std::size_t i = 0; i < report.encoders.size(); ++i) {
    report.encoders[i] =
        static_cast<std::int16_t>(std::lround(counts[static_cast<Eigen::Index>(i)]));
  }
  report.homed = falcon_all_homed;
  return report;
}

}  // namespace

TEST_CASE("A Falcon's tick neither allocates, locks nor writes, and its delays are told") {
  const auto options = parse_falcon_options("");
  REQUIRE(options);
  Carried<FalconCommand> carried;
  DeviceFalcon device(*options);
  start(device, falcon_at_centre(), carried);
  check(device, carried);
}

TEST_CASE("A WoodenHaptics' tick neither allocates, locks nor writes, and its delays are told") {
  const auto options = parse_wooden_options("home_confirmed=once,gravity=on,signs=+++");
  REQUIRE(options);
  WoodenReport report;
  report.protocol = WoodenProtocol::v2;
  report.connection = 1;
  Carried<WoodenCommand> carried;
  DeviceWooden device(*options);
  start(device, report, carried);
  check(device, carried);
}

TEST_CASE("A placed device's tick neither allocates, locks nor writes") {
  const auto options = parse_falcon_options("");
  REQUIRE(options);
  Carried<FalconCommand> carried;
  auto falcon = std::make_unique<DeviceFalcon>(*options);
  start(*falcon, falcon_at_centre(), carried);
  DevicePlacement placement;
  placement.axes = *DeviceAxes::parse("-z+x+y");
  PlacedDevice device(std::move(falcon), placement);
  check(device, carried);
}

}  // namespace device_tick_test
