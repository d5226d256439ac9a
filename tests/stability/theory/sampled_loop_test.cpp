// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/theory/sampled_loop.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/base/random.hpp"
#include "tests/stability/theory/theory_check.hpp"

namespace sampled_loop_test {

using namespace spm::stability;
using spm::Random;
using spm::servo::HandModel;

TEST_CASE("Without a wall the eigenvalues are those of the continuous oscillator over a tick") {
  SampledLoop loop;
  loop.stiffness = 0;
  loop.mass = 0.2;
  loop.device_damping = 0.4;
  loop.hand = HandModel::spring;
  const double decay = (0.4 + spm::servo::grip_damping) / (2 * 0.2);
  REQUIRE(spectral_radius(loop) == Approx(std::exp(-decay * loop.period)).epsilon(1e-12));
}

TEST_CASE("A free mass is at the edge of stability, with whatever delay and lag") {
  for (const double delay : {0.0, 0.3, 2.0, 5.7}) {
    SampledLoop loop;
    loop.stiffness = 0;
    loop.delay_ticks = delay;
    loop.device_damping = 0.5;
    loop.lag = 0.3e-3;
    REQUIRE(spectral_radius(loop) == Approx(1).epsilon(1e-9));
  }
}

TEST_CASE("A held spring on an undamped mass grows, as the closed form of its map says") {
  SampledLoop loop;
  loop.mass = 0.1;
  loop.stiffness = 500;
  // x'' = -K x_k / m over the tick: determinant of the map 1 + K T^2 / (2 m).
  const double determinant = 1 + 500 * 1e-6 / 0.2;
  REQUIRE(spectral_radius(loop) == Approx(std::sqrt(determinant)).epsilon(1e-9));
  REQUIRE(border_stiffness(loop) == 0);
}

TEST_CASE("The border of a damped mass without delay is that of its characteristic polynomial") {
  // Jury's criterion on z^2 - tr z + det of the map of m x'' + b x' = -K x_k.
  for (const double damping : {0.1, 1.0, 4.0}) {
    SampledLoop loop;
    loop.mass = 0.1;
    loop.device_damping = damping;
    const double rate = damping / loop.mass, period = loop.period;
    const double kept = std::exp(-rate * period);
    const double moved = (1 - kept) / rate;           // of a speed's way, s
    const double place = (period - moved) / damping;  // x_(k+1) a force
    const double speed = (1 - kept) / damping;        // v_(k+1) a force
    // det = (1 - K place) kept + K moved speed = 1.
    const double border = (1 - kept) / (moved * speed - kept * place);
    REQUIRE(border_stiffness(loop) == Approx(border).epsilon(1e-7));
  }
}

TEST_CASE("A whole tick's delay is the limit of fractional ones from both sides") {
  for (const SampledLoop& drawn : drawn_loops(10, 3)) {
    SampledLoop loop = drawn;
    loop.delay_ticks = 2;
    const double exact = spectral_radius(loop);
    loop.delay_ticks = 2 - 1e-9;
    REQUIRE(spectral_radius(loop) == Approx(exact).epsilon(1e-6));
    loop.delay_ticks = 2 + 1e-9;
    REQUIRE(spectral_radius(loop) == Approx(exact).epsilon(1e-6));
  }
}

TEST_CASE("Just below its border a loop is stable, just above it is not") {
  for (const SampledLoop& drawn : drawn_loops(50, 4)) {
    SampledLoop loop = drawn;
    loop.stiffness = 0.999 * drawn.stiffness;
    REQUIRE(spectral_radius(loop) < 1);
    loop.stiffness = 1.001 * drawn.stiffness;
    REQUIRE(spectral_radius(loop) > 1);
  }
}

TEST_CASE("A very fast lag and filter change nothing") {
  SampledLoop plain;
  plain.device_damping = 0.3;
  plain.damping = 0.2;
  plain.delay_ticks = 1;
  plain.hand = HandModel::arm;
  SampledLoop fast = plain;
  fast.lag = 1e-7;
  fast.filter = 1e6;
  REQUIRE(border_stiffness(fast) == Approx(border_stiffness(plain)).epsilon(1e-3));
}

TEST_CASE("The approximate formula is within 7 % without virtual damping, and far off with it") {
  double furthest = 0;
  for (const TheoryRow& row : validate_formulas(40, 5)) {
    if (row.kind != "approximation") continue;
    CAPTURE(row.criterion, row.settings, row.expected, row.measured);
    const double off = row.expected / row.measured - 1;
    if (row.criterion.find("B = 0") != std::string::npos) {
      REQUIRE(std::abs(off) < 0.07);
    } else {
      furthest = std::max(furthest, off);
    }
  }
  REQUIRE(furthest > 0.2);
}

TEST_CASE("The formulas give the figures of their texts") {
  SampledLoop loop;
  loop.device_damping = 0.3;
  loop.delay_ticks = 1;
  REQUIRE(approximate_border(loop) == Approx(200));
  REQUIRE(delayed_passive_border(loop) == Approx(200));
  loop.damping = 0.1;
  REQUIRE(passive_border(loop) == Approx(400));
  loop.damping = 0.4;
  REQUIRE(passive_border(loop) == 0);
  REQUIRE(quantised_passive_border(loop, 0.02, 100e-6) == Approx(400));
  REQUIRE(quantised_passive_border(loop, 0.02, 10e-6) == Approx(600));
}

TEST_CASE("Virtual damping raises the border of stability and lowers that of passivity") {
  SampledLoop loop;
  loop.device_damping = 0.5;
  SampledLoop damped = loop;
  damped.damping = 0.2;
  REQUIRE(border_stiffness(damped) > 1.1 * border_stiffness(loop));
  REQUIRE(passive_border(damped) < 0.9 * passive_border(loop));
}

}  // namespace sampled_loop_test
