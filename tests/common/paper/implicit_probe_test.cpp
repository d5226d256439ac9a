// SPDX-License-Identifier: Apache-2.0
#include "common/paper/implicit_probe.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

namespace spm::implicit_probe_test {
namespace {

double to_line(const Vector3& point, const Vector3& from, const Vector3& to) {
  const Vector3 axis = to - from;
  const double square = axis.squaredNorm();
  const double t = square > 0 ? std::clamp((point - from).dot(axis) / square, 0.0, 1.0) : 0;
  return (point - from - t * axis).norm();
}

TEST_CASE("A line enters and leaves a capsule on its surface, or misses what it passes by") {
  std::mt19937 random(4);
  std::normal_distribution<double> at(0, 1);
  const auto vector = [&] { return Vector3(at(random), at(random), at(random)); };
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3 from = vector(), to = i % 10 == 0 ? from : vector();
    const Vector3 origin = vector(), direction = vector().normalized();
    const CapsuleProbe capsule(from, to, 0.5);
    const ProbeSpan span = capsule.span(origin, direction);
    double nearest = 10;
    for (int k = -2000; k <= 2000; ++k) {
      nearest = std::min(nearest, to_line(origin + 0.005 * k * direction, from, to));
    }
    if (!span.hit()) {
      CHECK(nearest > 0.5 - 1e-9);
      continue;
    }
    ++hits;
    CHECK(nearest < 0.5 + 0.005);
    CHECK(to_line(origin + span.near * direction, from, to) == Approx(0.5).margin(1e-7));
    CHECK(to_line(origin + span.far * direction, from, to) == Approx(0.5).margin(1e-7));
    CHECK(to_line(origin + (span.near + span.far) / 2 * direction, from, to) <= 0.5 + 1e-9);
    CHECK(to_line(origin + span.far * direction, capsule.centre() - capsule.half_axis(),
                  capsule.centre() + capsule.half_axis()) <= capsule.bounding_radius() + 1e-9);
  }
  CHECK(hits > 500);
}

TEST_CASE("A line along a capsule's axis goes from end to end") {
  const CapsuleProbe capsule({0, 0, 0}, {0, 0, 2}, 0.5);
  const ProbeSpan span = capsule.span({0, 0.3, 5}, -Vector3::UnitZ());
  CHECK(span.near == Approx(3 - 0.4));
  CHECK(span.far == Approx(5 + 0.4));
}

TEST_CASE("A capsule of one point is a sphere, and what is no number is missed") {
  const CapsuleProbe capsule({1, 2, 3}, {1, 2, 3}, 0.5);
  const SphereProbe sphere({1, 2, 3}, 0.5);
  const Vector3 towards = Vector3(1, 2, 2.9).normalized();
  CHECK(capsule.span({0, 0, 0}, towards).near == sphere.span({0, 0, 0}, towards).near);
  CHECK(sphere.span({0, 0, 0}, towards).hit());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(sphere.span({nan, 0, 0}, towards).hit());
  CHECK_FALSE(capsule.span({0, nan, 0}, towards).hit());
}

}  // namespace
}  // namespace spm::implicit_probe_test
