// SPDX-License-Identifier: Apache-2.0
#include "servo/app/app_state.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <cerrno>
#include <chrono>
#include <set>
#include <thread>
#include <vector>

#include "servo/client/state_reader.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace app_state_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

const spm_shared_state& shared(const AppState& state) {
  return *static_cast<const spm_shared_state*>(state.memory().data());
}

/// A tick of full size, whose values follow from its number.
struct FullTick {
  explicit FullTick(std::uint64_t number)
      : devices(SPM_MAX_DEVICES, device_of(number)), tick(number) {
    for (std::uint64_t id = 0; id < SPM_MAX_OBJECTS; ++id) {
      objects.push_back(object_of(id, number));
    }
  }
  std::vector<AppDevice> devices;
  std::vector<AppObject> objects;
  std::uint64_t tick;
  [[nodiscard]] AppTick view() const {
    return {tick, static_cast<std::int64_t>(tick), devices, objects};
  }
};

}  // namespace

TEST_CASE("A published tick is read back as it was") {
  const auto state = small_state();
  REQUIRE(read_newest(shared(*state), [](const auto&) { return true; }) == ReadResult::none);
  for (std::uint64_t number = 1; number < 5; ++number) {
    const FullTick tick(number);
    state->publish(tick.view());
    int devices = 0, objects = 0;
    const ReadResult result = read_newest(shared(*state), [&](const auto& snapshot) {
      REQUIRE(snapshot.tick == number);
      REQUIRE(snapshot.time_ns == static_cast<std::int64_t>(number));
      for (std::uint32_t i = 0; i < device_count(snapshot); ++i) {
        devices += is_of_tick(snapshot.devices[i], number) ? 1 : 0;
      }
      for (std::uint32_t i = 0; i < object_count(snapshot); ++i) {
        REQUIRE(snapshot.objects[i].id == i);
        objects += is_of_tick(snapshot.objects[i], number) ? 1 : 0;
      }
      return true;
    });
    REQUIRE(result == ReadResult::fine);
    REQUIRE(devices == SPM_MAX_DEVICES);
    REQUIRE(objects == SPM_MAX_OBJECTS);
  }
}

TEST_CASE("More devices and objects than there is room for are left out") {
  const auto state = small_state();
  FullTick tick(3);
  tick.devices.resize(SPM_MAX_DEVICES + 3, device_of(3));
  tick.objects.resize(SPM_MAX_OBJECTS + 9, object_of(0, 3));
  state->publish(tick.view());
  const ReadResult result = read_newest(shared(*state), [](const auto& snapshot) {
    return snapshot.device_count == SPM_MAX_DEVICES && snapshot.object_count == SPM_MAX_OBJECTS;
  });
  REQUIRE(result == ReadResult::fine);
}

TEST_CASE("A state is never read torn while it is written without a pause") {
  const auto state = small_state();
  std::atomic<bool> stop{false};
  state->publish(FullTick(0).view());
  std::thread writer([&] {
    std::vector<FullTick> ticks;
    for (std::uint64_t number = 0; number < 16; ++number) ticks.emplace_back(number);
    for (std::uint64_t round = 0; !stop.load(); ++round) state->publish(ticks[round % 16].view());
  });
  constexpr int wanted = 20000;
  int read = 0, torn = 0;
  std::set<std::uint64_t> seen;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while ((read < wanted || seen.size() < 16) && std::chrono::steady_clock::now() < deadline) {
    std::uint64_t number = 0;
    spm_shared_device device;
    spm_shared_object object;
    const auto index = static_cast<std::uint32_t>(read);
    const ReadResult result = read_newest(shared(*state), [&](const auto& snapshot) {
      number = load_relaxed(snapshot.tick);
      device = load_record(snapshot.devices[index % SPM_MAX_DEVICES]);
      object = load_record(snapshot.objects[index % SPM_MAX_OBJECTS]);
      return true;
    });
    if (result != ReadResult::fine) {
      std::this_thread::yield();
      continue;
    }
    ++read;
    torn += is_of_tick(device, number) && is_of_tick(object, number) ? 0 : 1;
    seen.insert(number);
  }
  stop.store(true);
  writer.join();
  REQUIRE(torn == 0);
  REQUIRE(read >= wanted);
  REQUIRE(seen.size() == 16);
}

