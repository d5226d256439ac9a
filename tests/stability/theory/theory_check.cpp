// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/theory/theory_check.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/random.hpp"
#include "servo/devices/sim/sim_plant.hpp"
#include "tests/stability/theory/passivity_adversary.hpp"

namespace spm::stability {
namespace {

constexpr double seconds = 4;  // of a run: the hand's own swing has died in the first quarter
constexpr double searched = 0.2;
constexpr double found_share = 1e-7;
constexpr int max_rounds = 60;
constexpr double edge_share = 1e-5;  // of an encoder step: viscous losses count for nothing
constexpr double min_border = 100, max_border = 50e3;  // N/m

double logarithmic(Random& random, double low, double high) {
  return low * std::pow(high / low, random.between(0, 1));
}

/// One of so many, evenly.
std::size_t one_of(Random& random, std::size_t count) { return random.next() % count; }

/// Energy of a swing over some ticks, its ends faded out so that their phase does not count.
double faded_energy(const std::vector<double>& speeds, std::size_t begin, std::size_t end) {
  double sum = 0;
  const auto length = static_cast<double>(end - begin);
  for (std::size_t i = begin; i < end; ++i) {
    const double fade =
        std::sin(std::numbers::pi * (static_cast<double>(i - begin) + 0.5) / length);
    sum += fade * fade * speeds[i] * speeds[i];
  }
  return sum;
}

servo::SimPlant plant_of(const SampledLoop& loop) {
  servo::PlantSettings settings;
  settings.profile = {"linear",
                      loop.mass,
                      loop.device_damping,
                      0,
                      0,
                      std::numeric_limits<double>::infinity(),
                      loop.lag > 0 ? 1 / (2 * std::numbers::pi * loop.lag) : 0};
  settings.period = loop.period;
  settings.hand = loop.hand;
  settings.delay_ticks = loop.delay_ticks;
  settings.encoder_step = 0;
  settings.substeps = servo::substeps_for(loop.period);
  return servo::SimPlant(settings);
}

/// Growth of the plant's swing a tick, as the logarithm of its amplitude.
double growth(const SampledLoop& loop, double stiffness) {
  servo::SimPlant plant = plant_of(loop);
  plant.place({1e-3, 0, 0});
  const auto ticks = static_cast<std::size_t>(seconds / loop.period);
  const double kept =
      loop.filter > 0 ? std::exp(-2 * std::numbers::pi * loop.filter * loop.period) : 0;
  std::vector<double> speeds;
  speeds.reserve(ticks);
  double last = plant.position().x(), velocity = 0;
  for (std::size_t i = 0; i < ticks; ++i) {
    const double depth = plant.measured_position().x();
    velocity = kept * velocity + (1 - kept) * (depth - last) / loop.period;
    last = depth;
    plant.step({-stiffness * depth - loop.damping * velocity, 0, 0}, {});
    speeds.push_back(plant.velocity().x());
  }
  const double early = faded_energy(speeds, ticks / 4, ticks / 2);
  const double late = faded_energy(speeds, ticks - ticks / 4, ticks);
  // A swing that left the range of numbers grew or died for certain.
  if (!std::isfinite(late)) return 1;
  if (!(late > 0)) return -1;
  return std::log(late / early) / static_cast<double>(ticks);
}

std::string words_of(const SampledLoop& loop) {
  static constexpr std::array<const char*, 3> hands{"spring", "arm", "none"};
  return fmt::format(
      "m {:.3f} b {:.2f} T {:g} ms d {:.2f} B {:.2f} filter {:.0f} Hz lag {:.2f} ms "
      "hand {}",
      loop.mass, loop.device_damping, 1e3 * loop.period, loop.delay_ticks, loop.damping,
      loop.filter, 1e3 * loop.lag, hands[static_cast<std::size_t>(loop.hand)]);
}

SampledLoop drawn_loop(Random& random) {
  constexpr std::array periods{0.25e-3, 0.5e-3, 1e-3, 2e-3};
  SampledLoop loop;
  loop.mass = logarithmic(random, 0.045, 0.5);
  loop.device_damping = logarithmic(random, 0.05, 3);
  loop.period = periods[one_of(random, periods.size())];
  loop.delay_ticks = random.between(0, 4);
  if (one_of(random, 2) == 0) loop.delay_ticks = std::round(loop.delay_ticks);
  if (one_of(random, 2) == 0) loop.damping = logarithmic(random, 0.1, 4);
  if (one_of(random, 2) == 0) loop.filter = logarithmic(random, 30, 300);
  if (one_of(random, 3) != 0) loop.lag = logarithmic(random, 0.2e-3, 1e-3);
  constexpr std::array hands{servo::HandModel::none, servo::HandModel::spring,
                             servo::HandModel::arm};
  loop.hand = hands[one_of(random, hands.size())];
  return loop;
}

/// The field's formula beside the exact eigenvalue, with a mass that is large beside b T.
TheoryRow approximation_row(Random& random, bool is_damped) {
  SampledLoop loop;
  loop.mass = logarithmic(random, 0.1, 0.5);
  loop.device_damping = logarithmic(random, 0.1, 2);
  loop.delay_ticks = static_cast<double>(one_of(random, 5));
  if (is_damped) {
    loop.damping = logarithmic(random, 0.1, 2);
    loop.filter = logarithmic(random, 30, 300);
  }
  return {is_damped ? "(b + B) / (T/2 + t_d), B > 0" : "(b + B) / (T/2 + t_d), B = 0",
          "approximation",
          words_of(loop),
          approximate_border(loop),
          border_stiffness(loop, 10),
          "N/m"};
}

TheoryRow undamped_row(Random& random) { return approximation_row(random, false); }
TheoryRow damped_row(Random& random) { return approximation_row(random, true); }

std::string words_of(const AdversaryBoard& board) {
  return fmt::format("b {:.2f} B {:.2f} d {:.0f} f_c {:.3f} N D {:.0f} um",
                     board.loop.device_damping, board.loop.damping, board.loop.delay_ticks,
                     board.friction, 1e6 * board.encoder_step);
}

TheoryRow passivity_row(const char* name, const AdversaryBoard& board, double expected,
                        const std::vector<ClosedMotion>& motions) {
  return {name,
          "passivity",
          words_of(board),
          expected,
          drawn_border(board, motions, expected / 3, expected * 3),
          "N/m"};
}

TheoryRow hold_row(Random& random) {
  AdversaryBoard board;
  board.loop.device_damping = logarithmic(random, 0.1, 3);
  board.loop.damping = random.between(0, 0.9) * board.loop.device_damping;
  std::vector<ClosedMotion> motions;
  for (int i = 0; i < 3; ++i) {
    motions.push_back(alternating_motion(logarithmic(random, 1e-6, 1e-3), random.between(0, 1e-3)));
  }
  motions.push_back(slow_motion(1e-3, 40));
  return passivity_row("b > K T/2 + B", board, passive_border(board.loop), motions);
}

TheoryRow delay_row(Random& random) {
  AdversaryBoard board;
  board.loop.device_damping = logarithmic(random, 0.1, 3);
  board.loop.delay_ticks = static_cast<double>(1 + one_of(random, 4));
  return passivity_row(
      "b > K T (1/2 + d)", board, delayed_passive_border(board.loop),
      {alternating_motion(1e-4, 0), slow_motion(1e-3, 40), slow_motion(1e-3, 600)});
}

TheoryRow encoder_row(Random& random) {
  AdversaryBoard board;
  board.loop.device_damping = logarithmic(random, 0.3, 3);
  board.friction = logarithmic(random, 0.02, 0.5);
  board.encoder_step = logarithmic(random, 9e-6, 100e-6);
  // So far that friction and the last encoder step count for nothing beside the viscous losses.
  const double far = 5000 * std::max(board.encoder_step, board.friction * board.loop.period /
                                                             board.loop.device_damping);
  const int edge = static_cast<int>(one_of(random, 20)) - 10;
  return passivity_row(
      "K <= min(2 b / T, 2 f_c / D)", board,
      quantised_passive_border(board.loop, board.friction, board.encoder_step),
      {edge_motion(board.encoder_step, edge_share, edge), alternating_motion(far, 0)});
}

}  // namespace

double simulated_border(const SampledLoop& loop, double guess) {
  double low = guess * (1 - searched), high = guess * (1 + searched);
  double below = growth(loop, low), above = growth(loop, high);
  if (!(below < 0 && above > 0)) return std::numeric_limits<double>::quiet_NaN();
  // Regula falsi; a side that stays twice counts half (the Illinois rule).
  int stayed = 0;
  for (int round = 0; round < max_rounds && high - low > found_share * guess; ++round) {
    const double middle = low + (high - low) * below / (below - above);
    const double now = growth(loop, middle);
    if (now < 0) {
      if (middle - low < found_share * guess) return middle;
      low = middle;
      below = now;
      if (stayed == 1) above /= 2;
      stayed = 1;
    } else {
      if (high - middle < found_share * guess) return middle;
      high = middle;
      above = now;
      if (stayed == -1) below /= 2;
      stayed = -1;
    }
  }
  return (low + high) / 2;
}

std::vector<SampledLoop> drawn_loops(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<SampledLoop> loops;
  while (static_cast<int>(loops.size()) < count) {
    SampledLoop loop = drawn_loop(random);
    loop.stiffness = border_stiffness(loop, 10, 2 * max_border);
    if (loop.stiffness > min_border && loop.stiffness < max_border) loops.push_back(loop);
  }
  return loops;
}

std::vector<TheoryRow> validate_plant(int count, std::uint64_t seed) {
  const std::vector<SampledLoop> loops = drawn_loops(count, seed);
  std::vector<TheoryRow> rows(loops.size());
  tbb::parallel_for(std::size_t{0}, loops.size(), [&](std::size_t i) {
    const SampledLoop& loop = loops[i];
    rows[i] = {"eigenvalue",
               "stability",
               words_of(loop),
               loop.stiffness,
               simulated_border(loop, loop.stiffness),
               "N/m"};
  });
  return rows;
}

std::vector<TheoryRow> validate_formulas(int count, std::uint64_t seed) {
  const auto each = static_cast<std::size_t>(count);
  constexpr std::array kinds{hold_row, delay_row, encoder_row, undamped_row, damped_row};
  std::vector<TheoryRow> rows(kinds.size() * each);
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
    Random random(seed + i);
    rows[i] = kinds[i / each](random);
  });
  return rows;
}

TheoryErrors errors_of(const std::vector<TheoryRow>& rows) {
  TheoryErrors errors;
  for (const TheoryRow& row : rows) {
    const double off = std::abs(row.off());
    // What was not found is as wrong as can be.
    errors.largest = std::isfinite(off) ? std::max(errors.largest, off) : INFINITY;
    errors.rms += off * off;
  }
  if (!rows.empty()) errors.rms = std::sqrt(errors.rms / static_cast<double>(rows.size()));
  return errors;
}

}  // namespace spm::stability
