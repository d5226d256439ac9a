// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "servo/app/app_server.hpp"
#include "servo/client/spm_client.h"
#include "tests/servo/support/connected_client.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace client_library_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

std::vector<std::uint32_t> event_kinds(spm_client* client) {
  std::vector<std::uint32_t> kinds;
  auto event = sized<spm_client_event>();
  while (spm_client_next_event(client, &event) == SPM_CLIENT_OK) kinds.push_back(event.kind);
  return kinds;
}

}  // namespace

TEST_CASE("An application sees names, rate and versions") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  REQUIRE(here.message.empty());
  auto info = sized<spm_client_info>();
  REQUIRE(spm_client_read_info(here.client, &info) == SPM_CLIENT_OK);
  REQUIRE(info.rate_hz == 1000);
  REQUIRE(info.process == static_cast<std::uint32_t>(getpid()));
  REQUIRE(info.device_count == 1);
  REQUIRE(std::string(info.daemon_version) == SPM_VERSION);
  std::array<char, SPM_CLIENT_NAME_BYTES> name{};
  REQUIRE(spm_client_device_name(here.client, 0, name.data(), name.size()) == SPM_CLIENT_OK);
  REQUIRE(std::string(name.data()) == "hand");
  REQUIRE(spm_client_asset_name(here.client, 0, name.data(), name.size()) == SPM_CLIENT_OK);
  REQUIRE(std::string(name.data()) == "bunny");
  REQUIRE(spm_client_object_name(here.client, 0, name.data(), 4) == SPM_CLIENT_OK);
  REQUIRE(std::string(name.data()) == "fir");
  REQUIRE(spm_client_device_name(here.client, 1, name.data(), name.size()) == SPM_CLIENT_NOT_THERE);
  REQUIRE(std::string(name.data()).empty());
}

TEST_CASE("A heartbeat that no clock gives is that of a stalled daemon, and its age a number") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  const std::vector<AppDevice> devices{device_of(7)};
  constexpr std::int64_t first = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t last = std::numeric_limits<std::int64_t>::max();
  std::uint64_t tick = 0;
  for (const std::int64_t beat : {first, first + 1, std::int64_t{-1}, std::int64_t{0}, last}) {
    CAPTURE(beat);
    daemon.state->publish({++tick, beat, devices, {}});
    double age = -2;
    CHECK(spm_client_daemon_state(here.client, &age) == SPM_CLIENT_STALLED);
    CHECK(age >= 0);
    CHECK(age < 1e11);
  }
}

TEST_CASE("Every cause of zero force has its name and cure from the daemon") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  const char *name = nullptr, *cure = nullptr;
  for (std::uint32_t cause = 0; cause < force_off_count; ++cause) {
    REQUIRE(spm_client_cause(here.client, cause, &name, &cure) == SPM_CLIENT_OK);
    REQUIRE(std::string(name) == to_string(static_cast<ForceOff>(cause)));
    REQUIRE(std::string(cure) == cure_of(static_cast<ForceOff>(cause)));
  }
  REQUIRE(spm_client_cause(here.client, 1000, &name, &cure) == SPM_CLIENT_NOT_THERE);
  REQUIRE(std::string(name).empty());
}

