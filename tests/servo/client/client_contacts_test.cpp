// SPDX-License-Identifier: Apache-2.0
// Where a device's tool touches, as applications read it.
#include <array>
#include <catch2/catch.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "servo/app/app_server.hpp"
#include "servo/client/spm_client.h"
#include "tests/servo/support/connected_client.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace client_contacts_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

TEST_CASE("Where a tool touches is read of one tick, with the ids of the objects") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  std::vector<AppDevice> devices{device_of(4), device_of(4)};
  std::array<ContactPatch, SPM_MAX_CONTACTS + 3> patches{};
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const auto number = static_cast<double>(i);
    patches[i] = {{number, 1, 2},
                  {0, 0, 1},
                  {0, 0, -number},
                  1e-3 * number,
                  static_cast<std::uint32_t>(i % 2)};
  }
  devices[1].patches = patches;
  const std::vector<std::uint64_t> ids{5, (std::uint64_t{3} << 32U) | 1U};
  daemon.state->publish({4, 99, devices, {}, ids});

  auto tick = sized<spm_client_tick>();
  std::array<spm_client_contact, SPM_CLIENT_MAX_CONTACTS> contacts{};
  contacts[0].size = sizeof contacts[0];
  std::size_t count = 77;
  const auto read = [&](std::uint32_t device, std::size_t most) {
    return spm_client_read_contacts(here.client, device, &tick, contacts.data(), most, &count);
  };
  REQUIRE(read(1, contacts.size()) == SPM_CLIENT_OK);
  CHECK(tick.tick == 4);
  REQUIRE(count == SPM_CLIENT_MAX_CONTACTS);
  for (std::size_t i = 0; i < count; ++i) {
    CHECK(contacts[i].size == sizeof contacts[i]);
    CHECK(contacts[i].device == 1);
    CHECK(contacts[i].object == ids[i % 2]);
    CHECK(contacts[i].place[0] == static_cast<double>(i));
    CHECK(contacts[i].normal[2] == 1);
    CHECK(contacts[i].force[2] == -static_cast<double>(i));
    CHECK(contacts[i].depth == 1e-3 * static_cast<double>(i));
  }
  REQUIRE(read(1, 3) == SPM_CLIENT_OK);
  CHECK(count == 3);
  REQUIRE(read(0, contacts.size()) == SPM_CLIENT_OK);
  CHECK(count == 0);
  CHECK(read(2, 3) == SPM_CLIENT_NOT_THERE);
  contacts[0].size = 8;
  CHECK(read(1, 3) == SPM_CLIENT_BAD_ARGUMENT);
  CHECK(spm_client_read_contacts(here.client, 1, nullptr, nullptr, 0, &count) == SPM_CLIENT_OK);
  CHECK(spm_client_read_contacts(here.client, 1, nullptr, nullptr, 0, nullptr) ==
        SPM_CLIENT_BAD_ARGUMENT);
  auto device = sized<spm_client_device>();
  REQUIRE(spm_client_read_device(here.client, 1, &device) == SPM_CLIENT_OK);
  CHECK(device.contact_count == SPM_CLIENT_MAX_CONTACTS);
  CHECK(device.has_tool == 1);
  CHECK(device.limits == SPM_CLIENT_TORQUE_CAP_MET);
  CHECK(device.tool_position[1] == devices[1].tool.position.y());
  CHECK(device.tool_orientation[0] == devices[1].tool.orientation.w());
  CHECK(device.proxy_orientation[0] == devices[1].proxy.orientation.w());
  CHECK(device.angular_velocity[2] == devices[1].angular_velocity.z());
  CHECK(device.torque_cap == devices[1].torque_cap);
}

TEST_CASE("A caller of the first version of the counts gets what it knows") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  std::vector<DeviceCounters> counted(1);
  counted[0].cap_hits = 5;
  counted[0].torque_cap_hits = 6;
  counted[0].tool_cap_hits = 7;
  counted[0].torque_max = 0.25;
  counted[0].coarse = 8;
  daemon.state->count({1, 1, 1, 1, 0, 0, counted});
  auto counts = sized<spm_client_device_counts>();
  REQUIRE(spm_client_read_device_counts(here.client, 0, &counts) == SPM_CLIENT_OK);
  CHECK(counts.torque_cap_hits == 6);
  CHECK(counts.tool_cap_hits == 7);
  CHECK(counts.torque_max == 0.25);
  counts.size = offsetof(spm_client_device_counts, torque_cap_hits);
  counts.cap_hits = 0;
  counts.torque_max = 42;
  REQUIRE(spm_client_read_device_counts(here.client, 0, &counts) == SPM_CLIENT_OK);
  CHECK(counts.cap_hits == 5);
  CHECK(counts.torque_max == 42);
  auto loop = sized<spm_client_loop>();
  REQUIRE(spm_client_read_loop(here.client, &loop) == SPM_CLIENT_OK);
  CHECK(loop.coarse == 8);
  loop.size = offsetof(spm_client_loop, degraded);
  CHECK(spm_client_read_loop(here.client, &loop) == SPM_CLIENT_OK);
}

}  // namespace client_contacts_test
