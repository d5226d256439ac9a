// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/methods/score.hpp"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "tests/bench/base/quantile.hpp"

namespace spm::bench {
namespace {

struct Outcome {
  bool answered = false;
  bool outside = false;
  double error = 0;
  double angle = -1;  ///< rad; negative if no direction is judged
};

Outcome judge(const Answer& answer, const Model& model, const Place& place, double tolerance) {
  Outcome outcome;
  double distance = answer.distance;
  outcome.answered = std::isfinite(distance);
  if (answer.status == Status::far && place.distance >= model.band.margin - tolerance) {
    outcome.answered = true;
    distance = model.band.margin;
  }
  outcome.outside = answer.status == Status::far || (outcome.answered && distance > 0);
  if (outcome.answered) outcome.error = std::abs(distance - place.distance);
  if (!place.outward.isZero() && !answer.normal.isZero()) {
    outcome.angle =
        std::atan2(answer.normal.cross(place.outward).norm(), answer.normal.dot(place.outward));
  }
  return outcome;
}

double share_of(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

}  // namespace

Score score(const Method& method, const Model& model, const Places& places) {
  std::vector<Answer> answers;
  answers.reserve(places.places.size());
  for (const Place& place : places.places) answers.push_back(method.query(place.point));
  const double own = method.facts().tolerance;
  return score(answers, model, places, own > 0 ? own : model.tolerance);
}

Score score(std::span<const Answer> answers, const Model& model, const Places& places,
            double tolerance) {
  std::vector<Outcome> outcomes;
  outcomes.reserve(answers.size());
  for (std::size_t i = 0; i < answers.size(); ++i) {
    outcomes.push_back(judge(answers[i], model, places.places[i], tolerance));
  }
  std::vector<double> errors, angles;
  std::size_t clear = 0, wrong = 0;
  double squares = 0;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Outcome& outcome = outcomes[i];
    const double truth = places.places[i].distance;
    if (outcome.angle >= 0) angles.push_back(outcome.angle);
    if (std::abs(truth) > tolerance) {
      ++clear;
      const bool judged = truth < 0 || outcome.answered;
      if (judged && outcome.outside != (truth > 0)) ++wrong;
    }
    if (!outcome.answered) continue;
    errors.push_back(outcome.error);
    squares += outcome.error * outcome.error;
  }
  Score result;
  result.misclassified = share_of(wrong, clear);
  result.unanswered = share_of(outcomes.size() - errors.size(), outcomes.size());
  if (!errors.empty()) result.rms = std::sqrt(squares / static_cast<double>(errors.size()));
  result.p50 = quantile(errors, 0.5);
  result.p99 = quantile(errors, 0.99);
  result.max = quantile(errors, 1);
  result.direction_p50 = quantile(angles, 0.5);
  result.direction_p99 = quantile(angles, 0.99);
  return result;
}

}  // namespace spm::bench
