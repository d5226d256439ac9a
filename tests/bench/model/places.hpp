// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "tests/bench/model/model.hpp"

namespace spm::bench {

/// A place in the band, with the ground truth there.
struct Place {
  Vector3 point = Vector3::Zero();
  double distance = 0;                ///< signed, m
  Vector3 outward = Vector3::Zero();  ///< unit; zero where no direction is defined
};

/// The ground truth at any point.
struct TruePlace {
  Place place;
  Vector3 closest_point = Vector3::Zero();  ///< the closest point of the surface
  bool judged = false;                      ///< in the band
};

[[nodiscard]] TruePlace truth_at(const Model& model, const Vector3& point);

/// The set of places that all methods of a model share.
struct Places {
  std::vector<Place> places;
  double contested = 0;  ///< share of the places without a direction
};

/// Draws places as `spm-bake verify` does: uniform by area over the outer surface, at uniform
/// depths in the band, and at least 3 % of the diagonal from any border edge. A direction is
/// defined at 2 um or more from the surface and at more than two model tolerances from the medial
/// axis. Deterministic for any number of threads. Throws BakeError if no place is left.
[[nodiscard]] Places draw_places(const Model& model, std::uint64_t count, std::uint64_t seed);

}  // namespace spm::bench
