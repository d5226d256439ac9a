// SPDX-License-Identifier: Apache-2.0
#include "servo/top/top.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/random.hpp"
#include "servo/app/app_client.hpp"
#include "servo/app/app_state.hpp"
#include "servo/base/duration_buckets.hpp"
#include "servo/shared/shared_buckets.hpp"
#include "servo/top/top_screen.hpp"

namespace top_test {

using namespace spm;
using namespace spm::servo;

namespace {

/// What the loop's histogram counts, as the daemon counts it.
struct Counted {
  std::uint64_t buckets[64] = {};
  std::uint64_t longest = 0;
  void add(std::int64_t duration_ns) {
    ++buckets[shared_bucket(duration_ns)];
    longest = std::max(longest, static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0)));
  }
};

/// Durations from below a microsecond to beyond the last bucket.
std::int64_t some_duration(Random& random) {
  return static_cast<std::int64_t>(std::exp(random.between(3, 17.5)));
}

TopSample sample_at(std::uint64_t tick) {
  TopSample sample;
  sample.daemon = SPM_CLIENT_RUNNING;
  sample.age = 0.001;
  std::strcpy(sample.info.daemon_version, "1.2.3");
  sample.info.process = 77;
  sample.info.rate_hz = 1000;
  sample.loop.ticks = tick;
  sample.loop.time_ns = static_cast<std::int64_t>(tick) * 1'000'000;
  sample.loop.busy_ns = tick * 20'000;
  sample.loop.wake[shared_bucket(3'000)] = tick;
  sample.loop.busy[shared_bucket(20'000)] = tick;
  sample.loop.wake_max_ns = 3'000;
  sample.loop.busy_max_ns = 20'000;
  TopSample::Device device;
  device.name = "hand";
  device.state.connected = 1;
  device.state.force[0] = 3;
  device.state.force[1] = 4;
  device.counts.force_max = 6;
  device.counts.energy = -0.25;
  sample.devices.push_back(device);
  return sample;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A text as one line, so that it does not matter where it was broken.
std::string unbroken(const std::string& text) {
  std::string joined;
  for (const std::string& line : lines_of(text)) {
    joined += ' ';
    joined += line.substr(std::min(line.size(), line.find_first_not_of(' ')));
  }
  return joined;
}

}  // namespace

TEST_CASE("Every duration is in a bucket that ends after it and by no more than a quarter") {
  std::size_t last = 0;
  for (std::int64_t ns = 0; ns < 16'000'000; ns += 1 + ns / 300) {
    const std::size_t bucket = shared_bucket(ns);
    REQUIRE(bucket >= last);
    REQUIRE(bucket - last <= 1);
    last = bucket;
    const auto end = static_cast<std::int64_t>(bucket_end_ns(bucket));
    REQUIRE(end > ns);
    REQUIRE(end <= std::max<std::int64_t>(ns + 128, ns + ns / 4 + 1));
  }
  REQUIRE(last == SPM_BUCKETS - 1);
  REQUIRE(shared_bucket(-5) == 0);
  REQUIRE(shared_bucket(INT64_MAX) == SPM_BUCKETS - 1);
}

TEST_CASE(
    "Percentiles of the time between two looks are those of its ticks, a quarter above at most") {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    Counted counted;
    for (int i = 0; i < 3000; ++i) counted.add(some_duration(random));
    const Counted before = counted;
    std::vector<double> recent;
    for (int i = 0; i < 1000; ++i) {
      const std::int64_t duration = some_duration(random);
      counted.add(duration);
      recent.push_back(static_cast<double>(duration) * 1e-3);
    }
    std::sort(recent.begin(), recent.end());
    const TopTimes times =
        times_between(before.buckets, counted.buckets, before.longest, counted.longest);
    // For a time beyond the last bucket's start, the only known bound is the longest time.
    const double last_begin = static_cast<double>(bucket_end_ns(SPM_BUCKETS - 2)) * 1e-3;
    const auto is_close = [&](double told, double exact) {
      const double most = exact < last_begin ? std::max(1.2501 * exact, exact + 0.128)
                                             : static_cast<double>(counted.longest) * 1e-3;
      return told >= exact && told <= most;
    };
    REQUIRE(is_close(times.p50, recent[nearest_rank(0.5, 1000) - 1]));
    REQUIRE(is_close(times.p99, recent[nearest_rank(0.99, 1000) - 1]));
    REQUIRE(is_close(times.max, recent.back()));
  }
}

TEST_CASE("The longest duration so far is told exactly when it comes, and not later") {
  Counted counted;
  for (int i = 0; i < 100; ++i) counted.add(2'000);
  const Counted before = counted;
  counted.add(123'457);
  const Counted during = counted;
  counted.add(2'000);
  REQUIRE(times_between(before.buckets, during.buckets, before.longest, during.longest).max ==
          Approx(123.457));
  const TopTimes after =
      times_between(during.buckets, counted.buckets, during.longest, counted.longest);
  REQUIRE(after.max < 2.6);
  REQUIRE(times_between(counted.buckets, counted.buckets, counted.longest, counted.longest).max ==
          0);
}

TEST_CASE("Rate and busy share are those between two looks, by the loop's own clock") {
  TopSample before = sample_at(5000), now = sample_at(5900);
  now.loop.time_ns = before.loop.time_ns + 1'000'000'000;
  now.loop.missed = 130;
  now.loop.skipped = 100;
  before.loop.missed = 30;
  const TopView view = view_between(before, now);
  REQUIRE(view.seconds == Approx(1));
  REQUIRE(view.rate_hz == Approx(900));
  REQUIRE(view.busy_share == Approx(900 * 20e-6));
  REQUIRE(view.ticks == 5900);
  REQUIRE(view.missed.recent == 100);
  REQUIRE(view.missed.total == 130);
  REQUIRE(view.skipped.recent == 100);
}

TEST_CASE("Before the first tick, and while the loop stands still, there is no rate and no time") {
  const TopView first = view_between({}, sample_at(1000));
  REQUIRE(first.rate_hz == 0);
  REQUIRE(first.busy_share == 0);
  TopSample stalled = sample_at(1000);
  stalled.daemon = SPM_CLIENT_STALLED;
  stalled.age = 2.5;
  const TopView still = view_between(stalled, stalled);
  REQUIRE(still.rate_hz == 0);
  REQUIRE(still.wake.max == 0);
  REQUIRE(has(top_screen(still, 200), "STALLED, no tick for 2.5 s"));
  stalled.age = -1;
  REQUIRE(has(top_screen(view_between(stalled, stalled), 200), "has not begun"));
}

TEST_CASE("A device shows its force now and at most, and the caps it met lately and ever") {
  TopSample before = sample_at(1000), now = sample_at(2000);
  before.devices[0].counts.cap_hits = 4;
  now.devices[0].counts.cap_hits = 11;
  now.devices[0].counts.slew_hits = 2;
  now.devices[0].state.contact = 1;
  now.devices[0].state.contacts = 3;
  const TopView view = view_between(before, now);
  REQUIRE(view.devices.size() == 1);
  const TopDevice& device = view.devices[0];
  REQUIRE(device.force == Approx(5));
  REQUIRE(device.force_max == Approx(6));
  REQUIRE(device.cap_hits.recent == 7);
  REQUIRE(device.cap_hits.total == 11);
  REQUIRE(device.cause.empty());
  const std::string screen = top_screen(view, 80);
  for (const char* part :
       {"hand", "5.000 N", "6.000 N", "11 (+7)", "2 (+2)", "-0.2500 J", "yes 3"}) {
    INFO(screen);
    REQUIRE(has(screen, part));
  }
}

TEST_CASE("Torque and the tool are shown where a device has them, and nowhere else") {
  TopSample before = sample_at(1000), now = sample_at(2000);
  const std::string without = top_screen(view_between(before, now), 100);
  REQUIRE_FALSE(has(without, "torque"));
  REQUIRE_FALSE(has(without, "tool"));
  CHECK(to_json(view_between(before, now))["devices"][0]["tool"].is_null());

  TopSample::Device& device = now.devices[0];
  device.state.torque_cap = 0.3;
  device.state.torque[1] = -0.02;
  device.counts.torque_max = 0.05;
  device.counts.torque_cap_hits = 3;
  device.state.has_tool = 1;
  device.state.tool_position[2] = 0.0125;
  device.state.tool_orientation[0] = 1;
  device.state.contact_count = 2;
  device.state.level = 1;
  device.state.culled = 5;
  device.state.limits = SPM_CLIENT_TOOL_CAP_MET;
  device.counts.tool_cap_hits = 9;
  before.devices[0].counts.tool_cap_hits = 2;
  now.loop.coarse = 40;
  const TopView view = view_between(before, now);
  const std::string screen = unbroken(top_screen(view, 80));
  for (const char* part :
       {"torque 0.0200 N m, max 0.0500, cap met 3 (+3)", "tool at 0.00 0.00 12.50 mm",
        "touches at 2 places, 5 objects culled, level 1", "coupling's cap met 9 (+7) (now)",
        "coarser samples 40 (+40)"}) {
    INFO(screen);
    CHECK(has(screen, part));
  }
  const nlohmann::ordered_json json = to_json(view);
  CHECK(json["coarse_ticks"]["total"] == 40);
  const nlohmann::ordered_json& hand = json["devices"][0];
  CHECK(hand["torque_n_m"]["now"] == 0.02);
  CHECK(hand["torque_n_m"]["cap"] == 0.3);
  CHECK(hand["tool"]["position_m"][2] == 0.0125);
  CHECK(hand["tool"]["contacts"] == 2);
  CHECK(hand["tool"]["culled"] == 5);
  CHECK(hand["tool"]["capped"] == true);
}

TEST_CASE("The cause of zero force is shown with its cure, and what it was once it is over") {
  TopSample before = sample_at(1000), now = sample_at(2000);
  now.devices[0].cause = "device_gone";
  now.devices[0].cure = "plug the device in again, the loop takes it up by itself";
  // A device that was never without force has no cause to show, whatever cause the loop began with.
  REQUIRE_FALSE(has(top_screen(view_between(before, now), 80), "device_gone"));
  now.devices[0].state.cause = SPM_CLIENT_OFF_DEVICE_GONE;
  now.devices[0].state.cuts = 2;
  const TopView off = view_between(before, now);
  REQUIRE(has(unbroken(top_screen(off, 60)),
              "NO FORCE, device_gone: plug the device in again, the "
              "loop takes it up by itself"));
  REQUIRE(to_json(off)["devices"][0]["force_off"]["cause"] == "device_gone");
  now.devices[0].state.cause = SPM_CLIENT_FORCE_ON;
  const TopView on = view_between(before, now);
  REQUIRE(has(unbroken(top_screen(on, 60)), "force was cut 2 (+2) times, last device_gone: plug"));
  REQUIRE(to_json(on)["devices"][0]["force_off"].is_null());
  REQUIRE(to_json(on)["devices"][0]["last_force_off"]["cause"] == "device_gone");
}

TEST_CASE("No line of the screen is wider than the terminal, and no word of a sentence is lost") {
  TopSample before = sample_at(1000), now = sample_at(2000);
  now.devices.resize(8, now.devices[0]);
  now.devices[3].name = std::string(63, 'x');
  now.devices[3].state.cause = SPM_CLIENT_OFF_DEVICE_SILENT;
  now.devices[3].cause = "device_silent";
  now.devices[3].cure = "check the device's cable, its power and the hub; the loop goes on";
  now.applications.resize(16);
  for (std::size_t i = 0; i < now.applications.size(); ++i) {
    static_cast<void>(
        std::string(i % 3 == 0 ? "" : "a study")
            .copy(static_cast<char*>(now.applications[i].name), sizeof now.applications[i].name));
    now.applications[i].process = static_cast<std::uint32_t>(1000 + i);
  }
  const TopView view = view_between(before, now);
  const std::string widest = unbroken(top_screen(view, 10'000));
  for (std::size_t width = 1; width < 200; ++width) {
    const std::string screen = top_screen(view, width);
    for (const std::string& line : lines_of(screen)) {
      REQUIRE(line.size() <= std::max(width, narrowest_screen));
      REQUIRE(std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; }));
    }
    REQUIRE(has(unbroken(screen), "process 1015)"));
    REQUIRE(has(unbroken(screen), now.devices[3].cure));
  }
  REQUIRE(has(widest, "16 applications: without a name (process 1000), a study (process 1001)"));
}

TEST_CASE("A supervisor among the applications is named as one") {
  TopSample now = sample_at(2000);
  now.applications.resize(2);
  now.applications[0].process = 5;
  now.applications[1].process = 6;
  now.applications[1].role = SPM_CLIENT_SUPERVISOR;
  const std::string screen = top_screen(view_between(sample_at(1000), now), 200);
  REQUIRE(has(screen, "(process 5), without a name (process 6, supervisor)"));
}

TEST_CASE("The JSON of a view has what the screen has") {
  TopSample now = sample_at(2000);
  now.applications.resize(2);
  std::strcpy(now.applications[0].name, "a study");
  now.applications[0].process = 5;
  now.applications[1].role = SPM_CLIENT_SUPERVISOR;
  const nlohmann::ordered_json json = to_json(view_between(sample_at(1000), now));
  REQUIRE(json["daemon"] == "running");
  REQUIRE(json["rate_hz"].get<double>() == Approx(1000));
  REQUIRE(json["busy_share"].get<double>() == Approx(0.02));
  REQUIRE(json["wake_us"]["p50"].get<double>() == Approx(3));
  REQUIRE(json["busy_us"]["max"].get<double>() >= 20);
  REQUIRE(json["devices"][0]["force_n"]["now"].get<double>() == Approx(5));
  REQUIRE(json["applications"][0]["name"] == "a study");
  REQUIRE(json["applications"][0]["process"] == 5);
  REQUIRE(json["applications"][0]["role"] == "application");
  REQUIRE(json["applications"][1]["role"] == "supervisor");
  now.age = -1;
  REQUIRE(to_json(view_between(now, now))["age_s"].is_null());
}

TEST_CASE("What the loop counts of its ticks is in the shared state, each tick once") {
  auto state = AppState::create(1000, {{"hand"}, {"asset"}, {"object"}});
  REQUIRE(state);
  const auto& shared = static_cast<const spm_shared_state*>((*state)->memory().data())->loop;
  Random random(7);
  Counted wake, busy;
  std::uint64_t busy_sum = 0;
  for (std::uint64_t tick = 1; tick <= 500; ++tick) {
    const std::int64_t late = some_duration(random), worked = some_duration(random);
    wake.add(late);
    busy.add(worked);
    busy_sum += static_cast<std::uint64_t>(worked);
    const std::vector<DeviceCounters> devices{{tick, 2 * tick, 3 * tick, 4.5, -5.5, 6.5, {}}};
    (*state)->count({static_cast<std::int64_t>(tick), late, worked, tick, 3, 2, devices});
  }
  REQUIRE(shared.ticks == 500);
  REQUIRE(shared.time_ns == 500);
  REQUIRE(shared.missed == 3);
  REQUIRE(shared.skipped == 2);
  REQUIRE(shared.busy_ns == busy_sum);
  REQUIRE(shared.wake_max_ns == wake.longest);
  REQUIRE(shared.busy_max_ns == busy.longest);
  REQUIRE(std::equal(std::begin(shared.wake), std::end(shared.wake), wake.buckets));
  REQUIRE(std::equal(std::begin(shared.busy), std::end(shared.busy), busy.buckets));
  REQUIRE(shared.device_count == 1);
  REQUIRE(shared.devices[0].cap_hits == 1000);
  REQUIRE(shared.devices[0].energy == -5.5);
  REQUIRE(shared.sequence % 2 == 0);
}

TEST_CASE("The last cause of zero force stays to be read when there is force again") {
  auto state = AppState::create(1000, {{"hand"}, {"asset"}, {"object"}});
  REQUIRE(state);
  const auto& shared = static_cast<const spm_shared_state*>((*state)->memory().data())->loop;
  const std::vector<DeviceCounters> counted(1);
  std::vector<AppDevice> devices(1);
  std::uint64_t tick = 0;
  const auto cause_after = [&](ForceOff cause) {
    devices[0].cause = cause;
    (*state)->publish({++tick, 0, devices, {}});
    (*state)->count({0, 0, 0, tick, 0, 0, counted});
    return static_cast<ForceOff>(shared.devices[0].last_cause);
  };
  REQUIRE(cause_after(ForceOff::none) == ForceOff::none);
  REQUIRE(cause_after(ForceOff::device_silent) == ForceOff::device_silent);
  REQUIRE(cause_after(ForceOff::none) == ForceOff::device_silent);
  REQUIRE(cause_after(ForceOff::jumped) == ForceOff::jumped);
}

TEST_CASE("More devices and applications than there is room for are left out of the counts") {
  auto state = AppState::create(1000, {{"hand"}, {"asset"}, {"object"}});
  REQUIRE(state);
  const auto& shared = *static_cast<const spm_shared_state*>((*state)->memory().data());
  const std::vector<DeviceCounters> devices(SPM_MAX_DEVICES + 2);
  (*state)->count({1, 1, 1, 1, 0, 0, devices});
  REQUIRE(shared.loop.device_count == SPM_MAX_DEVICES);
  const std::vector<AppClientReport> clients(SPM_MAX_CLIENTS + 3,
                                             {9, 99, std::string(200, 'n'), 0, 0});
  (*state)->tell_clients(clients);
  REQUIRE(shared.applications.count == SPM_MAX_CLIENTS);
  REQUIRE(shared.applications.list[15].process == 99);
  REQUIRE(std::string(shared.applications.list[15].name) == std::string(SPM_NAME_BYTES - 1, 'n'));
  (*state)->tell_clients({});
  REQUIRE(shared.applications.count == 0);
}

}  // namespace top_test
