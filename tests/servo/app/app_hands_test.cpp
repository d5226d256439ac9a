// SPDX-License-Identifier: Apache-2.0
#include "servo/app/app_hands.hpp"

#include <catch2/catch.hpp>

namespace app_hands_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr std::int64_t second = 1'000'000'000;

AppCommand lead(std::uint32_t connection, double x, bool on = true) {
  AppCommand command;
  command.action = AppAction::lead;
  command.connection = connection;
  command.on = on;
  command.hold = 0.4;
  command.pose.position = {x, 0, 0};
  return command;
}

struct Led {
  Led() { hands.know_device(0, true); }
  AppHands hands;
};

}  // namespace

TEST_CASE_METHOD(Led, "A hand that is led is where it is led to, for as long as it holds") {
  REQUIRE(hands.of(0, second) == nullptr);
  REQUIRE(hands.lead(lead(1, 0.1), second) == Refusal::none);
  REQUIRE(hands.of(0, second + second / 4) != nullptr);
  CHECK(hands.of(0, second)->position.x() == 0.1);
  CHECK(hands.of(0, second + second / 2) == nullptr);
}

TEST_CASE_METHOD(
    Led, "A second application is refused a hand until the first is silent, lets go or leaves") {
  REQUIRE(hands.lead(lead(1, 0.1), second) == Refusal::none);
  AppCommand other = lead(2, 0.2);
  other.supervisor = GENERATE(false, true);
  CHECK(hands.lead(other, second + 1) == Refusal::hand_held);
  CHECK(hands.lead(lead(2, 0, false), second + 1) == Refusal::hand_held);
  CHECK(hands.of(0, second + 1)->position.x() == 0.1);
  SECTION("silent") { CHECK(hands.lead(other, second + second / 2) == Refusal::none); }
  SECTION("lets go") {
    CHECK(hands.lead(lead(1, 0, false), second + 2) == Refusal::none);
    CHECK(hands.of(0, second + 3) == nullptr);
    CHECK(hands.lead(other, second + 3) == Refusal::none);
  }
  SECTION("leaves") {
    hands.leave(1);
    CHECK(hands.of(0, second + 2) == nullptr);
    CHECK(hands.lead(other, second + 3) == Refusal::none);
  }
}

TEST_CASE_METHOD(Led, "The hand of a device that goes its own way is not led") {
  AppCommand command = lead(1, 0.1);
  command.index = 1;
  CHECK(hands.lead(command, second) == Refusal::not_led);
  CHECK(hands.of(1, second) == nullptr);
}

}  // namespace app_hands_test
