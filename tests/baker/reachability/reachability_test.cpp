// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/reachability/reachability.hpp"

#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "baker/reachability/reachability_field.hpp"
#include "baker/reachability/sealed_voids.hpp"
#include "common/base/random.hpp"
#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::reachability_test {
namespace {

using test::surface_of;

/// Plate about the origin, 40 x 40 mm, with a square blind hole or, where `through`, one right
/// through it, `width` wide, along z.
test::Shape plate_with_hole(double width, double thickness, bool through) {
  const double outer = 0.02, inner = width / 2, top = thickness / 2;
  const double floor = through ? -top : -top + 0.002;
  test::Shape shape;
  const auto ring = [&](double half, double z) {
    const auto first = static_cast<std::uint32_t>(shape.vertices.size());
    for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
      shape.vertices.emplace_back(x * half, y * half, z);
    }
    return first;
  };
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t next = (k + 1) % 4;
      shape.triangles.push_back({a + k, a + next, b + next});
      shape.triangles.push_back({a + k, b + next, b + k});
    }
  };
  const std::uint32_t below = ring(outer, -top), above = ring(outer, top);
  const std::uint32_t mouth = ring(inner, top), bottom = ring(inner, floor);
  join(below, above);
  join(above, mouth);
  join(mouth, bottom);
  if (through) {
    join(bottom, below);
  } else {
    shape.triangles.push_back({bottom, bottom + 1, bottom + 2});
    shape.triangles.push_back({bottom, bottom + 2, bottom + 3});
    shape.triangles.push_back({below, below + 2, below + 1});
    shape.triangles.push_back({below, below + 3, below + 2});
  }
  return shape;
}

test::Shape hollow_ball(double outer, double inner) {
  return test::merged(test::sphere(outer, 4), test::turned_inside_out(test::sphere(inner, 4)));
}

OrientedBox box_about(const Vector3& middle, const Vector3& half) {
  OrientedBox box;
  box.middle = middle;
  box.half = half;
  return box;
}

TEST_CASE("A point without a workspace comes everywhere but into sealed hollows") {
  const Caster solid(surface_of(test::torus(0.035, 0.012, 48, 24)));
  REQUIRE_FALSE(without_sealed_voids(solid));
  const Reachability everywhere(solid, {0.002, 0.0005}, 0, std::nullopt, {});
  const Caster hollow(surface_of(hollow_ball(0.04, 0.03)));
  const Reachability reachability(hollow, {0.002, 0.0005}, 0, std::nullopt, {});
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Vector3 place(0.1 * (random_unit(31, 3 * i) - 0.5),
                        0.1 * (random_unit(31, 3 * i + 1) - 0.5),
                        0.1 * (random_unit(31, 3 * i + 2) - 0.5));
    CHECK(everywhere.point(place) == PruneRule::none);
    const double radius = place.norm();
    if (std::abs(radius - 0.032) < 1e-4) continue;  // between facets and the sphere
    CHECK(reachability.point(place) == (radius < 0.032 ? PruneRule::unreachable : PruneRule::none));
  }
}

TEST_CASE("What lies in a sealed hollow is left out with it, and what lies beside is not") {
  test::Shape shape = test::merged(hollow_ball(0.04, 0.03), test::sphere(0.01, 3));
  shape = test::merged(shape, test::moved(test::sphere(0.01, 3), {0.08, 0, 0}));
  const Caster caster(surface_of(shape));
  const auto filled = without_sealed_voids(caster);
  REQUIRE(filled);
  CHECK(filled->solid_count ==
        test::sphere(1, 4).triangles.size() + test::sphere(1, 3).triangles.size());
  const Reachability reachability(caster, {0.002, 0.0005}, 0, std::nullopt, {});
  CHECK(reachability.point({0.0105, 0, 0}) == PruneRule::unreachable);
  CHECK(reachability.point({0.0095, 0, 0}) == PruneRule::unreachable);
  CHECK(reachability.point({0.0905, 0, 0}) == PruneRule::none);
  CHECK(reachability.point({0.0895, 0, 0}) == PruneRule::none);
}

TEST_CASE(
    "A sealed hollow behind a wall thinner than the band is reached as far as one can press") {
  const Caster caster(surface_of(hollow_ball(0.04, 0.039)));
  const Reachability reachability(caster, {0.005, 0.0005}, 0, std::nullopt, {});
  CHECK(reachability.point({0.036, 0, 0}) == PruneRule::none);
  CHECK(reachability.point({0.034, 0, 0}) == PruneRule::unreachable);
}

