// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/velocity_estimate.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace spm::velocity_estimate_test {
namespace {

constexpr double tick = 1e-3;
constexpr double step = 1e-4;

double counted(double position) { return step * std::round(position / step); }

/// The definition, window by window: the positions end now, m; m a tick.
double by_definition(const std::vector<double>& positions) {
  const std::size_t count = std::min(positions.size(), VelocityEstimate::max_ticks);
  const auto ago = [&](std::size_t ticks) { return positions[positions.size() - 1 - ticks]; };
  double slope = 0;
  for (std::size_t ticks = 1; ticks < count; ++ticks) {
    const double tried = (ago(0) - ago(ticks)) / static_cast<double>(ticks);
    for (std::size_t k = 1; k < ticks; ++k) {
      if (std::abs(ago(0) - tried * static_cast<double>(k) - ago(k)) > step) return slope;
    }
    slope = tried;
  }
  return slope;
}

TEST_CASE("The velocity is that of the longest straight window, to the bit") {
  std::mt19937_64 random(3);
  std::normal_distribution<double> push(0, 1);
  for (const double size : {1e-6, 2e-5, 2e-4, 2e-3}) {
    VelocityEstimate estimate(step, tick);
    std::vector<double> positions;
    double place = 0, speed = 0;
    for (int i = 0; i < 3000; ++i) {
      speed = 0.97 * speed + size * push(random);
      place += speed;
      positions.push_back(counted(place));
      const double told = estimate.next({positions.back(), 0, 0}).x();
      REQUIRE(told == by_definition(positions) / tick);
    }
  }
}

TEST_CASE("By difference the last two positions tell it alone") {
  VelocityEstimate estimate(step, tick, VelocityMethod::difference);
  CHECK(estimate.next({1, 0, 0}).x() == 0);
  CHECK(estimate.next({1 + step, 0, 0}).x() == Approx(step / tick));
  CHECK(estimate.next({1 + step, 0, 0}).x() == 0);
}

TEST_CASE("A steady motion is told from counts without the noise of a count a tick") {
  for (const double velocity : {0.0, 0.001, 0.02, -0.1, 0.5}) {
    VelocityEstimate estimate(step, tick);
    double worst = 0, naive = 0, last = 0;
    for (int i = 0; i < 400; ++i) {
      const double position = counted(velocity * tick * i + 3e-5);
      const double told = estimate.next({position, -2 * position, 0}).x();
      if (i >= 64) {
        worst = std::max(worst, std::abs(told - velocity));
        naive = std::max(naive, std::abs((position - last) / tick - velocity));
      }
      last = position;
    }
    INFO("at " << velocity << " m/s: off by " << worst << ", a difference by " << naive);
    // Two counts over the window.
    CHECK(worst <= 2 * step / (VelocityEstimate::max_ticks - 1) / tick);
    if (velocity == 0.02) CHECK(worst < naive / 8);
  }
}

TEST_CASE("Fast motion that turns round is told within a few ticks") {
  VelocityEstimate estimate(step, tick);
  double position = 0;
  for (int i = 0; i < 100; ++i) (void)estimate.next({counted(position += 0.5 * tick), 0, 0});
  double told = 0;
  for (int i = 0; i < 4; ++i) told = estimate.next({counted(position -= 0.5 * tick), 0, 0}).x();
  CHECK(told < -0.4);
}

TEST_CASE("Each axis has a window of its own") {
  VelocityEstimate estimate(step, tick);
  Vector3 told = Vector3::Zero();
  for (int i = 0; i < 100; ++i) {
    told = estimate.next({counted(0.05 * tick * i), counted(2e-4 * std::sin(0.9 * i)), 0});
  }
  CHECK(told.x() == Approx(0.05).margin(0.007));
  CHECK(told.z() == 0);
}

TEST_CASE("Beyond a step a tool between two counts rests, and one that goes on is told as it is") {
  VelocityEstimate estimate(step, tick);
  for (int i = 0; i < 100; ++i) {
    (void)estimate.next({(i / 3) % 2 == 0 ? 0 : step, 0, 0});
    if (i > 2) CHECK(std::abs(estimate.beyond(1).x()) == 0);
  }
  estimate.reset();
  for (int i = 0; i < 100; ++i) (void)estimate.next({counted(0.02 * tick * i), 0, 0});
  CHECK(estimate.velocity().x() == Approx(0.02).epsilon(0.2));
  CHECK(estimate.beyond(1).x() == estimate.velocity().x());
  // Between one and two steps in the window, the result is less, and it does not jump.
  for (const double steps : {1.0, 1.001, 1.5, 1.999, 2.0}) {
    VelocityEstimate two(step, tick);
    (void)two.next(Vector3::Zero());
    (void)two.next({steps * step, 0, 0});
    CHECK(two.beyond(1).x() == Approx(2 * (steps - 1) * step / tick).margin(1e-12));
  }
  CHECK(estimate.beyond(0).x() == estimate.velocity().x());
}

TEST_CASE("A wider step that is allowed makes longer windows") {
  VelocityEstimate estimate(step, tick);
  for (int i = 0; i < 100; ++i) (void)estimate.next({i % 2 == 0 ? 0 : 2 * step, 0, 0});
  CHECK(std::abs(estimate.velocity().x()) == Approx(2 * step / tick));
  estimate.allow(2 * step);
  CHECK(std::abs(estimate.velocity().x()) < 0.1 * step / tick);
}

TEST_CASE("Ticks that were skipped count: a hand is no faster for them") {
  for (const double slack : {0.0, 20e-6}) {
    VelocityEstimate estimate(slack, 1e-3);
    for (int i = 0; i <= 10; ++i) (void)estimate.next({2e-4 * i, 0, 0});
    CHECK(estimate.next({2e-4 * 15, 0, 0}, 5).x() == Approx(0.2));
    CHECK(estimate.next({2e-4 * 115, 0, 0}, 100).x() == Approx(0).margin(1e-12));
    CHECK(estimate.next({2e-4 * 116, 0, 0}).x() == Approx(0.2));
  }
}

TEST_CASE("A position that is no number starts anew") {
  VelocityEstimate estimate(step, tick);
  for (int i = 0; i < 10; ++i) (void)estimate.next({1e-3 * i, 0, 0});
  CHECK(estimate.next({std::numeric_limits<double>::quiet_NaN(), 0, 0}).isZero());
  CHECK(estimate.next({5, 0, 0}).isZero());
  CHECK(estimate.next({5.001, 0, 0}).x() == Approx(1));
}

}  // namespace
}  // namespace spm::velocity_estimate_test
