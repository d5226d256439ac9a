// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/field_memory.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/sixdof/sample_vectors.hpp"

namespace spm::field_memory_test {
namespace {

/// The field reading of a ball of this radius about the origin.
FieldReading of_ball(double radius, const Vector3& place) {
  FieldReading reading;
  reading.place = floats_of(place);
  reading.distance = static_cast<float>(place.norm() - radius);
  reading.normal = floats_of(place.normalized());
  reading.validity_radius = 0;
  return reading;
}

TEST_CASE(
    "What was learned of a point is recalled until another takes its room, or all is forgotten") {
  FieldMemory memory({1e-4, 1e-5, 16});
  CHECK_FALSE(memory.recall(3).known());
  FieldReading reading = of_ball(1, {0, 0, 1});
  memory.learn(3, reading);
  CHECK(reading.validity_radius > 0);
  CHECK(memory.recall(3).place == reading.place);
  CHECK_FALSE(memory.recall(19).known());
  memory.learn(19, reading);
  CHECK_FALSE(memory.recall(3).known());
  memory.forget();
  CHECK_FALSE(memory.recall(19).known());
}

TEST_CASE("A reading reaches as far as its plane holds: far on flat ground, less on a small ball") {
  for (const double radius : {0.0005, 10.0}) {
    FieldMemory memory({2e-4, 1e-5, 16});
    FieldReading reading = of_ball(radius, {0, 0, radius});
    memory.learn(0, reading);
    double worst = 0;
    for (double angle = 0; angle * radius < 0.002; angle += 1e-6 / radius) {
      const Vector3 place = radius * Vector3(std::sin(angle), 0, std::cos(angle));
      reading = memory.recall(0);
      if (!reading.stands_for(place)) {
        reading = of_ball(radius, place);
        memory.learn(0, reading);
      }
      worst = std::max(worst, std::abs(reading.distance_at(place)));
    }
    CHECK(worst < 2.5e-5);
    if (radius < 1) CHECK(reading.validity_radius < 1.01e-4F);
    if (radius > 1) CHECK(reading.validity_radius == 2e-4F);
  }
}

TEST_CASE("A bound has no plane, and without a reach nothing is kept") {
  FieldMemory memory({1e-4, 1e-5, 16});
  FieldReading bound;
  bound.validity_radius = 0;
  bound.distance = 0.01F;
  memory.learn(5, bound);
  CHECK(memory.recall(5).known());
  CHECK_FALSE(memory.recall(5).stands_for(Vector3::Zero()));
  FieldMemory none({0, 1e-5, 16});
  FieldReading reading = of_ball(1, {0, 0, 1});
  none.learn(5, reading);
  CHECK_FALSE(none.recall(5).known());
}

}  // namespace
}  // namespace spm::field_memory_test