TEST_CASE("What the loop publishes is what the application reads") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  auto device = sized<spm_client_device>();
  REQUIRE(spm_client_read_device(here.client, 0, &device) == SPM_CLIENT_NOT_THERE);
  const std::vector<AppDevice> devices{device_of(7), device_of(7)};
  const std::vector<AppObject> objects{object_of(3, 7)};
  daemon.state->publish({7, 99, devices, objects});

  REQUIRE(spm_client_read_device(here.client, 1, &device) == SPM_CLIENT_OK);
  REQUIRE(device.tick == 7);
  REQUIRE(device.position[0] == devices[1].state.position.x());
  REQUIRE(device.orientation[0] == devices[1].state.orientation.w());
  REQUIRE(device.orientation[3] == devices[1].state.orientation.z());
  REQUIRE(device.velocity[2] == devices[1].velocity.z());
  REQUIRE(device.force[1] == devices[1].wrench.force.y());
  REQUIRE(device.torque[1] == devices[1].wrench.torque.y());
  REQUIRE(device.depth == devices[1].depth);
  REQUIRE(device.contact == 1);
  REQUIRE(device.connected == 1);
  REQUIRE(device.buttons == 7);
  REQUIRE(device.cause == SPM_CLIENT_FORCE_ON);
  REQUIRE(spm_client_read_device(here.client, 2, &device) == SPM_CLIENT_NOT_THERE);

  auto object = sized<spm_client_object>();
  REQUIRE(spm_client_read_object(here.client, 3, &object) == SPM_CLIENT_OK);
  REQUIRE(object.id == 3);
  REQUIRE(object.position[1] == objects[0].pose.position.y());
  REQUIRE(object.scale == objects[0].pose.scale);
  REQUIRE(object.force[0] == objects[0].reaction.force.x());
  REQUIRE(object.torque[2] == objects[0].reaction.torque.z());
  REQUIRE(object.silent == objects[0].silent);
  REQUIRE(object.movable == 1);
  REQUIRE(spm_client_read_object(here.client, 4, &object) == SPM_CLIENT_NOT_THERE);

  auto tick = sized<spm_client_tick>();
  std::array<spm_client_device, 5> all_devices{};
  std::array<spm_client_object, 5> all_objects{};
  all_devices[0].size = sizeof all_devices[0];
  all_objects[0].size = sizeof all_objects[0];
  REQUIRE(spm_client_read_all(here.client, &tick, all_devices.data(), 5, all_objects.data(), 5) ==
          SPM_CLIENT_OK);
  REQUIRE(tick.tick == 7);
  REQUIRE(tick.time_ns == 99);
  REQUIRE(tick.device_count == 2);
  REQUIRE(tick.object_count == 1);
  REQUIRE(all_devices[1].position[0] == device.position[0]);
  REQUIRE(all_devices[1].size == sizeof all_devices[1]);
  REQUIRE(all_objects[0].id == 3);
  REQUIRE(spm_client_read_all(here.client, &tick, nullptr, 0, nullptr, 0) == SPM_CLIENT_OK);
}

TEST_CASE("Objects are added, moved and removed, and what cannot be is told with its reason") {
  const Daemon daemon;
  const LoopStandIn loop(*daemon.state);
  const Connected here(daemon.server->path());
  auto object = sized<spm_client_object>();
  std::uint64_t id = 0;
  auto pose = pose_at(0.1);
  auto material = sized<spm_client_material>();
  material.fields = SPM_CLIENT_STIFFNESS;
  material.stiffness = 500;
  REQUIRE(spm_client_add_object(here.client, 0, &pose, 1, &material, &id) == SPM_CLIENT_OK);
  REQUIRE(id >> 32U == 1);
  REQUIRE(eventually(
      [&] { return spm_client_read_object(here.client, id, &object) == SPM_CLIENT_OK; }));
  REQUIRE(object.position[0] == 0.1);
  pose = pose_at(0.2);
  pose.period = 0.011;
  pose.deadline = 100;
  REQUIRE(spm_client_move_object(here.client, id, &pose) == SPM_CLIENT_OK);
  REQUIRE(eventually([&] {
    return spm_client_read_object(here.client, id, &object) == SPM_CLIENT_OK &&
           object.position[0] == 0.2;
  }));
  REQUIRE(spm_client_set_material(here.client, id, &material) == SPM_CLIENT_OK);
  REQUIRE(spm_client_set_clutch(here.client, 0, 1) == SPM_CLIENT_OK);
  REQUIRE(spm_client_remove_object(here.client, id) == SPM_CLIENT_OK);
  REQUIRE(eventually(
      [&] { return spm_client_read_object(here.client, id, &object) == SPM_CLIENT_NOT_THERE; }));

  auto counts = sized<spm_client_command_counts>();
  REQUIRE(spm_client_refusals(here.client, &counts) == SPM_CLIENT_OK);
  REQUIRE(counts.sent == 5);
  REQUIRE(counts.refused == 0);
  REQUIRE(spm_client_move_object(here.client, 4711, &pose) == SPM_CLIENT_NOT_THERE);
  // Whether its own object is there yet a client cannot know.
  REQUIRE(spm_client_move_object(here.client, id, &pose) == SPM_CLIENT_OK);
  REQUIRE(eventually([&] {
    return spm_client_refusals(here.client, &counts) == SPM_CLIENT_OK && counts.refused == 1;
  }));
  REQUIRE(counts.last_refused == 6);
  REQUIRE(contains(spm_client_refusal(counts.last_refusal), "no such object"));
}

