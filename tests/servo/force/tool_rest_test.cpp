// SPDX-License-Identifier: Apache-2.0
// What a tool keeps over ticks without force: its side of what holds it back, and nothing else.
#include <catch2/catch.hpp>

#include "servo/force/kept_side.hpp"
#include "tests/servo/force/tool_scene.hpp"
#include "tests/support/random.hpp"

namespace spm::tool_rest_test {
namespace {

using test::RandomTwister;
using test::ToolScene;

constexpr double thickness = 0.001;
/// m: where the tool's origin is when it just lies on the plate.
constexpr double lies = thickness / 2 + ToolScene::tool_size / 2;

/// A tool of 12 mm above a plate of 1 mm across z.
struct AbovePlate : ToolScene {
  AbovePlate() {
    for (std::size_t k : {4U, 5U}) table.planes[k].x0 *= thickness / table_size;
    table.replace_triangles(test::box({table_size, table_size, thickness}));
    scene.objects[0].placement.position.setZero();
    begin();
  }
};

/// Comes down from above, and presses so far past where the tool lies.
ContactForce pressed(ToolScene& scene, double deep) {
  for (int tick = 0; tick < 100; ++tick) {
    static_cast<void>(scene.next({0, 0, lies + 0.002 - (0.002 + deep) * tick / 100}));
  }
  return scene.settle({0, 0, lies - deep});
}

void rest(ToolScene& scene, int ticks = 30) {
  for (int tick = 0; tick < ticks; ++tick) scene.force->rest();
}

}  // namespace

TEST_CASE("A tool pressed past the middle of a plate is on its side after ticks without force") {
  AbovePlate scene;
  // The tool would lie with its middle below the plate.
  const double deep = lies + 0.0005;
  const ContactForce before = pressed(scene, deep);
  REQUIRE(before.force.z() == Approx(1000 * deep).epsilon(0.02));
  rest(scene);
  const ContactForce first = scene.next({0, 0, lies - deep});
  CHECK(first.force.z() == Approx(before.force.z()).epsilon(0.02));
  CHECK(scene.settle({0, 0, lies - deep}).force.z() == Approx(before.force.z()).epsilon(0.02));
  CHECK(scene.force->tool().pose.translation().z() > 0);
}

TEST_CASE("A tool that is forgotten in the same place comes out on the near side") {
  // The case before is one where it matters.
  AbovePlate scene;
  static_cast<void>(pressed(scene, lies + 0.0005));
  scene.force->reset();
  CHECK(scene.settle({0, 0, -0.0005}, Eigen::Quaterniond::Identity(), 2000).force.z() < 0);
}

TEST_CASE("A tool at rest goes with what it lay on, and begins anew where that went far") {
  const double way = GENERATE(0.9, 1.1) * kept_way;
  AbovePlate scene;
  const double deep = lies + 0.0005;
  static_cast<void>(pressed(scene, deep));
  rest(scene, 10);
  scene.force->place(0, {0, 0, -way}, Eigen::Quaterniond::Identity());
  rest(scene, 10);
  const ContactForce contact = scene.next({0, 0, lies - deep});
  const double kept = deep - way;
  if (way <= kept_way) {
    CHECK(contact.force.z() == Approx(1000 * kept).epsilon(0.03));
  } else {
    CHECK(scene.force->tool().pose.translation().z() == Approx(lies - deep).margin(1e-4));
  }
}

TEST_CASE("A tool at rest whose object is removed begins anew") {
  AbovePlate scene;
  static_cast<void>(pressed(scene, 0.003));
  rest(scene);
  scene.force->remove(0);
  const ContactForce contact = scene.next({0, 0, lies - 0.003});
  CHECK(contact.force.isZero());
  CHECK(scene.force->tool().pose.translation().z() == Approx(lies - 0.003));
}

TEST_CASE("Whatever a tool did, its force after a rest is that of before where nothing moved") {
  RandomTwister random(7);
  for (int attempt = 0; attempt < 40; ++attempt) {
    AbovePlate scene;
    const double deep = random.between(0.0005, 0.0075);
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(random.between(-0.3, 0.3), random.vector(1).normalized()));
    for (int tick = 0; tick < 200; ++tick) {
      static_cast<void>(scene.next({0, 0, lies + 0.004 - (0.004 + deep) * tick / 200}, turn));
    }
    const Vector3 at(0, 0, lies - deep);
    const ContactForce before = scene.settle(at, turn);
    rest(scene, 1 + attempt);
    const ContactForce after = scene.settle(at, turn, 50);
    CAPTURE(attempt, deep, before.force.transpose(), after.force.transpose());
    REQUIRE(before.force.z() > 0);
    REQUIRE((after.force - before.force).norm() < 0.03 * before.force.norm());
  }
}

}  // namespace spm::tool_rest_test
