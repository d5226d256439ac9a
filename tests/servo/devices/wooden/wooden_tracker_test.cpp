// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/wooden_tracker.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

namespace wooden_tracker_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr std::int64_t tick = 1'000'000;  // ns

WoodenOptions options_of(const std::string& text) {
  const auto options = parse_wooden_options(text);
  REQUIRE(options);
  return *options;
}

/// A tracker with the board that feeds it, a report a tick.
struct Board {
  explicit Board(const std::string& options, WoodenProtocol protocol = WoodenProtocol::v2)
      : tracker(options_of(options)) {
    report.protocol = protocol;
    report.connection = 1;
    report.signs_confirmed = true;
  }

  DeviceHealth next() {
    now += tick;
    tracker.take(report, now);
    return tracker.health(now);
  }

  /// The command that the board is sent for a force; nothing if none is sent.
  std::optional<WoodenCommand> sent(const Vector3& force) {
    WoodenCommand command;
    if (!tracker.command({force, Vector3::Zero()}, now, command)) return std::nullopt;
    return command;
  }

  WoodenTracker tracker;
  WoodenReport report;
  std::int64_t now = 1'000'000'000;
};

const Vector3 push(1, -1, 0.5);
constexpr std::array<std::int16_t, 3> no_current{};

}  // namespace

TEST_CASE("A WoodenHaptics whose home nobody confirms gives no force") {
  for (const WoodenProtocol protocol : {WoodenProtocol::v1, WoodenProtocol::v2}) {
    Board board("", protocol);
    for (int i = 0; i < 100; ++i) REQUIRE(board.next() == DeviceHealth::not_homed);
    const auto command = board.sent(push);
    REQUIRE(command);
    REQUIRE(command->request == WoodenRequest::currents);
    REQUIRE(command->currents == no_current);
  }
}

TEST_CASE("A WoodenHaptics whose signs nobody confirms is followed, and gives no force") {
  for (const WoodenProtocol protocol :
       {WoodenProtocol::v1, WoodenProtocol::v2, WoodenProtocol::v3}) {
    Board board("home_confirmed=always,gravity=on", protocol);
    board.report.signs_confirmed = false;
    for (int i = 0; i < 100; ++i) {
      REQUIRE(board.next() == DeviceHealth::unconfirmed);
      REQUIRE(board.sent(push)->currents == no_current);
    }
    const Vector3 before = board.tracker.state().position;
    board.report.counters[0] = 50;
    REQUIRE(board.next() == DeviceHealth::unconfirmed);
    CHECK((board.tracker.state().position - before).norm() > 1e-3);
    board.report.signs_confirmed = true;
    REQUIRE(board.next() == DeviceHealth::ok);
    CHECK(board.sent(push)->currents != no_current);
  }
}

TEST_CASE("Signs that the options name are confirmed by that, and those that a board brings hold") {
  Board named("home_confirmed=always,signs=+++");
  named.report.signs_confirmed = false;
  REQUIRE(named.next() == DeviceHealth::ok);
  CHECK(named.sent(push)->currents != no_current);

  Board plain("home_confirmed=always"), turned("home_confirmed=always");
  turned.report.signs = {{1, -1, 1, 1, 1, 1}, {1, -1, 1}};  // the opposite of plain's
  REQUIRE(plain.next() == DeviceHealth::ok);
  REQUIRE(turned.next() == DeviceHealth::ok);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(turned.sent(push)->currents[i] == -plain.sent(push)->currents[i]);
  }
}

TEST_CASE("A home confirmed once is lost by unplugging, one confirmed always is not") {
  Board once("home_confirmed=once");
  REQUIRE(once.next() == DeviceHealth::ok);
  REQUIRE(once.sent(push)->currents != no_current);
  once.report.connection = 2;
  REQUIRE(once.next() == DeviceHealth::not_homed);
  REQUIRE(once.sent(push)->currents == no_current);

  Board always("home_confirmed=always");
  REQUIRE(always.next() == DeviceHealth::ok);
  always.report.connection = 2;
  REQUIRE(always.next() == DeviceHealth::ok);
}

TEST_CASE("The calibration button makes the pose home, after the board took the new counters") {
  Board board("");
  board.report.counters = {500, -400, 300, 10, 20, 30};
  REQUIRE(board.next() == DeviceHealth::not_homed);
  board.report.calibration_pressed = true;
  REQUIRE(board.next() == DeviceHealth::not_homed);
  const auto command = board.sent(push);
  REQUIRE(command);
  REQUIRE(command->request == WoodenRequest::set_counters);
  REQUIRE(command->counters == std::array<std::int16_t, 6>{});
  // It is sent once, and again only when it seems lost.
  int again = 0;
  for (int i = 0; i < 25; ++i) {
    REQUIRE(board.next() == DeviceHealth::not_homed);
    if (board.sent(push)) ++again;
  }
  REQUIRE(again == 2);
  board.report.calibration_pressed = false;
  board.report.counters = {};
  REQUIRE(board.next() == DeviceHealth::ok);
  REQUIRE((board.tracker.state().position - Vector3(0, 0.205, 0.025)).norm() < 1e-12);
  REQUIRE(board.sent(push)->currents != no_current);
}