TEST_CASE("Objects leave with the application that added them") {
  const Daemon daemon;
  const LoopStandIn loop(*daemon.state);
  const Connected watcher(daemon.server->path());
  auto tick = sized<spm_client_tick>();
  {
    const Connected here(daemon.server->path());
    const auto pose = pose_at(0);
    std::uint64_t id = 0;
    REQUIRE(spm_client_add_object(here.client, 0, &pose, 1, nullptr, &id) == SPM_CLIENT_OK);
    REQUIRE(id >> 32U == 2);
    REQUIRE(eventually([&] {
      return spm_client_read_tick(watcher.client, &tick) == SPM_CLIENT_OK && tick.object_count == 2;
    }));
  }
  REQUIRE(eventually([&] {
    return spm_client_read_tick(watcher.client, &tick) == SPM_CLIENT_OK && tick.object_count == 1;
  }));
}

TEST_CASE("A number that is wrong is told at once, and nothing is sent") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  auto pose = pose_at(std::nan(""));
  REQUIRE(spm_client_move_object(here.client, 0, &pose) == SPM_CLIENT_BAD_ARGUMENT);
  pose = pose_at(1000);
  REQUIRE(spm_client_move_object(here.client, 0, &pose) == SPM_CLIENT_BAD_ARGUMENT);
  pose = pose_at(0);
  pose.deadline = -1;
  REQUIRE(spm_client_move_object(here.client, 0, &pose) == SPM_CLIENT_BAD_ARGUMENT);
  pose = pose_at(0);
  std::uint64_t id = 5;
  REQUIRE(spm_client_add_object(here.client, 1, &pose, 1, nullptr, &id) == SPM_CLIENT_NOT_THERE);
  REQUIRE(id == 0);
  REQUIRE(spm_client_add_object(here.client, 0, &pose, 0, nullptr, &id) == SPM_CLIENT_BAD_ARGUMENT);
  REQUIRE(spm_client_set_clutch(here.client, 3, 1) == SPM_CLIENT_NOT_THERE);
  REQUIRE(spm_client_set_clutch(here.client, 0, 2) == SPM_CLIENT_BAD_ARGUMENT);
  auto counts = sized<spm_client_command_counts>();
  REQUIRE(spm_client_refusals(here.client, &counts) == SPM_CLIENT_OK);
  REQUIRE(counts.sent == 0);
}

TEST_CASE("A ring that is full is a return code, and has room again once the loop took from it") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  const auto pose = pose_at(0);
  for (int i = 0; i < SPM_RING_SLOTS; ++i) {
    REQUIRE(spm_client_move_object(here.client, 0, &pose) == SPM_CLIENT_OK);
  }
  REQUIRE(spm_client_move_object(here.client, 0, &pose) == SPM_CLIENT_RING_FULL);
  REQUIRE(daemon.state->take(0).size() == AppState::max_of_client);
  REQUIRE(spm_client_move_object(here.client, 0, &pose) == SPM_CLIENT_OK);
}

TEST_CASE("The daemon's state is told: running, stalled, ended") {
  Daemon daemon;
  const Connected here(daemon.server->path());
  double age = 0;
  REQUIRE(spm_client_daemon_state(here.client, &age) == SPM_CLIENT_STALLED);
  REQUIRE(age == -1);
  {
    const LoopStandIn loop(*daemon.state);
    REQUIRE(eventually([&] {
      return spm_client_daemon_state(here.client, &age) == SPM_CLIENT_RUNNING && age < 0.1;
    }));
  }
  REQUIRE(eventually([&] {
    return spm_client_daemon_state(here.client, &age) == SPM_CLIENT_STALLED && age >= 0.1;
  }));
  daemon.server.reset();
  REQUIRE(spm_client_daemon_state(here.client, &age) == SPM_CLIENT_ENDED);
  const auto pose = pose_at(0);
  REQUIRE(spm_client_move_object(here.client, 0, &pose) == SPM_CLIENT_NO_DAEMON);
  auto device = sized<spm_client_device>();
  REQUIRE(spm_client_read_device(here.client, 0, &device) == SPM_CLIENT_NO_DAEMON);
}

