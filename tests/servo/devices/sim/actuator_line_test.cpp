// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/actuator_line.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

namespace actuator_line_test {

using namespace spm::servo;
using spm::Vector3;

namespace {

constexpr double period = 1e-3;

ActuatorSettings prompt() {
  ActuatorSettings settings;
  settings.period = period;
  settings.force_cap = 10;
  return settings;
}

Vector3 along(double force) { return {0, force, 0}; }

/// Mean force of each tick for commands 1, 2, 3, ... N.
std::vector<double> counted(const ActuatorSettings& settings, int ticks) {
  ActuatorLine line(settings);
  std::vector<double> means;
  for (int i = 1; i <= ticks; ++i) {
    line.command(along(i));
    means.push_back(line.mean_force(0, 1).y());
  }
  return means;
}

}  // namespace

TEST_CASE("A force without delay acts at once and holds over the tick") {
  ActuatorLine line(prompt());
  line.command(along(2));
  REQUIRE(line.mean_force(0, 0.25) == along(2));
  REQUIRE(line.mean_force(0.25, 1) == along(2));
}

TEST_CASE("A force that is so many ticks late acts so many ticks later, and none before") {
  for (int delay = 0; delay <= 9; ++delay) {
    ActuatorSettings settings = prompt();
    settings.force_cap = 1e9;
    settings.delay_ticks = delay;
    const std::vector<double> means = counted(settings, 80);
    for (int i = 0; i < 80; ++i) {
      REQUIRE(means[static_cast<std::size_t>(i)] == std::max(0, i + 1 - delay));
    }
  }
}

TEST_CASE("A fraction of a tick's delay acts within the tick, wherever the substeps lie") {
  for (const double delay : {0.25, 0.5, 1.37, 3.999, 31.5}) {
    ActuatorSettings settings = prompt();
    settings.force_cap = 1e9;
    settings.delay_ticks = delay;
    const double fraction = delay - std::floor(delay);
    const std::vector<double> means = counted(settings, 100);
    for (int i = 40; i < 100; ++i) {
      const double newest = i + 1 - std::floor(delay);
      REQUIRE(means[static_cast<std::size_t>(i)] == Approx(newest - fraction).epsilon(1e-12));
    }
    ActuatorLine fine(settings);
    for (int i = 1; i <= 100; ++i) {
      fine.command(along(i));
      double sum = 0;
      for (int part = 0; part < 7; ++part) {
        sum += fine.mean_force(part / 7.0, (part + 1) / 7.0).y() / 7;
      }
      REQUIRE(sum == Approx(means[static_cast<std::size_t>(i - 1)]).epsilon(1e-12));
    }
  }
}

TEST_CASE("No more than the cap acts, in the direction that was asked for") {
  ActuatorLine line(prompt());
  line.command({30, 0, 40});
  REQUIRE((line.mean_force(0, 1) - Vector3(6, 0, 8)).norm() < 1e-12);
}

TEST_CASE("A bandwidth makes the actuator a first-order lag, but for 0 and infinity") {
  ActuatorSettings settings = prompt();
  settings.bandwidth = 200;
  const double lag = 1 / (2 * std::numbers::pi * settings.bandwidth);
  ActuatorLine line(settings);
  line.command(along(1));
  double integral = 0;
  for (int part = 0; part < 5; ++part) {
    integral += line.mean_force(part / 5.0, (part + 1) / 5.0).y() * period / 5;
  }
  REQUIRE(integral == Approx(period - lag * (1 - std::exp(-period / lag))).epsilon(1e-12));
  for (const double none : {0.0, std::numeric_limits<double>::infinity()}) {
    settings.bandwidth = none;
    ActuatorLine stiff(settings);
    stiff.command(along(1));
    REQUIRE(stiff.mean_force(0, 1e-3) == along(1));
  }
}

TEST_CASE("A lost force leaves the last one, as often as its share says") {
  for (const double share : {0.0, 0.05, 0.5, 1.0}) {
    ActuatorSettings settings = prompt();
    settings.force_cap = 1e9;
    settings.lost_share = share;
    settings.seed = 3;
    constexpr int ticks = 20000;
    const std::vector<double> means = counted(settings, ticks);
    int lost = 0;
    double last = 0;
    for (int i = 0; i < ticks; ++i) {
      const double now = means[static_cast<std::size_t>(i)];
      const bool held = now == last;
      REQUIRE((held || now == i + 1));
      lost += held ? 1 : 0;
      last = now;
    }
    REQUIRE(lost == Approx(share * ticks).margin(4 * std::sqrt(share * (1 - share) * ticks)));
  }
}

TEST_CASE("Jitter moves arrivals about the delay, keeps their order and never brings one early") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    ActuatorSettings settings = prompt();
    settings.force_cap = 1e9;
    settings.delay_ticks = 1;
    settings.jitter = 0.3e-3;
    settings.seed = seed;
    ActuatorLine line(settings);
    double last = 0, late = 0;
    constexpr int parts = 20;
    for (int tick = 1; tick <= 1000; ++tick) {
      line.command(along(tick));
      for (int part = 0; part < parts; ++part) {
        const double now = line.mean_force(part / 20.0, (part + 1) / 20.0).y();
        REQUIRE(now >= last - 1e-9);
        REQUIRE(now <= tick + 1e-9);
        last = now;
        late += tick + part / 20.0 - now;
      }
    }
    // On average a held ramp is late by the delay and half a tick, less half a part.
    const double mean = late / (1000 * parts);
    REQUIRE(mean > 1.475 - 0.05);
    REQUIRE(mean < 1.475 + 0.05);
  }
}

TEST_CASE("The luck of a line comes from its seed alone") {
  ActuatorSettings settings = prompt();
  settings.jitter = 0.2e-3;
  settings.lost_share = 0.1;
  settings.delay_ticks = 1;
  REQUIRE(counted(settings, 500) == counted(settings, 500));
  ActuatorSettings other = settings;
  other.seed = 2;
  REQUIRE(counted(settings, 500) != counted(other, 500));
  ActuatorLine line(settings);
  line.command(along(3));
  line.reset();
  REQUIRE(line.mean_force(0, 1) == Vector3::Zero());
}

}  // namespace actuator_line_test
