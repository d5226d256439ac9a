// SPDX-License-Identifier: Apache-2.0
// An application whose daemon goes, and comes back; and what its errors say.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <utility>

#include "tests/servo/support/connected_client.hpp"
#include "tests/servo/support/loop_beside.hpp"

namespace client_reconnect_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

spm_client* connected(const std::string& path, bool reconnects) {
  auto options = sized<spm_client_options>();
  options.path = path.c_str();
  options.timeout_ms = 20000;
  options.reconnect = reconnects ? 1 : 0;
  spm_client* client = nullptr;
  REQUIRE(spm_client_connect(&options, &client, nullptr, 0) == SPM_CLIENT_OK);
  return client;
}

int read_of(const spm_client* client) {
  auto device = sized<spm_client_device>();
  return spm_client_read_device(client, 0, &device);
}

}  // namespace

TEST_CASE("Reads and commands say at once that the daemon ended") {
  Daemon daemon;
  const LoopStandIn loop(*daemon.state);
  const Connected here(daemon.folder.path("a.sock"));
  REQUIRE(here.client != nullptr);
  REQUIRE(eventually([&] { return read_of(here.client) == SPM_CLIENT_OK; }));
  daemon.state->end();
  CHECK(read_of(here.client) == SPM_CLIENT_NO_DAEMON);
  auto loop_counts = sized<spm_client_loop>();
  CHECK(spm_client_read_loop(here.client, &loop_counts) == SPM_CLIENT_NO_DAEMON);
  const spm_client_pose pose = pose_at(0);
  CHECK(spm_client_move_object(here.client, 0, &pose) == SPM_CLIENT_NO_DAEMON);
  CHECK(contains(spm_client_text(SPM_CLIENT_NO_DAEMON), "spm-servo run"));
  auto event = sized<spm_client_event>();
  REQUIRE(spm_client_next_event(here.client, &event) == SPM_CLIENT_OK);
  CHECK(event.kind == SPM_CLIENT_DAEMON_LOST);
  CHECK(spm_client_next_event(here.client, &event) == SPM_CLIENT_NO_DAEMON);
}

TEST_CASE("A daemon that was killed is told from one whose loop stands still") {
  SocketFolder folder;
  auto state = small_state();
  auto server = started(*state, folder.path("a.sock"));
  const Connected here(server->path());
  {
    const LoopStandIn loop(*state);
    REQUIRE(eventually([&] { return read_of(here.client) == SPM_CLIENT_OK; }));
  }
  // No tick any more, but the socket is held open.
  CHECK(read_of(here.client) == SPM_CLIENT_OK);
  server.reset();
  CHECK(read_of(here.client) == SPM_CLIENT_NO_DAEMON);
}

TEST_CASE("A client that reconnects finds a restarted daemon by its next calls, and tells it") {
  SocketFolder folder;
  const std::string path = folder.path("a.sock");
  auto state = small_state();
  auto server = started(*state, path);
  spm_client* const client = connected(path, true);
  {
    const LoopStandIn loop(*state);
    REQUIRE(eventually([&] { return read_of(client) == SPM_CLIENT_OK; }));
  }
  server.reset();
  state.reset();
  auto event = sized<spm_client_event>();
  CHECK(read_of(client) == SPM_CLIENT_NO_DAEMON);
  REQUIRE(spm_client_next_event(client, &event) == SPM_CLIENT_OK);
  CHECK(event.kind == SPM_CLIENT_DAEMON_LOST);

  state = small_state();
  server = started(*state, path);
  const LoopStandIn loop(*state);
  REQUIRE(eventually([&] { return read_of(client) == SPM_CLIENT_OK; }));
  REQUIRE(spm_client_next_event(client, &event) == SPM_CLIENT_OK);
  CHECK(event.kind == SPM_CLIENT_DAEMON_FOUND);
  const spm_client_pose pose = pose_at(0.01);
  CHECK(spm_client_move_object(client, 0, &pose) == SPM_CLIENT_OK);
  auto object = sized<spm_client_object>();
  CHECK(eventually([&] {
    return spm_client_read_object(client, 0, &object) == SPM_CLIENT_OK && object.position[0] > 0;
  }));
  spm_client_disconnect(client);
}