TEST_CASE("A caller of a later version keeps what this one does not know") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  const std::vector<AppDevice> devices{device_of(1), device_of(1)};
  daemon.state->publish({1, 1, devices, {}});
  struct Later {
    spm_client_device known;
    double news;
  };
  std::array<Later, 2> later{};
  later[0].known.size = sizeof(Later);
  later[0].news = later[1].news = 42;
  auto tick = sized<spm_client_tick>();
  REQUIRE(spm_client_read_all(here.client, &tick, &later[0].known, 2, nullptr, 0) == SPM_CLIENT_OK);
  REQUIRE(later[1].known.position[0] == 1);
  REQUIRE(later[1].known.size == sizeof(Later));
  REQUIRE(later[0].news == 42);
  REQUIRE(later[1].news == 42);
  auto device = sized<spm_client_device>();
  device.size = offsetof(spm_client_device, proxy) - 8;
  REQUIRE(spm_client_read_device(here.client, 0, &device) == SPM_CLIENT_BAD_ARGUMENT);
}

TEST_CASE("A caller of the first version gets what it knows, and nothing is written behind it") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  const std::vector<AppDevice> devices{device_of(1), device_of(1)};
  daemon.state->publish({1, 1, devices, {}});
  constexpr std::size_t first = offsetof(spm_client_device, proxy);
  alignas(8) std::array<unsigned char, 2 * first + 8> bytes{};
  bytes.back() = 42;
  auto* const devices_then = reinterpret_cast<spm_client_device*>(bytes.data());
  devices_then->size = first;
  auto tick = sized<spm_client_tick>();
  REQUIRE(spm_client_read_all(here.client, &tick, devices_then, 2, nullptr, 0) == SPM_CLIENT_OK);
  CHECK(reinterpret_cast<const spm_client_device*>(bytes.data() + first)->position[0] == 1);
  REQUIRE(spm_client_read_device(here.client, 0, devices_then) == SPM_CLIENT_OK);
  CHECK(devices_then->cuts == 0);
  CHECK(bytes.back() == 42);
  auto now = sized<spm_client_device>();
  REQUIRE(spm_client_read_device(here.client, 0, &now) == SPM_CLIENT_OK);
  CHECK(now.proxy[0] == 81);
  CHECK(now.force_cap == 91);
  spm_client_options options{};
  options.size = offsetof(spm_client_options, role);
  options.role = 77;  // behind what that version has
  options.path = daemon.server->path().c_str();
  spm_client* client = nullptr;
  CHECK(spm_client_connect(&options, &client, nullptr, 0) == SPM_CLIENT_OK);
  spm_client_disconnect(client);
  options.size = sizeof options;
  CHECK(spm_client_connect(&options, &client, nullptr, 0) == SPM_CLIENT_BAD_ARGUMENT);
}

TEST_CASE("A tick is waited for until it comes, the time is over, or the daemon ends") {
  Daemon daemon;
  const Connected here(daemon.server->path());
  auto tick = sized<spm_client_tick>();
  CHECK(spm_client_wait_tick(here.client, 0, 0.01, &tick) == SPM_CLIENT_NOT_THERE);
  const double nan = std::nan("");
  CHECK(spm_client_wait_tick(here.client, 0, nan, &tick) == SPM_CLIENT_BAD_ARGUMENT);
  CHECK(spm_client_wait_tick(here.client, 0, -1, &tick) == SPM_CLIENT_BAD_ARGUMENT);
  {
    const LoopStandIn loop(*daemon.state);
    std::uint64_t last = 0;
    for (int i = 0; i < 100; ++i) {
      REQUIRE(spm_client_wait_tick(here.client, last, 20, &tick) == SPM_CLIENT_OK);
      REQUIRE(tick.tick > last);
      last = tick.tick;
    }
    CHECK(spm_client_wait_tick(here.client, 0, 0, nullptr) == SPM_CLIENT_OK);
  }
  CHECK(spm_client_wait_tick(here.client, std::uint64_t{1} << 60U, 0.01, &tick) ==
        SPM_CLIENT_NOT_THERE);
  std::thread ends([&daemon] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    daemon.state->end();
  });
  CHECK(spm_client_wait_tick(here.client, std::uint64_t{1} << 60U, 20, &tick) ==
        SPM_CLIENT_NO_DAEMON);
  ends.join();
}

