// SPDX-License-Identifier: Apache-2.0
// Faults that applications acknowledge: the loop beside an application.
#include <catch2/catch.hpp>

#include "servo/app/app_clutches.hpp"
#include "tests/servo/support/loop_beside.hpp"

namespace app_acknowledge_test {

using namespace spm;
using namespace spm::test;

namespace {

/// Farther than any hand moves in ten seconds: the loop does not believe it for a tick, though it
/// may have skipped many.
void jump(LoopBeside& loop) { loop.hand_x.store(loop.hand_x.load() + 100); }

bool comes_to_cause(const LoopBeside& loop, std::uint32_t cause) {
  // Before the first tick there is no device, and no cause.
  return eventually([&] {
    const spm_client_device device = loop.device();
    return device.connected != 0 && device.cause == cause;
  });
}

}  // namespace

TEST_CASE("A fault waits for an application to acknowledge it") {
  LoopBeside loop(true, true);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_FORCE_ON));
  jump(loop);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_OFF_UNACKNOWLEDGED));
  REQUIRE(spm_client_acknowledge(loop.here->client, 0) == SPM_CLIENT_OK);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_FORCE_ON));
  jump(loop);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_OFF_UNACKNOWLEDGED));
}

TEST_CASE("While something else is wrong an acknowledgement does not count") {
  LoopBeside loop(true, true);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_FORCE_ON));
  jump(loop);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_OFF_UNACKNOWLEDGED));
  // Such as another board in the place of the first. By itself that is no fault that waits.
  loop.health.store(servo::DeviceHealth::unconfirmed);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_OFF_UNCONFIRMED));
  REQUIRE(spm_client_acknowledge(loop.here->client, 0) == SPM_CLIENT_OK);
  REQUIRE(loop.takes(1));
  loop.health.store(servo::DeviceHealth::ok);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_OFF_UNACKNOWLEDGED));
}

TEST_CASE("Who does not hold the clutch may not acknowledge, but a supervisor may") {
  LoopBeside loop(true, true);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_FORCE_ON));  // before that nothing waits
  const Connected holder(loop.path());
  REQUIRE(spm_client_set_clutch(holder.client, 0, 1) == SPM_CLIENT_OK);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_OFF_CLUTCHED));
  jump(loop);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_OFF_UNACKNOWLEDGED));
  REQUIRE(spm_client_acknowledge(loop.here->client, 0) == SPM_CLIENT_OK);
  REQUIRE(loop.refusal().find("another application holds the clutch") == 0);
  REQUIRE(loop.device().cause == SPM_CLIENT_OFF_UNACKNOWLEDGED);
  const Connected supervisor(loop.path(), 20000, SPM_CLIENT_SUPERVISOR);
  REQUIRE(spm_client_acknowledge(supervisor.client, 0) == SPM_CLIENT_OK);
  REQUIRE(comes_to_cause(loop, SPM_CLIENT_OFF_CLUTCHED));
}

TEST_CASE("A device that is not there cannot be acknowledged, nor without a client") {
  const LoopBeside loop(true, true);
  REQUIRE(spm_client_acknowledge(loop.here->client, 7) == SPM_CLIENT_NOT_THERE);
  REQUIRE(spm_client_acknowledge(nullptr, 0) == SPM_CLIENT_BAD_ARGUMENT);
}

}  // namespace app_acknowledge_test
