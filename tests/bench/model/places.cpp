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
  std::uint64_t near_holes = 0;
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
    if (truth.near_hole) ++result.near_holes;
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
  truth.closest_point = model.truth.closest(point).position;
  const double distance = (point - truth.closest_point).norm();
  const double side = model.truth.inside(point) ? -1 : 1;
  place.distance = side * distance;
  if (place.distance < -model.band.max_depth || place.distance > model.band.margin) return truth;
  truth.near_hole =
      model.truth.border_distance(truth.closest_point) < hole_share * model.mesh.diagonal;
  truth.judged = !truth.near_hole;
  if (truth.judged && distance >= min_distance &&
      !model.truth.contested(point, truth.closest_point, 2 * model.tolerance)) {
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
  std::uint64_t near_holes = 0, contested = 0;
  for (const Draw& one : draws) {
    near_holes += one.near_holes;
    if (!one.found) continue;
    contested += one.place.outward.isZero() ? 1 : 0;
    result.places.push_back(one.place);
  }
  if (result.places.empty()) {
    throw baker::BakeError(ExitCode::invalid_input,
                           model.mesh.path +
                               ": no place to measure: everywhere is within 3 % of the diagonal of "
                               "a border edge; close the mesh's holes");
  }
  const auto kept = static_cast<double>(result.places.size());
  result.contested = static_cast<double>(contested) / kept;
  result.near_holes = static_cast<double>(near_holes) / (static_cast<double>(near_holes) + kept);
  return result;
}

}  // namespace spm::bench
