// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "servo/app/app_server.hpp"
#include "servo/client/spm_client.h"
#include "servo/shared/shared_buckets.hpp"
#include "tests/servo/support/connected_client.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace client_counts_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

/// Counts a tick with numbers that all follow from the tick.
void count_tick(AppState& state, std::uint64_t tick) {
  const auto number = static_cast<double>(tick);
  const std::vector<DeviceCounters> devices(
      2, {tick + 1, tick + 2, tick + 3, number + 4, number + 5, number + 6, {}});
  const auto ns = static_cast<std::int64_t>(tick);
  state.count({ns, 2 * ns, 3 * ns, tick, tick + 7, tick + 8, devices, tick + 9});
}

}  // namespace

TEST_CASE("What the loop counted is what the application reads") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  auto loop = sized<spm_client_loop>();
  auto counts = sized<spm_client_device_counts>();
  REQUIRE(spm_client_read_loop(here.client, &loop) == SPM_CLIENT_NOT_THERE);
  REQUIRE(spm_client_read_device_counts(here.client, 0, &counts) == SPM_CLIENT_NOT_THERE);
  for (std::uint64_t tick = 1; tick <= 1000; ++tick) count_tick(*daemon.state, tick);
  REQUIRE(spm_client_read_loop(here.client, &loop) == SPM_CLIENT_OK);
  REQUIRE(loop.ticks == 1000);
  REQUIRE(loop.time_ns == 1000);
  REQUIRE(loop.missed == 1007);
  REQUIRE(loop.skipped == 1008);
  REQUIRE(loop.degraded == 1009);
  REQUIRE(loop.busy_ns == std::uint64_t{3} * 500'500);
  REQUIRE(loop.wake_max_ns == 2000);
  REQUIRE(loop.busy_max_ns == 3000);
  // Of 2, 4, ... 2000 ns, 63 are shorter than 128 ns.
  REQUIRE(loop.wake[0] == 63);
  REQUIRE(loop.wake[1] == 64);
  std::uint64_t sum = 0;
  for (const std::uint64_t bucket : loop.busy) sum += bucket;
  REQUIRE(sum == 1000);
  REQUIRE(spm_client_read_device_counts(here.client, 1, &counts) == SPM_CLIENT_OK);
  REQUIRE(counts.contact_ticks == 1001);
  REQUIRE(counts.cap_hits == 1002);
  REQUIRE(counts.slew_hits == 1003);
  REQUIRE(counts.force_max == 1004);
  REQUIRE(counts.energy == 1005);
  REQUIRE(counts.generated_max == 1006);
  REQUIRE(spm_client_read_device_counts(here.client, 2, &counts) == SPM_CLIENT_NOT_THERE);
}

TEST_CASE("Buckets end where the header says, and there are 64 of them") {
  REQUIRE(spm_client_bucket_end(0) == 128);
  for (std::uint32_t bucket = 0; bucket < 64; ++bucket) {
    const std::uint64_t end = spm_client_bucket_end(bucket);
    REQUIRE(shared_bucket(static_cast<std::int64_t>(end) - 1) == bucket);
    if (bucket > 0) REQUIRE(end > spm_client_bucket_end(bucket - 1));
  }
  REQUIRE(spm_client_bucket_end(64) == 0);
  REQUIRE(spm_client_bucket_end(UINT32_MAX) == 0);
}