TEST_CASE("A press from before the start is taken back, keeps the counters and does not count") {
  Board board("");
  board.report.counters = {500, -400, 300, 10010, 20, 30};
  board.report.calibration_pressed = true;
  REQUIRE(board.next() == DeviceHealth::not_homed);
  const auto command = board.sent(push);
  REQUIRE(command);
  REQUIRE(command->request == WoodenRequest::set_counters);
  REQUIRE(command->counters == std::array<std::int16_t, 6>{500, -400, 300, 10, 20, 30});
  board.report.calibration_pressed = false;
  REQUIRE(board.next() == DeviceHealth::not_homed);
  REQUIRE(board.sent(push)->currents == no_current);
  board.report.calibration_pressed = true;
  REQUIRE(board.next() == DeviceHealth::not_homed);
  REQUIRE(board.sent(push)->counters == std::array<std::int16_t, 6>{});
  board.report.calibration_pressed = false;
  REQUIRE(board.next() == DeviceHealth::ok);
}

TEST_CASE("A board that is quiet for more than 10 ms is silent, and is sent no current") {
  Board board("home_confirmed=once");
  REQUIRE(board.tracker.health(board.now) == DeviceHealth::silent);
  REQUIRE(board.next() == DeviceHealth::ok);
  board.now += wooden_silent_ns;
  REQUIRE(board.tracker.health(board.now) == DeviceHealth::ok);
  board.now += 1;
  REQUIRE(board.tracker.health(board.now) == DeviceHealth::silent);
  REQUIRE(board.sent(push)->currents == no_current);
  REQUIRE(board.next() == DeviceHealth::ok);
}

TEST_CASE("A jump that no hand makes is a fault, a fast motion is none") {
  Board board("home_confirmed=once");
  REQUIRE(board.next() == DeviceHealth::ok);
  board.report.counters[0] = static_cast<std::int16_t>(board.report.counters[0] + 200);  // 9.6 mm
  REQUIRE(board.next() == DeviceHealth::fault);
  REQUIRE(board.sent(push)->currents == no_current);
  REQUIRE(board.next() == DeviceHealth::ok);
  // 1 m/s, seen once in 4 ms because the reports came together.
  board.report.counters[0] = static_cast<std::int16_t>(board.report.counters[0] + 83);
  REQUIRE(board.next() == DeviceHealth::ok);
}

TEST_CASE("An encoder that jumps by more than 20 mm is not homed any more") {
  Board board("home_confirmed=once,signs=+++");
  REQUIRE(board.next() == DeviceHealth::ok);
  board.report.counters[0] = static_cast<std::int16_t>(board.report.counters[0] + 600);  // 29 mm
  REQUIRE(board.next() == DeviceHealth::fault);
  for (int i = 0; i < 100; ++i) REQUIRE(board.next() == DeviceHealth::not_homed);
  REQUIRE(board.sent(push)->currents == no_current);
}

TEST_CASE("Counters that wrap move the tool on, not across the room") {
  Board board("home_confirmed=once,signs=+++,home=0:0:6000");
  board.report.counters[0] = 32760;
  REQUIRE(board.next() == DeviceHealth::ok);
  const Vector3 before = board.tracker.state().position;
  board.report.counters[0] = -32760;
  REQUIRE(board.next() == DeviceHealth::ok);
  REQUIRE((board.tracker.state().position - before).norm() < 16 * 60e-6);
}

TEST_CASE("The force sent is the wrench's, in the world's frame, and at most the cap") {
  Board board("home_confirmed=once,signs=+++,motor_signs=+++,current_limit=3A");
  REQUIRE(board.next() == DeviceHealth::ok);
  // At home: motor A sideways, B to and fro, C up and down.
  REQUIRE(board.sent(Vector3(1, 0, 0))->currents[0] > 500);
  REQUIRE(board.sent(Vector3(0, 0, 1))->currents[1] > 500);
  REQUIRE(board.sent(Vector3(0, 1, 0))->currents[2] > 500);
  const auto one = board.sent(Vector3(1, 0, 0))->currents;
  REQUIRE(one[1] == 0);
  REQUIRE(one[2] == 0);
  const auto most = board.sent(Vector3(5, 0, 0))->currents;
  REQUIRE(board.sent(Vector3(1e9, 0, 0))->currents == most);
  REQUIRE(most[0] == Approx(5 * one[0]).margin(5));
}

TEST_CASE("A force that is no number is none") {
  Board board("home_confirmed=once");
  REQUIRE(board.next() == DeviceHealth::ok);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    REQUIRE(board.sent(Vector3(0, bad, 0))->currents == no_current);
  }
}

TEST_CASE("Gravity is held when it is asked for, and only where force may be given") {
  Board off("home_confirmed=once");
  REQUIRE(off.next() == DeviceHealth::ok);
  REQUIRE(off.sent(Vector3::Zero())->currents == no_current);
  Board on("home_confirmed=once,gravity=on,motor_signs=+++");
  REQUIRE(on.next() == DeviceHealth::ok);
  REQUIRE(on.sent(Vector3::Zero())->currents[2] > 0);
  Board unconfirmed("gravity=on");
  REQUIRE(unconfirmed.next() == DeviceHealth::not_homed);
  REQUIRE(unconfirmed.sent(Vector3::Zero())->currents == no_current);
}

TEST_CASE("The handle's button is the first button, and turns nothing") {
  Board board("home_confirmed=once,model=vintage");
  REQUIRE(board.next() == DeviceHealth::ok);
  const auto before = board.tracker.state();
  REQUIRE(before.buttons == 0);
  board.report.counters[3] = 10000;
  REQUIRE(board.next() == DeviceHealth::ok);
  REQUIRE(board.tracker.state().buttons == 1);
  REQUIRE(board.tracker.state().orientation.isApprox(before.orientation));
}

}  // namespace wooden_tracker_test
