// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/theory/passivity_adversary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "servo/devices/sim/sim_plant.hpp"

namespace spm::stability {
namespace {

constexpr double found_share = 1e-7;

servo::SimPlant plant_of(const AdversaryBoard& board) {
  servo::PlantSettings settings;
  settings.profile = {"adversary",
                      board.loop.mass,
                      board.loop.device_damping,
                      board.friction,
                      0,
                      std::numeric_limits<double>::infinity(),
                      0};
  settings.period = board.loop.period;
  settings.hand = servo::HandModel::none;
  settings.delay_ticks = board.loop.delay_ticks;
  settings.encoder_step = board.encoder_step;
  return servo::SimPlant(settings);
}

}  // namespace

double energy_drawn(const AdversaryBoard& board, const ClosedMotion& motion) {
  servo::SimPlant plant = plant_of(board);
  plant.place({motion.front(), 0, 0});
  double last = plant.measured_position().x();
  const auto round = [&] {
    double drawn = 0;
    for (std::size_t i = 0; i < motion.size(); ++i) {
      const double depth = plant.measured_position().x();
      const double rate = (depth - last) / board.loop.period;
      last = depth;
      const double wall = -board.loop.stiffness * depth - board.loop.damping * rate;
      const double to = motion[(i + 1) % motion.size()];
      drawn -= plant.carry({wall, 0, 0}, {to, 0, 0}).hand_work;
    }
    return drawn;
  };
  // Until the start is forgotten: the delay's forces and the first speed.
  const auto length = static_cast<double>(motion.size());
  const int rounds = 1 + static_cast<int>(std::ceil((board.loop.delay_ticks + 2) / length));
  for (int i = 0; i < rounds; ++i) (void)round();
  return round();
}

ClosedMotion alternating_motion(double amplitude, double depth) {
  return {depth - amplitude, depth + amplitude};
}

ClosedMotion edge_motion(double encoder_step, double share, int edge) {
  return alternating_motion(encoder_step * share / 2, encoder_step * (edge - 0.5));
}

ClosedMotion slow_motion(double amplitude, int ticks) {
  ClosedMotion motion;
  for (int i = 0; i < ticks; ++i) {
    motion.push_back(amplitude * std::cos(2 * std::numbers::pi * i / ticks));
  }
  return motion;
}

double drawn_border(AdversaryBoard board, const std::vector<ClosedMotion>& motions, double low,
                    double high) {
  const auto is_drawn = [&](double stiffness) {
    board.loop.stiffness = stiffness;
    return std::any_of(motions.begin(), motions.end(),
                       [&](const ClosedMotion& motion) { return energy_drawn(board, motion) > 0; });
  };
  if (is_drawn(low) || !is_drawn(high)) return 0;
  while (high / low - 1 > found_share) {
    const double middle = std::sqrt(low * high);
    (is_drawn(middle) ? high : low) = middle;
  }
  return std::sqrt(low * high);
}

}  // namespace spm::stability