TEST_CASE("A loop that dies while it writes leaves the tick before to be read") {
  const auto state = small_state();
  state->publish(FullTick(1).view());
  state->publish(FullTick(2).view());
  auto& memory = *static_cast<spm_shared_state*>(state->memory().data());
  store_relaxed(memory.snapshots[0].sequence, memory.snapshots[0].sequence + 1);
  std::uint64_t number = 0;
  REQUIRE(read_newest(memory, [&](const auto& snapshot) {
            number = snapshot.tick;
            return true;
          }) == ReadResult::fine);
  REQUIRE(number == 2);
}

TEST_CASE("Contacts and cuts are counted as they begin") {
  const auto state = small_state();
  const std::vector<bool> contact{false, true, true, false, true, false};
  const std::vector<bool> cut{true, true, false, true, false, true};
  for (std::size_t i = 0; i < contact.size(); ++i) {
    std::vector<AppDevice> devices(1);
    devices[0].contact = contact[i];
    devices[0].cause = cut[i] ? ForceOff::device_gone : ForceOff::none;
    state->publish({i, 0, devices, {}});
  }
  const spm_shared_device& device = shared(*state).snapshots[1].devices[0];
  REQUIRE(device.contacts == 2);
  REQUIRE(device.cuts == 2);
}

TEST_CASE("Names and causes are there for applications, and are cut where they are too long") {
  const auto state = small_state();
  const spm_shared_info& info = shared(*state).info;
  REQUIRE(info.device_count == 1);
  REQUIRE(std::string(info.devices[0]) == "hand");
  REQUIRE(std::string(info.assets[0]) == "bunny");
  REQUIRE(std::string(info.objects[0]) == "first");
  REQUIRE(info.cause_count == force_off_count);
  for (std::size_t i = 0; i < force_off_count; ++i) {
    REQUIRE(std::string(info.causes[i].name) == to_string(static_cast<ForceOff>(i)));
    REQUIRE(std::string(info.causes[i].cure) == cure_of(static_cast<ForceOff>(i)));
  }
  state->rename({{std::string(200, 'x')}, std::vector<std::string>(100, "a"), {}});
  REQUIRE(std::string(info.devices[0]) == std::string(SPM_NAME_BYTES - 1, 'x'));
  REQUIRE(info.asset_count == SPM_MAX_ASSETS);
  REQUIRE(info.object_count == 0);
}

TEST_CASE("Applications cannot map the loop's state for writing") {
  const auto state = small_state();
  const auto descriptor = state->memory().read_only_descriptor();
  REQUIRE(descriptor);
  const std::size_t size = state->memory().size();
  REQUIRE(mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, *descriptor, 0) == MAP_FAILED);
  REQUIRE(errno == EACCES);
  // The seal holds for the writable descriptor too, by whatever way somebody gets at it.
  REQUIRE(mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, state->memory().descriptor(),
               0) == MAP_FAILED);
  REQUIRE(ftruncate(state->memory().descriptor(), 0) != 0);
  void* const readable = mmap(nullptr, size, PROT_READ, MAP_SHARED, *descriptor, 0);
  REQUIRE(readable != MAP_FAILED);
  REQUIRE(mprotect(readable, size, PROT_READ | PROT_WRITE) != 0);
  munmap(readable, size);
  close(*descriptor);
}

TEST_CASE("A flood is bounded a tick, and every client gets its turn") {
  const auto state = small_state();
  std::vector<RawRing> rings;
  for (std::uint32_t client = 0; client < SPM_MAX_CLIENTS; ++client) {
    rings.emplace_back(client + 1);
  }
  for (std::uint32_t client = 0; client < SPM_MAX_CLIENTS; ++client) {
    state->rings()[client].offer(rings[client].attached());
  }
  std::vector<int> taken_of(SPM_MAX_CLIENTS, 0);
  for (int tick = 0; tick < 160; ++tick) {
    for (std::uint32_t client = 0; client < SPM_MAX_CLIENTS; ++client) {
      // All clients but one flood. That one sends one command a tick if there is room.
      const int sent = client == 11 ? 1 : AppState::max_of_client;
      const bool room = rings[client].ring().head - rings[client].ring().tail + sent <
                        std::uint64_t{SPM_RING_SLOTS};
      for (int i = 0; room && i < sent; ++i) rings[client].write(move_command(0, tick));
    }
    const auto taken = state->take(0);
    REQUIRE(taken.size() <= AppState::max_of_all);
    for (const AppCommand& command : taken) ++taken_of[command.client];
  }
  for (std::uint32_t client = 0; client < SPM_MAX_CLIENTS; ++client) {
    // Sixteen clients share two full turns a tick.
    REQUIRE(taken_of[client] >= 100);
  }
}

