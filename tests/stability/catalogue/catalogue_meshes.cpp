// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/catalogue/catalogue_parts.hpp"

// Where the hand goes was found once, on the meshes alone, and is fixed: no asset and no force was
// looked at. catalogue_test.cpp holds each place to what is said of it here.

namespace spm::stability {
namespace {

/// N: half of the usual, since the bands of these assets are those of the project's tables, 2 mm.
constexpr double mesh_press = 1;
constexpr double mesh_band = 2e-3;  // m

struct Place {
  Vector3 at;               ///< m, of the probe's centre, about where it touches
  Vector3 normal;           ///< need not be unit
  double probe_radius = 0;  ///< m
};

StabilityCase mesh_case(std::string name, std::string title, std::string mesh, double tolerance,
                        const Place& place) {
  StabilityCase made =
      press_case("meshes", std::move(name), std::move(title), {},
                 {.place = place.at, .normal = place.normal.normalized(), .force = mesh_press});
  made.mesh = std::move(mesh);
  made.tolerance = tolerance;
  made.max_depth = mesh_band;
  made.probe_radius = place.probe_radius;
  return made;
}

/// Of the vertices from whose normal a way of 12 mm is free, one of the two (they are mirrored)
/// with the steepest walls about it: 0.7 mm beside it the surface is 2 mm higher and more on seven
/// of eight sides. Two teeth close over it 3 mm above, where a ball of 0.5 mm is caught.
StabilityCase teeth_fissure() {
  const Vector3 bottom(0.021629, 0.009706, -0.002626);
  const Vector3 normal = Vector3(-0.287, 0.9106, 0.2975).normalized();
  return mesh_case("teeth-fissure",
                   "A ball of 0.5 mm is pressed with 1 N into the fissure between two teeth, which "
                   "is narrower than the ball: it is thrown from wall to wall, or pulled in.",
                   "teeth.obj", 50e-6, {bottom + 3.45e-3 * normal, normal, 0.5e-3});
}

/// The middle of the triangle number 2951 (from 0), of those of 4 mm2 and more with a free way of
/// 12 mm the one that has 0.5 mm all about it, with the freest start.
StabilityCase galleon_sail() {
  return mesh_case(
      "galleon-sail",
      "A sail of 0.5 mm is pressed with 1 N: deeper than half of it the nearest side is "
      "the far one.",
      "galleon.obj", 100e-6, {{0.008622, -0.000967, 0.006328}, {0.01065, 0.74569, -0.66621}});
}

/// The middle of the triangle number 2817: thinner than 0.4 mm all about, down to 0.1.
StabilityCase galleon_thin_sail() {
  return mesh_case("galleon-thin-sail",
                   "A sail that tapers about 0.2 mm is pressed with 1 N: it is hardly thicker than "
                   "the tolerance it is baked to.",
                   "galleon.obj", 100e-6,
                   {{-0.013133, -0.000607, 0.000196}, {0.52723, 0.84861, 0.04348}});
}

constexpr double fandisk_scale = 0.1 / 7.615588770909313;  // to a diagonal of 0.1 m

/// 0.5 mm beside the middle of a convex edge of about a right angle, from which the face is flat
/// for 4 mm inwards and 4 mm each way along it.
StabilityCase fandisk_edge() {
  StabilityCase made = mesh_case(
      "fandisk-edge",
      "A face is pressed with 1 N, 0.5 mm beside a sharp edge: deeper than that the other face is "
      "nearer, and a depth alone throws the hand off sideways.",
      "fandisk.obj", 20e-6, {{0, 0.201944, -0.009669}, {-1, 0, 0}});
  made.mesh_scale = fandisk_scale;
  return made;
}

/// The middle of a concave edge of 100 degrees whose one face is as flat.
StabilityCase fandisk_inner_edge() {
  constexpr double radius = 1e-3,
                   half_opening = 0.8721;  // m; rad, half of what is left of 180 degrees
  const Vector3 edge(0.031881, 0.175724, -0.008653);
  const Vector3 normal = (Vector3(1, 0, 0) + Vector3(0.17272, -0.98377, 0.04856)).normalized();
  StabilityCase made = mesh_case("fandisk-inner-edge",
                                 "A ball of 1 mm is pressed with 1 N into an edge where two faces "
                                 "meet inwards at 100 degrees: "
                                 "pushed by the nearest alone it is thrown from one to the other.",
                                 "fandisk.obj", 20e-6,
                                 {edge + radius / std::sin(half_opening) * normal, normal, radius});
  made.mesh_scale = fandisk_scale;
  return made;
}

}  // namespace

std::vector<StabilityCase> mesh_cases() {
  return {teeth_fissure(), galleon_sail(), galleon_thin_sail(), fandisk_edge(),
          fandisk_inner_edge()};
}

}  // namespace spm::stability
