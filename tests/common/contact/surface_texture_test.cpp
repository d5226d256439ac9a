// SPDX-License-Identifier: Apache-2.0
#include "common/contact/surface_texture.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace spm::surface_texture_test {
namespace {

const TextureSettings settings{2e-5, 1e-3, 7};

Vector3 somewhere(std::mt19937& random) {
  std::uniform_real_distribution<double> at(-0.05, 0.05);
  return {at(random), at(random), at(random)};
}

TEST_CASE("The same place feels the same, another seed's place does not") {
  std::mt19937 random(1);
  TextureSettings other = settings;
  other.seed = 8;
  int same = 0;
  for (int i = 0; i < 200; ++i) {
    const Vector3 place = somewhere(random);
    CHECK(texture_at(settings, place).height == texture_at(settings, place).height);
    same += texture_at(other, place).height == texture_at(settings, place).height ? 1 : 0;
  }
  CHECK(same == 0);
}

TEST_CASE("No place is raised by more than the amplitude, and the mean is near none") {
  std::mt19937 random(2);
  double sum = 0, squares = 0;
  constexpr int places = 20000;
  for (int i = 0; i < places; ++i) {
    const double height = texture_at(settings, somewhere(random)).height;
    REQUIRE(std::abs(height) <= settings.amplitude);
    sum += height;
    squares += height * height;
  }
  CHECK(std::abs(sum / places) < 0.02 * settings.amplitude);
  CHECK(std::sqrt(squares / places) > 0.2 * settings.amplitude);
}

TEST_CASE("The gradient is the height's, across the lattice's borders too") {
  std::mt19937 random(3);
  constexpr double h = 1e-7;
  for (int i = 0; i < 300; ++i) {
    Vector3 place = somewhere(random);
    if (i % 3 == 0) place.x() = 1e-3 * std::round(place.x() / 1e-3);
    const Vector3 gradient = texture_at(settings, place).gradient;
    for (int k = 0; k < 3; ++k) {
      const Vector3 away = h * Vector3::Unit(k);
      const double slope =
          (texture_at(settings, place + away).height - texture_at(settings, place - away).height) /
          (2 * h);
      CHECK(gradient[k] == Approx(slope).margin(1e-6));
    }
  }
}

TEST_CASE("Pressing and stroking a textured plane round a closed path gains no energy") {
  const auto force_at = [](const Vector3& point) {
    return textured_force(1000, -point.z(), Vector3::UnitZ(), texture_at(settings, point));
  };
  double work = 0, most = 0;
  constexpr int steps = 20000;
  const auto path = [](int i) {
    const double turn = 2 * std::numbers::pi * i / steps;
    return Vector3(3e-3 * std::cos(turn), 2e-3 * std::sin(turn),
                   -1e-4 * (1.2 + std::sin(3 * turn)));
  };
  for (int i = 0; i < steps; ++i) {
    const Vector3 from = path(i), to = path(i + 1);
    const double part = force_at((from + to) / 2).dot(to - from);
    work += part;
    most += std::abs(part);
  }
  CHECK(std::abs(work) < 1e-4 * most);
}

TEST_CASE("Over the raised surface there is no force, and without texture it is the penalty") {
  const Vector3 up = Vector3::UnitZ();
  CHECK(textured_force(1000, -1e-5, up, {1e-5, Vector3(0.1, 0, 0)}).isZero());
  CHECK(textured_force(1000, -1e-5, up, {2e-5, Vector3::Zero()}).z() == Approx(0.01));
  CHECK((textured_force(1000, 1e-3, up, {}) - Vector3(0, 0, 1)).norm() < 1e-15);
}

TEST_CASE("A place that no lattice counts has no texture") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double far : {nan, infinity, -infinity, 1e300}) {
    CHECK(texture_at(settings, {0, far, 0}).height == 0);
    CHECK(texture_at(settings, {0, far, 0}).gradient.isZero());
  }
  CHECK(texture_at({1e-5, 0, 1}, {1e-3, 0, 0}).height == 0);
}

}  // namespace
}  // namespace spm::surface_texture_test
