// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>
#include <cmath>

#include "common/base/random.hpp"
#include "tests/stability/theory/passivity_adversary.hpp"
#include "tests/stability/theory/theory_check.hpp"

namespace adversary_test {

using namespace spm::stability;
using spm::Random;

namespace {

/// A closed motion as luck has it: steps of any size, of one sign or another, or slow and smooth.
ClosedMotion any_motion(Random& random) {
  ClosedMotion motion;
  const int ticks = 2 + static_cast<int>(random.next() % 60);
  const double size = std::pow(10.0, random.between(-7, -2));
  const double pull = random.between(0, 1);
  double at = random.between(-1e-3, 1e-3);
  for (int i = 0; i < ticks; ++i) {
    motion.push_back(at);
    at += size * random.between(-1, 1) - pull * (at - motion.front());
  }
  return motion;
}

AdversaryBoard board_of(Random& random, bool delayed, bool quantised) {
  AdversaryBoard board;
  board.loop.device_damping = random.between(0.1, 3);
  if (delayed) {
    board.loop.delay_ticks = static_cast<double>(1 + random.next() % 4);
  } else if (!quantised) {
    board.loop.damping = random.between(0, 0.9) * board.loop.device_damping;
  }
  if (quantised) {
    board.friction = random.between(0.02, 0.5);
    board.encoder_step = random.between(9e-6, 100e-6);
  }
  return board;
}

double border_of(const AdversaryBoard& board) {
  if (board.encoder_step > 0) {
    return quantised_passive_border(board.loop, board.friction, board.encoder_step);
  }
  return board.loop.delay_ticks > 0 ? delayed_passive_border(board.loop)
                                    : passive_border(board.loop);
}

}  // namespace

TEST_CASE("Each passivity formula is reached by its adversary to 0.5 %") {
  for (const TheoryRow& row : validate_formulas(20, 11)) {
    if (row.kind != "passivity") continue;
    CAPTURE(row.criterion, row.settings, row.expected, row.measured);
    CHECK(std::abs(row.off()) < 0.005);
  }
}

TEST_CASE("No hand draws energy from a wall a hair below the border of passivity") {
  for (const bool delayed : {false, true}) {
    for (const bool quantised : {false, true}) {
      if (delayed && quantised) continue;
      for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        Random random(seed);
        AdversaryBoard board = board_of(random, delayed, quantised);
        board.loop.stiffness = 0.999 * border_of(board);
        for (int i = 0; i < 20; ++i) {
          const ClosedMotion motion = any_motion(random);
          const double drawn = energy_drawn(board, motion);
          CAPTURE(delayed, quantised, seed, i);
          REQUIRE(drawn <= 1e-15);
        }
      }
    }
  }
}

TEST_CASE("A motion that stays draws nothing, whatever the wall") {
  AdversaryBoard board;
  board.loop.stiffness = 1e5;
  REQUIRE(energy_drawn(board, {1e-3}) == 0);
  REQUIRE(energy_drawn(board, {1e-3, 1e-3, 1e-3}) == 0);
}

TEST_CASE("What an alternating hand draws is the closed form's energy") {
  AdversaryBoard board;
  board.loop.device_damping = 0.3;
  board.loop.damping = 0.1;
  board.loop.stiffness = 2000;
  // Two ticks, each a way of 2 A under K A + 2 B A / T, less b (2 A)^2 / T.
  const double size = 1e-4, period = board.loop.period;
  const double a_tick =
      2 * size * (2000 * size + 2 * 0.1 * size / period) - 0.3 * 4 * size * size / period;
  REQUIRE(energy_drawn(board, alternating_motion(size, 3e-4)) == Approx(2 * a_tick).epsilon(1e-9));
}

TEST_CASE("Motions that do not reach the border give none") {
  AdversaryBoard board;
  board.loop.device_damping = 0.3;
  const double border = passive_border(board.loop);
  REQUIRE(drawn_border(board, {alternating_motion(1e-4, 0)}, 2 * border, 3 * border) == 0);
  REQUIRE(drawn_border(board, {alternating_motion(1e-4, 0)}, border / 3, border / 2) == 0);
}

}  // namespace adversary_test
