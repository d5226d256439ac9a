// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/model/query_sets.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "baker/base/bake_error.hpp"
#include "common/base/random.hpp"

namespace spm::bench {
namespace {

constexpr double step_length = 0.1e-3;  // m
constexpr double swing_steps = 400;     // steps per swing of the depth, there and back
constexpr double largest_turn = 0.05;   // rad a step
constexpr double free_height = 20e-6;   // m above the surface; a proxy is put there
constexpr std::size_t max_refusals = 40;
constexpr std::size_t max_tries = 200;  // steps tried per wanted step

/// A place on the free side of the surface, beside the closest point of the true place.
Vector3 free_place(const Model& model, const TruePlace& truth) {
  Vector3 outward = truth.place.outward;
  if (outward.isZero()) outward = model.truth.closest(truth.place.point).normal;
  return truth.closest_point + free_height * outward;
}

/// The contact that moves over the surface, and the hand that moves with it.
class Walk {
 public:
  Walk(const Model& model, double low, double high, std::uint64_t seed)
      : model_(model), low_(low), high_(high), seed_(seed) {
    restart();
  }

  /// One step of the hand.
  Vector3 step() {
    const double swing = 0.5 + 0.49 * std::cos(2 * std::numbers::pi * phase_ / swing_steps);
    const double height = low_ + (high_ - low_) * swing;
    const Vector3 goal = contact_.position + height * contact_.normal;
    const Vector3 move = goal - hand_;
    const double length = move.norm();
    hand_ += move * std::min(1.0, step_length / std::max(length, 1e-12));
    phase_ += 1;
    // The contact waits for the hand if a corner moves the hand's goal far away.
    if (length < 2 * step_length) advance();
    return hand_;
  }

  void restart() {
    const double choice = unit(), a = unit(), b = unit();
    contact_ = model_.truth.at(choice, a, b);
    heading_ = contact_.normal.unitOrthogonal();
    phase_ = 0;
    hand_ = contact_.position + high_ * contact_.normal;
  }

 private:
  double unit() { return random_unit(seed_, drawn_++); }

  void advance() {
    const double turn = largest_turn * (2 * unit() - 1);
    heading_ += turn * contact_.normal.cross(heading_);
    heading_ -= heading_.dot(contact_.normal) * contact_.normal;
    if (heading_.norm() < 1e-6) heading_ = contact_.normal.unitOrthogonal();
    heading_.normalize();
    const Vector3 before = contact_.position;
    contact_ = model_.truth.closest(before + step_length * heading_);
    // In a groove the contact would stand still: turn to leave along the groove.
    if ((contact_.position - before).norm() < 0.2 * step_length) {
      heading_ = contact_.normal.cross(heading_);
    }
  }

  const Model& model_;
  double low_, high_;
  std::uint64_t seed_;
  std::uint64_t drawn_ = 0;
  baker::SurfacePoint contact_;
  Vector3 heading_ = Vector3::UnitX();
  Vector3 hand_ = Vector3::Zero();
  double phase_ = 0;
};

}  // namespace

WalkedPath walk_surface(const Model& model, double low, double high, std::size_t steps,
                        std::uint64_t seed) {
  Walk walk(model, low, high, random_bits(seed, 0x77616C6B));
  WalkedPath path;
  bool fresh = true;
  std::size_t refused = 0;
  for (std::size_t tried = 0; path.steps.size() < steps; ++tried) {
    if (tried > max_tries * steps) {
      throw baker::BakeError(ExitCode::invalid_input,
                             model.mesh.path +
                                 ": its surface is too small, or too full of holes, "
                                 "for a path over it");
    }
    const TruePlace truth = truth_at(model, walk.step());
    if (!truth.judged) {
      fresh = true;
      if (++refused < max_refusals) continue;
      refused = 0;
      walk.restart();
      continue;
    }
    path.steps.push_back({truth.place.point, free_place(model, truth), fresh});
    path.places.places.push_back(truth.place);
    fresh = false;
  }
  return path;
}

std::vector<TimedPlace> random_places(const Model& model, const Places& places, std::size_t count) {
  std::vector<TimedPlace> result;
  for (std::size_t i = 0; i < std::min(count, places.places.size()); ++i) {
    const TruePlace truth = truth_at(model, places.places[i].point);
    result.push_back({truth.place.point, free_place(model, truth), true});
  }
  return result;
}

}  // namespace spm::bench