TEST_CASE("Counts are never read torn while they are written without a pause") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  count_tick(*daemon.state, 1);
  std::atomic<bool> stop{false};
  std::thread writer([&] {
    for (std::uint64_t tick = 2; !stop.load(); ++tick) count_tick(*daemon.state, tick);
  });
  int read = 0, torn = 0;
  std::set<std::uint64_t> seen;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while ((read < 20'000 || seen.size() < 16) && std::chrono::steady_clock::now() < deadline) {
    auto loop = sized<spm_client_loop>();
    auto counts = sized<spm_client_device_counts>();
    if (spm_client_read_loop(here.client, &loop) == SPM_CLIENT_OK) {
      std::uint64_t late = 0, worked = 0;
      for (const std::uint64_t bucket : loop.wake) late += bucket;
      for (const std::uint64_t bucket : loop.busy) worked += bucket;
      const bool whole = loop.missed == loop.ticks + 7 && loop.skipped == loop.ticks + 8 &&
                         late == loop.ticks && worked == loop.ticks &&
                         loop.wake_max_ns == 2 * loop.ticks;
      torn += whole ? 0 : 1;
      seen.insert(loop.ticks);
      ++read;
    }
    if (spm_client_read_device_counts(here.client, 0, &counts) == SPM_CLIENT_OK) {
      torn += counts.slew_hits == counts.cap_hits + 1 &&
                      counts.energy == static_cast<double>(counts.cap_hits + 3)
                  ? 0
                  : 1;
    }
  }
  stop.store(true);
  writer.join();
  REQUIRE(torn == 0);
  REQUIRE(read >= 20'000);
  REQUIRE(seen.size() >= 16);
}

TEST_CASE("Applications see each other come and go") {
  const Daemon daemon;
  const auto count_seen_by = [](const Connected& client) {
    auto application = sized<spm_client_application>();
    std::uint32_t count = 0;
    while (spm_client_read_application(client.client, count, &application) == SPM_CLIENT_OK)
      ++count;
    return count;
  };
  const Connected first(daemon.server->path());
  REQUIRE(count_seen_by(first) == 1);
  {
    const Connected second(daemon.server->path());
    REQUIRE(count_seen_by(second) == 2);
    REQUIRE(count_seen_by(first) == 2);
  }
  REQUIRE(eventually([&] { return count_seen_by(first) == 1; }));
  auto application = sized<spm_client_application>();
  REQUIRE(spm_client_read_application(first.client, 0, &application) == SPM_CLIENT_OK);
  REQUIRE(application.process == static_cast<std::uint32_t>(getpid()));
  REQUIRE(application.connection == 1);
  REQUIRE(application.role == SPM_CLIENT_APPLICATION);
}

TEST_CASE("Applications see who has the role of a supervisor, and who only watches") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  const Connected supervisor(daemon.server->path(), 20000, SPM_CLIENT_SUPERVISOR);
  const Connected observer(daemon.server->path(), 20000, SPM_CLIENT_OBSERVER);
  auto application = sized<spm_client_application>();
  REQUIRE(spm_client_read_application(here.client, 1, &application) == SPM_CLIENT_OK);
  REQUIRE(application.role == SPM_CLIENT_SUPERVISOR);
  REQUIRE(spm_client_read_application(here.client, 2, &application) == SPM_CLIENT_OK);
  REQUIRE(application.role == SPM_CLIENT_OBSERVER);
  REQUIRE(spm_client_read_application(here.client, 0, &application) == SPM_CLIENT_OK);
  REQUIRE(application.role == SPM_CLIENT_APPLICATION);
}

TEST_CASE("A struct of a size that no version had, and no client, are refused") {
  const Daemon daemon;
  const Connected here(daemon.server->path());
  count_tick(*daemon.state, 1);
  spm_client_loop loop{};
  spm_client_device_counts counts{};
  spm_client_application application{};
  REQUIRE(spm_client_read_loop(here.client, &loop) == SPM_CLIENT_BAD_ARGUMENT);
  REQUIRE(spm_client_read_device_counts(here.client, 0, &counts) == SPM_CLIENT_BAD_ARGUMENT);
  REQUIRE(spm_client_read_application(here.client, 0, &application) == SPM_CLIENT_BAD_ARGUMENT);
  REQUIRE(spm_client_read_loop(nullptr, &loop) == SPM_CLIENT_BAD_ARGUMENT);
  REQUIRE(spm_client_read_loop(here.client, nullptr) == SPM_CLIENT_BAD_ARGUMENT);
}

}  // namespace client_counts_test
