// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/methods/score.hpp"

#include <tbb/parallel_for.h>

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

Outcome judge(const Answer& answer, const Model& model, const Place& place) {
  Outcome outcome;
  double distance = answer.distance;
  outcome.answered = std::isfinite(distance);
  if (answer.status == Status::far && place.distance >= model.band.margin - model.tolerance) {
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
  std::vector<Answer> answers(places.places.size());
  tbb::parallel_for(std::size_t{0}, answers.size(),
                    [&](std::size_t i) { answers[i] = method.query(places.places[i].point); });
  return score(answers, model, places);
}

Score score(std::span<const Answer> answers, const Model& model, const Places& places) {
  std::vector<Outcome> outcomes;
  outcomes.reserve(answers.size());
  for (std::size_t i = 0; i < answers.size(); ++i) {
    outcomes.push_back(judge(answers[i], model, places.places[i]));
  }
  std::vector<double> errors, angles;
  std::size_t clear = 0, wrong = 0;
  double squares = 0;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Outcome& outcome = outcomes[i];
    const double truth = places.places[i].distance;
    if (outcome.angle >= 0) angles.push_back(outcome.angle);
    if (std::abs(truth) > model.tolerance) {
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