TEST_CASE("One client that floods does not delay another's commands") {
  const auto state = small_state();
  RawRing flood(1), modest(2);
  state->rings()[0].offer(flood.attached());
  state->rings()[1].offer(modest.attached());
  for (int tick = 0; tick < 100; ++tick) {
    while (flood.ring().head - flood.ring().tail < SPM_RING_SLOTS) {
      flood.write(move_command(0, 0));
    }
    modest.write(move_command(0, tick));
    bool arrived = false;
    for (const AppCommand& command : state->take(0)) {
      arrived = arrived || (command.connection == 2 && command.pose.position.x() == tick);
    }
    REQUIRE(arrived);
  }
}

TEST_CASE("The loop is told once when a client has gone, and whose place was taken by another") {
  const auto state = small_state();
  RawRing first(1), second(2);
  ClientRing& place = state->rings()[4];
  place.offer(first.attached());
  first.write(move_command(0, 0));
  REQUIRE(state->take(0).size() == 1);
  place.offer(nullptr);
  REQUIRE(place.released(first.attached()));
  auto taken = state->take(0);
  REQUIRE(taken.size() == 1);
  REQUIRE(taken[0].action == AppAction::departure);
  REQUIRE(taken[0].connection == 1);
  REQUIRE(taken[0].client == 4);
  REQUIRE(state->take(0).empty());

  RawRing third(3);
  place.offer(second.attached());
  REQUIRE(state->take(0).empty());
  place.offer(third.attached());
  third.write(move_command(0, 0));
  taken = state->take(0);
  REQUIRE(taken.size() == 2);
  REQUIRE(taken[0].action == AppAction::departure);
  REQUIRE(taken[0].connection == 2);
  REQUIRE(taken[1].connection == 3);
}

TEST_CASE("A refusal of the loop reaches the client that is still there, and nobody else") {
  const auto state = small_state();
  RawRing first(1), second(2);
  state->rings()[0].offer(first.attached());
  first.write(move_command(12, 0));
  const AppCommand command = state->take(0)[0];
  state->refuse(command, Refusal::unknown_object);
  REQUIRE(first.ring().refused == 1);
  REQUIRE(first.ring().last_refusal == static_cast<std::uint64_t>(Refusal::unknown_object));
  state->rings()[0].offer(second.attached());
  state->refuse(command, Refusal::unknown_object);
  REQUIRE(second.ring().refused == 0);
  REQUIRE(first.ring().refused == 1);
}

TEST_CASE("A ring counts as used from the loop's begin to its end") {
  RawRing ring(7);
  ClientRing place;
  place.offer(ring.attached());
  REQUIRE(place.begin() == 7);
  place.offer(nullptr);
  REQUIRE_FALSE(place.released(ring.attached()));
  place.end();
  REQUIRE(place.released(ring.attached()));
  REQUIRE(place.begin() == 0);
  place.end();
}

TEST_CASE("A ring that is taken away while the loop runs is never used afterwards") {
  const auto state = small_state();
  std::atomic<bool> stop{false};
  std::thread loop([&] {
    while (!stop.load()) static_cast<void>(state->take(0));
  });
  for (std::uint32_t round = 1; round < 2000; ++round) {
    RawRing ring(round);
    ClientRing& place = state->rings()[round % SPM_MAX_CLIENTS];
    place.offer(ring.attached());
    ring.write(move_command(0, 1));
    place.offer(nullptr);
    while (!place.released(ring.attached())) std::this_thread::yield();
    // Here the ring's memory is unmapped: a loop that still used it would crash.
  }
  stop.store(true);
  loop.join();
}

}  // namespace app_state_test