TEST_CASE("A client that does not reconnect by itself does so when it is asked") {
  SocketFolder folder;
  const std::string path = folder.path("a.sock");
  auto state = small_state();
  auto server = started(*state, path);
  spm_client* const client = connected(path, false);
  CHECK(spm_client_reconnect(client) == SPM_CLIENT_OK);
  server.reset();
  state.reset();
  CHECK(spm_client_reconnect(client) == SPM_CLIENT_NO_DAEMON);
  CHECK(contains(spm_client_text(SPM_CLIENT_NO_DAEMON), path));
  state = small_state();
  server = started(*state, path);
  CHECK(read_of(client) == SPM_CLIENT_NO_DAEMON);
  CHECK(spm_client_reconnect(client) == SPM_CLIENT_OK);
  CHECK(spm_client_reconnect(nullptr) == SPM_CLIENT_BAD_ARGUMENT);
  spm_client_disconnect(client);
}

TEST_CASE("An error names the argument and its limits, where the call is made") {
  const LoopBeside beside;
  REQUIRE(eventually([&] { return beside.device().tick > 0; }));
  spm_client* const client = beside.here->client;
  auto material = sized<spm_client_material>();
  CHECK(spm_client_set_material(client, 0, &material) == SPM_CLIENT_BAD_ARGUMENT);
  CHECK(contains(spm_client_text(SPM_CLIENT_BAD_ARGUMENT), "gives nothing"));
  material.fields = SPM_CLIENT_STIFFNESS;
  material.stiffness = 2e5;
  CHECK(spm_client_set_material(client, 0, &material) == SPM_CLIENT_BAD_ARGUMENT);
  CHECK(std::string(spm_client_text(SPM_CLIENT_BAD_ARGUMENT)) ==
        "stiffness is 200000: it has to be from 0 to 100000");
  const spm_client_pose pose = pose_at(0);
  CHECK(spm_client_move_object(client, 77, &pose) == SPM_CLIENT_NOT_THERE);
  CHECK(contains(spm_client_text(SPM_CLIENT_NOT_THERE), "no such object"));
  CHECK(spm_client_move_object(nullptr, 0, &pose) == SPM_CLIENT_BAD_ARGUMENT);
  CHECK(contains(spm_client_text(SPM_CLIENT_BAD_ARGUMENT), "NULL"));
  CHECK_FALSE(std::string(spm_client_text(1234)).empty());

  const LoopBeside still(false);
  REQUIRE(eventually([&] { return still.device().tick > 0; }));
  CHECK(spm_client_move_object(still.here->client, 0, &pose) == SPM_CLIENT_NOT_MOVABLE);
  CHECK(contains(spm_client_text(SPM_CLIENT_NOT_MOVABLE), "movable = true"));
}

TEST_CASE("An object is placed into the hand at once, and its force comes without a step") {
  LoopBeside beside;
  REQUIRE(eventually([&] { return beside.device().tick > 200; }));
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_place_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  CHECK(beside.object(0).position[2] == 2 * above);
  double largest = 0, last = 0;
  std::uint64_t last_tick = 0;
  for (const TickRecord& record : beside.records()) {
    const double ticks = static_cast<double>(record.tick - std::exchange(last_tick, record.tick));
    const double now = record.sent.force.z();
    if (ticks > 0) largest = std::max(largest, std::abs(now - last) / ticks);
    last = now;
  }
  CHECK(largest > 0);
  CHECK(largest <= 0.06 + 1e-9);
}

TEST_CASE("Where a point touches is told as where a tool does") {
  const LoopBeside beside;
  const spm_client_pose up = raised(2 * above);
  REQUIRE(eventually([&] { return beside.device().tick > 0; }));
  REQUIRE(spm_client_place_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  std::array<spm_client_contact, 4> contacts{};
  contacts[0].size = sizeof contacts[0];
  std::size_t count = 0;
  REQUIRE(spm_client_read_contacts(beside.here->client, 0, nullptr, contacts.data(),
                                   contacts.size(), &count) == SPM_CLIENT_OK);
  REQUIRE(count == 1);
  CHECK(contacts[0].object == 0);
  CHECK(contacts[0].force[2] == Approx(1).epsilon(0.05));
  CHECK(contacts[0].normal[2] == Approx(1));
  CHECK(contacts[0].depth == Approx(above).epsilon(0.05));
  CHECK(contacts[0].place[2] == Approx(box_half + 2 * above).epsilon(1e-3));
}

}  // namespace client_reconnect_test
