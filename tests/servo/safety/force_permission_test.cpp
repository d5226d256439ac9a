// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/force_permission.hpp"

#include <catch2/catch.hpp>

namespace force_permission_test {

using namespace spm::servo;

namespace {

/// A tick in which nothing is wrong, with these buttons.
ForceOff tick(ForcePermission& permission, std::uint32_t buttons = 0, bool acknowledged = false) {
  const ForceOff cause = permission.next({true, buttons, acknowledged, false});
  permission.sent(cause);
  return cause;
}

/// A tick of a fault of the device.
void fault(ForcePermission& permission, ForceOff cause = ForceOff::device_silent,
           bool acknowledged = false) {
  static_cast<void>(permission.next({false, 0, acknowledged, true}));
  permission.sent(cause);
}

}  // namespace

TEST_CASE("Without options every tick may have force, after a fault too") {
  ForcePermission permission({});
  REQUIRE(tick(permission) == ForceOff::none);
  fault(permission);
  REQUIRE(tick(permission) == ForceOff::none);
}

TEST_CASE("After a fault there is no force until an application acknowledges it") {
  for (std::size_t i = 0; i < force_off_count; ++i) {
    const auto cause = static_cast<ForceOff>(i);
    CAPTURE(to_string(cause));
    ForcePermission permission({true, 0, 0});
    REQUIRE(tick(permission) == ForceOff::none);
    fault(permission, cause);
    const bool waits = needs_acknowledgement(cause);
    REQUIRE(tick(permission) == (waits ? ForceOff::unacknowledged : ForceOff::none));
    REQUIRE(tick(permission) == (waits ? ForceOff::unacknowledged : ForceOff::none));
    REQUIRE(tick(permission, 0, true) == ForceOff::none);
    REQUIRE(tick(permission) == ForceOff::none);
  }
}

TEST_CASE("An acknowledgement while the fault lasts, or before there was one, counts for nothing") {
  ForcePermission permission({true, 0, 0});
  REQUIRE(tick(permission, 0, true) == ForceOff::none);
  fault(permission);
  fault(permission, ForceOff::device_silent, true);
  REQUIRE(tick(permission) == ForceOff::unacknowledged);
}

TEST_CASE("An acknowledgement counts for nothing while a fault lasts that another cause hides") {
  ForcePermission permission({true, 0, 0});
  REQUIRE(tick(permission) == ForceOff::none);
  fault(permission);
  // Clutched, or told to end, the device is still at fault.
  for (const ForceOff hides : {ForceOff::clutched, ForceOff::stopping}) {
    CHECK(permission.next({false, 0, true, true}) == ForceOff::unacknowledged);
    permission.sent(hides);
  }
  CHECK(tick(permission) == ForceOff::unacknowledged);
  CHECK(tick(permission, 0, true) == ForceOff::none);
}

TEST_CASE("A fault before the first force needs no acknowledgement") {
  ForcePermission permission({true, 0, 0});
  fault(permission, ForceOff::not_homed);
  REQUIRE(tick(permission) == ForceOff::none);
}

TEST_CASE("A press of a button acknowledges, one that is held through the fault does not") {
  ForcePermission permission({true, 0, 2});
  REQUIRE(tick(permission, 1) == ForceOff::none);
  fault(permission);
  REQUIRE(tick(permission, 1) == ForceOff::unacknowledged);
  REQUIRE(tick(permission, 0) == ForceOff::unacknowledged);
  REQUIRE(tick(permission, 2) == ForceOff::unacknowledged);  // the clutch's
  REQUIRE(tick(permission, 3) == ForceOff::none);
}

TEST_CASE("Without the enable switch held there is no force") {
  ForcePermission permission({false, 3, 0});
  REQUIRE(tick(permission) == ForceOff::not_enabled);
  REQUIRE(tick(permission, 0b011) == ForceOff::not_enabled);
  REQUIRE(tick(permission, 0b100) == ForceOff::none);
  REQUIRE(tick(permission, 0) == ForceOff::not_enabled);
  // A device that tells nothing holds no switch.
  REQUIRE(permission.next({false, 0b100, false, true}) == ForceOff::not_enabled);
}

TEST_CASE("With an enable switch a fault is acknowledged by letting go and pressing again") {
  ForcePermission permission({true, 1, 0});
  REQUIRE(tick(permission, 1) == ForceOff::none);
  fault(permission);
  REQUIRE(tick(permission, 1) == ForceOff::unacknowledged);
  REQUIRE(tick(permission, 0) == ForceOff::unacknowledged);
  REQUIRE(tick(permission, 1) == ForceOff::none);
}

}  // namespace force_permission_test