TEST_CASE("Events tell each change once, also of contacts that were over before anybody looked") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  std::vector<AppDevice> devices(1);
  std::uint64_t tick = 0;
  const auto publish = [&] { daemon.state->publish({++tick, 0, devices, {}}); };
  publish();
  REQUIRE(event_kinds(here.client).empty());
  devices[0].contact = true;
  devices[0].state.buttons = 5;
  publish();
  REQUIRE(event_kinds(here.client) == std::vector<std::uint32_t>{SPM_CLIENT_CONTACT_BEGAN,
                                                                 SPM_CLIENT_BUTTON_PRESSED,
                                                                 SPM_CLIENT_BUTTON_PRESSED});
  REQUIRE(event_kinds(here.client).empty());
  devices[0].contact = false;
  devices[0].state.buttons = 4;
  publish();
  REQUIRE(event_kinds(here.client) ==
          std::vector<std::uint32_t>{SPM_CLIENT_CONTACT_ENDED, SPM_CLIENT_BUTTON_RELEASED});
  devices[0].contact = true;
  publish();
  devices[0].contact = false;
  publish();
  REQUIRE(event_kinds(here.client) ==
          std::vector<std::uint32_t>{SPM_CLIENT_CONTACT_BEGAN, SPM_CLIENT_CONTACT_ENDED});
  devices[0].cause = ForceOff::device_gone;
  devices[0].health = DeviceHealth::gone;
  publish();
  auto event = sized<spm_client_event>();
  REQUIRE(spm_client_next_event(here.client, &event) == SPM_CLIENT_OK);
  REQUIRE(event.kind == SPM_CLIENT_DEVICE_LOST);
  REQUIRE(spm_client_next_event(here.client, &event) == SPM_CLIENT_OK);
  REQUIRE(event.kind == SPM_CLIENT_FORCE_CUT);
  REQUIRE(event.value == SPM_CLIENT_OFF_DEVICE_GONE);
  REQUIRE(event.tick == tick);
  devices[0] = AppDevice{};
  publish();
  REQUIRE(event_kinds(here.client) == std::vector<std::uint32_t>{SPM_CLIENT_DEVICE_FOUND,
                                                                 SPM_CLIENT_FORCE_BACK,
                                                                 SPM_CLIENT_BUTTON_RELEASED});
}

TEST_CASE("Many threads read and send at once, and nothing is torn or lost") {
  const Daemon daemon;
  const LoopStandIn loop(*daemon.state);
  const Connected here(daemon.server->path());
  std::atomic<int> torn{0}, sent{0};
  std::vector<std::thread> threads;
  threads.reserve(3);
  for (int number = 0; number < 3; ++number) {
    threads.emplace_back([&, number] {
      auto device = sized<spm_client_device>();
      std::uint64_t newest = 0;
      for (int i = 0; i < 3000; ++i) {
        const int code = spm_client_read_device(here.client, 0, &device);
        if (code == SPM_CLIENT_OK) {
          // The stand-in's x follows from its tick, and ticks never go back.
          const bool whole = device.position[0] == static_cast<double>(device.tick) * 1e-6;
          torn += whole && device.tick >= newest ? 0 : 1;
          newest = device.tick;
        }
        const auto pose = pose_at(0.001 * number);
        if (i % 10 == 0 && spm_client_move_object(here.client, 0, &pose) == SPM_CLIENT_OK) ++sent;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  REQUIRE(torn == 0);
  auto counts = sized<spm_client_command_counts>();
  REQUIRE(eventually([&] {
    return spm_client_refusals(here.client, &counts) == SPM_CLIENT_OK &&
           counts.taken == static_cast<std::uint64_t>(sent.load());
  }));
  REQUIRE(counts.refused == 0);
  REQUIRE(daemon.state->counters().garbage == 0);
}

}  // namespace client_library_test