TEST_CASE("A place deeper than the band is left to its own answer") {
  const Caster caster(surface_of(hollow_ball(0.04, 0.02)));
  const Reachability reachability(caster, {0.002, 0.0005}, 0.001, std::nullopt, {});
  CHECK(reachability.point({0.03, 0, 0}) == PruneRule::none);
  CHECK(reachability.cube({0.03, 0, 0}, 0.001) == PruneRule::none);
  CHECK(reachability.point({0.021, 0, 0}) == PruneRule::unreachable);
  CHECK(reachability.point({0.019, 0, 0}) == PruneRule::unreachable);
}

TEST_CASE("A hole narrower than the probe is cut but for what the probe presses into its mouth") {
  for (const bool through : {false, true}) {
    const test::Shape shape = plate_with_hole(0.003, 0.02, through);
    const Caster caster(surface_of(shape));
    const Band band{0.001, 0.0025};
    const Reachability reachability(caster, band, 0.002, std::nullopt, {});
    CHECK(reachability.point({0, 0, 0}) == PruneRule::probe);
    CHECK(reachability.cube({0.001, 0, 0}, 0.001) == PruneRule::probe);
    CHECK(reachability.point({0.0016, 0, 0}) ==
          PruneRule::probe);  // its wall, from within the solid
    CHECK(reachability.point({0, 0, 0.0095}) == PruneRule::none);
    CHECK(reachability.point({0.01, 0, 0.0095}) == PruneRule::none);
    CHECK(reachability.point({0.0199, 0, 0}) == PruneRule::none);
    const Reachability small(caster, band, 0.001, std::nullopt, {});
    CHECK(small.point({0, 0, 0}) == PruneRule::none);
    CHECK(small.point({0.0016, 0, 0}) == PruneRule::none);
  }
}

TEST_CASE("A band deeper than the probe is wide does not press it through what it does not fit") {
  const Caster caster(surface_of(plate_with_hole(0.003, 0.03, false)));
  const Reachability reachability(caster, {0.004, 0.003}, 0.002, std::nullopt, {});
  CHECK(reachability.point({0, 0, -0.005}) == PruneRule::probe);
  CHECK(reachability.point({0, 0, 0.0125}) ==
        PruneRule::none);  // as deep as it is pressed into the mouth
}

TEST_CASE("No place that a free probe is pressed to is cut") {
  const double radius = 0.0015;
  const Band band{0.001, 0.002};
  for (const test::Shape& shape : {plate_with_hole(0.0035, 0.02, true),
                                   test::torus(0.01, 0.008, 48, 24), test::wedge(0.5, 0.03)}) {
    const Caster caster(surface_of(shape));
    const Reachability reachability(caster, band, radius, std::nullopt, {});
    std::size_t pressed = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      const Vector3 place(0.05 * (random_unit(33, 3 * i) - 0.5),
                          0.05 * (random_unit(33, 3 * i + 1) - 0.5),
                          0.05 * (random_unit(33, 3 * i + 2) - 0.5));
      const ClosestPoint closest = caster.closest(place);
      if (closest.distance < -band.max_depth || closest.distance > band.margin) continue;
      // The ball that touches there fits, and all free places of these shapes lead outside.
      const Vector3 free = closest.closest_point + (radius + 1e-9) * closest.direction;
      if (caster.closest(free).distance < radius) continue;
      ++pressed;
      CHECK(reachability.point(place) == PruneRule::none);
      CHECK(reachability.cube(place, 0.0005) == PruneRule::none);
    }
    CHECK(pressed > 100);
  }
}

TEST_CASE("No place that a probe is pressed to from a free place is cut") {
  const double radius = 0.001;
  const Band band{0.003, 0.002};
  const Caster caster(surface_of(plate_with_hole(0.0025, 0.02, true)));
  const Reachability reachability(caster, band, radius, std::nullopt, {});
  std::size_t pressed = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const auto unit = [&](std::uint64_t k) { return random_unit(36, 6 * i + k) - 0.5; };
    // Every free place about the plate leads outside, those in its hole through either mouth.
    const Vector3 free(0.01 * unit(0), 0.01 * unit(1), 0.03 * unit(2));
    if (caster.closest(free).distance < radius) continue;
    const Vector3 push = Vector3(unit(3), unit(4), unit(5)).normalized();
    ++pressed;
    CHECK(reachability.point(free + band.max_depth * push) == PruneRule::none);
  }
  CHECK(pressed > 1000);
}

TEST_CASE("Surface that the probe cannot touch is cut beside surface that it touches") {
  const Caster caster(surface_of(plate_with_hole(0.005, 0.02, false)));
  const Reachability reachability(caster, {0.002, 0.0055}, 0.005, std::nullopt, {});
  CHECK(reachability.point({0, 0, -0.0079}) ==
        PruneRule::probe);  // the hole's floor, from both sides
  CHECK(reachability.point({0, 0, -0.0081}) == PruneRule::probe);
  CHECK(reachability.point({0.0024, 0, 0.005}) == PruneRule::probe);
  CHECK(reachability.point({0.0024, 0, 0.0099}) == PruneRule::none);
  CHECK(reachability.point({0.003, 0, 0.0099}) == PruneRule::none);
}

