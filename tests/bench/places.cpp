// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/places.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <cstddef>

#include "baker/bake_error.hpp"
#include "baker/random.hpp"

namespace spm::bench {
namespace {

constexpr double hole_share = 0.03;      // of the diagonal
constexpr double least_distance = 2e-6;  // m; nearer the direction is lost in rounding
constexpr std::uint64_t most_draws = 256;

struct Draw {
  Place place;
  bool found = false;
  std::uint64_t near_holes = 0;
};

Draw draw(const Model& model, std::uint64_t seed, std::uint64_t index) {
  const Band& band = model.band;
  Draw result;
  for (std::uint64_t attempt = 0; attempt < most_draws; ++attempt) {
    const std::uint64_t counter = 4 * (index * most_draws + attempt);
    const auto unit = [&](std::uint64_t i) { return baker::random_unit(seed, counter + i); };
    const baker::SurfacePoint start = model.truth.at(unit(0), unit(1), unit(2));
    Place& place = result.place;
    place.point = start.position +
                  (-band.max_depth + (band.max_depth + band.margin) * unit(3)) * start.normal;
    const Vector3 foot = model.truth.closest(place.point).position;
    const double distance = (place.point - foot).norm();
    const double side = model.truth.inside(place.point) ? -1 : 1;
    place.distance = side * distance;
    if (place.distance < -band.max_depth || place.distance > band.margin) continue;
    if (model.truth.border_distance(foot) < hole_share * model.mesh.diagonal) {
      ++result.near_holes;
      continue;
    }
    result.found = true;
    if (distance >= least_distance &&
        !model.truth.contested(place.point, foot, 2 * model.tolerance)) {
      place.outward = side * (place.point - foot) / distance;
    }
    return result;
  }
  return result;
}

}  // namespace

Places draw_places(const Model& model, std::uint64_t count, std::uint64_t seed) {
  // A seed of its own keeps these places apart from those that a bake tries and verifies with.
  const std::uint64_t own = baker::random_bits(seed, 0x62656E6368000000ULL);
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
