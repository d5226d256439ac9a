// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/reading_noise.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace spm::reading_noise_test {
namespace {

constexpr double tick = 1e-3;

TEST_CASE("Noise of a reading is told as the step of an encoder that is off as much") {
  std::mt19937_64 random(5);
  for (const double deviation : {1e-6, 10e-6, 80e-6}) {
    std::normal_distribution<double> noise(0, deviation);
    ReadingNoise told;
    double sum = 0;
    constexpr int settled = 500, looked_at = 20000;
    for (int i = 0; i < settled + looked_at; ++i) {
      told.take({noise(random), 0, 0.05 * tick * i});
      if (i >= settled) sum += told.as_step();
    }
    CHECK(sum / looked_at == Approx(std::sqrt(12.0) * deviation).epsilon(0.08));
  }
}

TEST_CASE("A hand's motion is hardly taken for noise") {
  ReadingNoise told;
  for (int i = 0; i < 2000; ++i) {
    // 1 mm at 30 Hz: what a tool that shakes does.
    told.take({0, 1e-3 * std::sin(2 * std::numbers::pi * 30 * tick * i), 0.5 * tick * i});
    CHECK(told.as_step() < 1e-6);
  }
}

TEST_CASE("Too few readings, and readings that are no numbers, tell of no noise") {
  ReadingNoise told;
  for (const double place : {0.0, 1.0, -1.0, 1.0}) {
    told.take({place, 0, 0});
    CHECK(told.as_step() == 0);
  }
  told.take({-1, 0, 0});
  CHECK(told.as_step() > 0);
  told.take({0, std::numeric_limits<double>::quiet_NaN(), 0});
  CHECK(told.as_step() == 0);
}

}  // namespace
}  // namespace spm::reading_noise_test