TEST_CASE("What is outside the workspace is cut, however it is turned") {
  const Caster caster(surface_of(test::box({0.04, 0.04, 0.04})));
  OrientedBox workspace = box_about({0.05, 0, 0}, {0.05, 0.05, 0.05});
  const Reachability half(caster, {0.002, 0.0005}, 0, workspace, {});
  CHECK(half.point({0.001, 0.02, 0}) == PruneRule::none);
  CHECK(half.point({-0.001, 0.02, 0}) == PruneRule::workspace);
  CHECK(half.cube({-0.001, 0.02, 0}, 0.001) == PruneRule::workspace);
  CHECK(half.cube({-0.0005, 0.02, 0}, 0.002) == PruneRule::none);
  const double turn = std::numbers::pi / 4;
  workspace.axes.col(0) = Vector3(std::cos(turn), std::sin(turn), 0);
  workspace.axes.col(1) = Vector3(-std::sin(turn), std::cos(turn), 0);
  workspace.middle = Vector3(0.02, 0.02, 0);
  workspace.half = Vector3(0.01, 0.002, 0.03);
  const Reachability turned(caster, {0.002, 0.0005}, 0, workspace, {});
  CHECK(turned.point({0.02, 0.02, 0}) == PruneRule::none);
  CHECK(turned.point({0.015, 0.015, 0}) == PruneRule::none);
  CHECK(turned.point({0.02, 0.015, 0}) == PruneRule::workspace);
}

TEST_CASE("A workspace within a hollow lets the probe start there") {
  const Caster caster(surface_of(hollow_ball(0.04, 0.03)));
  const OrientedBox inside = box_about(Vector3::Zero(), Vector3::Constant(0.022));
  for (const double radius : {0.0, 0.002}) {
    const Reachability reachability(caster, {0.002, 0.0025}, radius, inside, {});
    CHECK(reachability.point({0, 0, 0.0215}) == PruneRule::none);
    CHECK(reachability.point({0.0175, 0.0175, 0.0175}) == PruneRule::none);
    CHECK(reachability.point({0.0395, 0, 0}) == PruneRule::workspace);
  }
  const OrientedBox across = box_about({0.03, 0, 0}, Vector3::Constant(0.02));
  const Reachability reachability(caster, {0.002, 0.0025}, 0, across, {});
  CHECK(reachability.point({0.0295, 0, 0}) == PruneRule::unreachable);
  CHECK(reachability.point({0.0395, 0, 0}) == PruneRule::none);
}

TEST_CASE("The distances of a field are those that a search of all voxels finds") {
  const Caster caster(surface_of(test::box({0.04, 0.03, 0.02})));
  const Vector3 high(0.02, 0.015, 0.01);
  const double radius = 0.002;
  const ReachabilityField field(caster, -high, high, radius, std::nullopt, {});
  const double slack = 2 * field.coarseness();
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vector3 place(0.05 * (random_unit(35, 3 * i) - 0.5),
                        0.05 * (random_unit(35, 3 * i + 1) - 0.5),
                        0.05 * (random_unit(35, 3 * i + 2) - 0.5));
    // A ball outside a box: free places are those a radius off it, with all else beside them.
    const Vector3 outside = (place.cwiseAbs() - high).cwiseMax(0);
    const double inside = std::min(0.0, (place.cwiseAbs() - high).maxCoeff());
    const double to_free = std::max(0.0, radius - outside.norm() - inside);
    CHECK(field.near(place, to_free));
    if (to_free > 2 * slack) CHECK_FALSE(field.near(place, to_free - 2 * slack));
  }
}

TEST_CASE("What is reached is the same for any number of threads") {
  const Caster caster(surface_of(plate_with_hole(0.0035, 0.02, true)));
  const auto verdicts = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Reachability reachability(caster, {0.001, 0.0025}, 0.002, std::nullopt, {});
    std::vector<PruneRule> found;
    for (std::uint64_t i = 0; i < 5000; ++i) {
      found.push_back(reachability.point({0.05 * (random_unit(34, 3 * i) - 0.5),
                                          0.05 * (random_unit(34, 3 * i + 1) - 0.5),
                                          0.05 * (random_unit(34, 3 * i + 2) - 0.5)}));
    }
    return found;
  };
  CHECK(verdicts(1) == verdicts(2));
}

}  // namespace
}  // namespace spm::baker::reachability_test
