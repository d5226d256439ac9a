// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/sixdof/sixdof_tries.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/random.hpp"

namespace spm::stability {

namespace {

constexpr double plate_way = 20e-3;         // m, from above the plate to as far behind it
constexpr double plate_aside = 4e-3;        // m, how far from its middle the plate is met
constexpr double plate_thickness = 0.2e-3;  // m, its thickness
constexpr double plate_rest = 20;           // ticks, that the reading stays behind the plate

/// How far a tool's lowest vertex lies below z = 0, m.
double depth_of(const SixdofCase& tried, const Eigen::Isometry3d& pose) {
  double lowest = 0;
  for (const Vector3& vertex : tried.tool.vertices) lowest = std::min(lowest, (pose * vertex).z());
  return -lowest;
}

}  // namespace

PlateTries try_plate(const Contender& contender, const RunSettings& settings, double speed,
                     int tries, std::uint64_t first_seed) {
  const SixdofCase tried = sixdof_case("tool-pulled-through-plate");
  const auto law = make_sixdof_contestant(contender, sixdof_scene(tried), tried, settings);
  PlateTries found;
  for (; found.tries < tries; ++found.tries) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(found.tries);
    Random random(seed);
    const double angle = random.between(0, 3.14159);
    const Vector3 turn = angle * random.direction();
    const Vector3 spin = random.between(0, 10) * random.direction();  // rad/s
    Vector3 at(random.between(-plate_aside, plate_aside), random.between(-plate_aside, plate_aside),
               plate_way);
    // A little aslant, so that the ticks fall differently each time.
    const Vector3 step =
        settings.period * speed * Vector3(random.between(-0.1, 0.1), random.between(-0.1, 0.1), -1);
    law->begin(pose_of(at, turn));
    double deepest = 0;
    Eigen::Quaterniond orientation = orientation_of(turn);
    for (double left = plate_rest; left > 0;) {
      Eigen::Isometry3d measured = Eigen::Isometry3d::Identity();
      measured.translation() = at;
      measured.linear() = orientation.toRotationMatrix();
      deepest = std::max(deepest, depth_of(tried, law->next(measured).drawn));
      if (at.z() > -plate_way) {
        at += step;
        orientation = (orientation_of(settings.period * spin) * orientation).normalized();
      } else {
        left -= 1;
      }
    }
    if (deepest > plate_thickness) ++found.passed;
    if (deepest > found.deepest) found.worst = seed;
    found.deepest = std::max(found.deepest, deepest);
  }
  return found;
}

}  // namespace spm::stability
