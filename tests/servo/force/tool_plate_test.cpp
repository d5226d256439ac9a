// SPDX-License-Identifier: Apache-2.0
// A tool is pulled fast through a thin plate, turned at random.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/servo/force/tool_scene.hpp"
#include "tests/support/random.hpp"

namespace spm::tool_plate_test {
namespace {

using test::RandomTwister;
using test::ToolScene;

constexpr double thickness = 0.0002;

/// A plate across z.
void make_plate(test::SparseCubeByHand& cube) {
  for (std::size_t k : {4U, 5U}) cube.planes[k].x0 *= thickness / ToolScene::table_size;
  cube.replace_triangles(test::box({ToolScene::table_size, ToolScene::table_size, thickness}));
}

Eigen::Quaterniond any_turn(RandomTwister& random) {
  Eigen::Quaterniond turn(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1),
                          random.between(-1, 1));
  return turn.norm() > 0.1 ? turn.normalized() : Eigen::Quaterniond::Identity();
}

/// How often the tool is on the far side of the plate, in so many tries at 1 m/s.
int passes_of(int tries, std::uint64_t seed) {
  ToolScene scene;
  make_plate(scene.table);
  scene.scene.objects[0].placement.position.setZero();
  scene.scene.tool->spacing = 0.001;
  scene.begin();
  RandomTwister random(seed);
  int passes = 0;
  for (int attempt = 0; attempt < tries; ++attempt) {
    const Eigen::Quaterniond turn = any_turn(random);
    const Vector3 aside = random.vector(0.006), spin = random.vector(5e-3);
    scene.force->reset();
    bool passed = false;
    for (int tick = 0; tick < 28 && !passed; ++tick) {
      const Eigen::Quaterniond turned =
          turn * Eigen::Quaterniond(Eigen::AngleAxisd(spin.norm() * tick, spin.normalized()));
      static_cast<void>(scene.next({aside.x(), aside.y(), 0.0135 - 1e-3 * tick}, turned));
      passed = scene.force->tool().pose.translation().z() < 0;
    }
    passes += passed ? 1 : 0;
  }
  return passes;
}

TEST_CASE("A plate of 0.2 mm is not passed at 1 m/s, however the tool is turned") {
  CHECK(passes_of(150, 1) == 0);
}

TEST_CASE("A plate of 0.2 mm is not passed at 1 m/s in ten thousand tries", "[.long]") {
  CHECK(passes_of(10000, 2) == 0);
}

}  // namespace
}  // namespace spm::tool_plate_test
