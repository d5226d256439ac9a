// SPDX-License-Identifier: Apache-2.0
#include "common/velocity_estimate.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

namespace spm {
namespace {

constexpr double tick = 1e-3;
constexpr double step = 1e-4;

double counted(double position) { return step * std::round(position / step); }

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
    CHECK(worst <= 2 * step / (VelocityEstimate::most_ticks - 1) / tick);
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

TEST_CASE("A position that is no number starts anew") {
  VelocityEstimate estimate(step, tick);
  for (int i = 0; i < 10; ++i) (void)estimate.next({1e-3 * i, 0, 0});
  CHECK(estimate.next({std::numeric_limits<double>::quiet_NaN(), 0, 0}).isZero());
  CHECK(estimate.next({5, 0, 0}).isZero());
  CHECK(estimate.next({5.001, 0, 0}).x() == Approx(1));
}

}  // namespace
}  // namespace spm
