// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/model/places.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <cstddef>

#include "baker/base/bake_error.hpp"
#include "common/base/random.hpp"

namespace spm::bench {
namespace {

constexpr double min_distance = 2e-6;  // m; closer, rounding destroys the direction
constexpr std::uint64_t max_draws = 256;

struct Draw {
  Place place;
  bool found = false;
};

Draw draw(const Model& model, std::uint64_t seed, std::uint64_t index) {
  const Band& band = model.band;
  Draw result;
  for (std::uint64_t attempt = 0; attempt < max_draws; ++attempt) {
    const std::uint64_t counter = 4 * (index * max_draws + attempt);
    const auto unit = [&](std::uint64_t i) { return random_unit(seed, counter + i); };
    const baker::SurfacePoint start = model.truth.at(unit(0), unit(1), unit(2));
    const Vector3 point =
        start.position +
        (-band.max_depth + (band.max_depth + band.margin) * unit(3)) * start.normal;
    const TruePlace truth = truth_at(model, point);
    if (!truth.judged) continue;
    result.place = truth.place;
    result.found = true;
    return result;
  }
  return result;
}

}  // namespace

TruePlace truth_at(const Model& model, const Vector3& point) {
  TruePlace truth;
  Place& place = truth.place;
  place.point = point;
  const baker::SurfacePoint closest = model.truth.closest(point);
  truth.closest_point = closest.position;
  const double distance = (point - truth.closest_point).norm();
  const double side = model.truth.inside(point) ? -1 : 1;
  place.distance = side * distance;
  if (place.distance < -model.band.max_depth || place.distance > model.band.margin) return truth;
  truth.judged = true;
  if (distance >= min_distance && !model.truth.contested(point, closest, 2 * model.tolerance)) {
    place.outward = side * (point - truth.closest_point) / distance;
  }
  return truth;
}

Places draw_places(const Model& model, std::uint64_t count, std::uint64_t seed) {
  // A separate seed makes these places differ from those that a bake tries and verifies.
  const std::uint64_t own = random_bits(seed, 0x62656E6368000000ULL);
  std::vector<Draw> draws(count);
  tbb::parallel_for(std::size_t{0}, draws.size(),
                    [&](std::size_t i) { draws[i] = draw(model, own, i); });
  Places result;
  std::uint64_t contested = 0;
  for (const Draw& one : draws) {
    if (!one.found) continue;
    contested += one.place.outward.isZero() ? 1 : 0;
    result.places.push_back(one.place);
  }
  if (result.places.empty()) {
    throw baker::BakeError(ExitCode::invalid_input,
                           model.mesh.path + ": no place to measure: none lies in the band");
  }
  result.contested = static_cast<double>(contested) / static_cast<double>(result.places.size());
  return result;
}

}  // namespace spm::bench
