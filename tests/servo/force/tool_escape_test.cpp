// SPDX-License-Identifier: Apache-2.0
// Tools that begin, or are put, so deep in an object that its field does not tell the way out.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/servo/force/tool_scene.hpp"
#include "tests/support/triangle_octree.hpp"

namespace spm::tool_escape_test {
namespace {

using test::SparseCubeByHand;
using test::ToolScene;

// m; the table's and the tool's sizes.
constexpr double big = ToolScene::table_size, small = ToolScene::tool_size;

/// Makes a cube's field and surface those of another shape.
void become(SparseCubeByHand& cube, const test::Shape& shape) {
  cube.planes.clear();
  cube.replace_triangles(shape);
}

test::Shape shape_of(const std::string& name) {
  if (name == "ball") return test::sphere(big / 2, 2);
  if (name == "torus") return test::torus(big / 2 - 0.008, 0.008, 24, 12);
  return test::box(Vector3::Constant(big));
}

/// A tool in an object about the origin, whose forces are watched.
struct Inside : ToolScene {
  explicit Inside(const std::string& object, bool round = true, Method method = Method::proxy)
      : ToolScene(method) {
    scene.objects[0].placement.position.setZero();
    scene.tool->coupling = 1000;
    scene.tool->spacing = 0.0015;
    if (object != "box") become(table, shape_of(object));
    if (round) become(tool_cube, test::sphere(small / 2, 2));
    begin();
  }
  /// A tick with the hand there.
  ContactForce watched(const Vector3& hand) {
    const Vector3 before = force->tool().pose.translation();
    ContactForce contact = next(hand);
    most_force = std::max(most_force, contact.force.norm());
    // On its way it is led; afterwards it may slide along the surface, as any tool.
    if (force->tool().leaving && left++ > 0) {
      most_way = std::max(most_way, (force->tool().pose.translation() - before).norm());
      most_step = std::max(most_step, (contact.force - last).norm());
    }
    last = contact.force;
    return contact;
  }

  double most_force = 0, most_step = 0, most_way = 0;
  Vector3 last = Vector3::Zero();
  int left = 0;
};

/// How far the tool's middle is outside of the object's surface, m.
double outside_by(const std::string& object, const Vector3& place) {
  if (object == "ball") return place.norm() - big / 2;
  if (object == "torus") {
    const double ring = place.head<2>().norm() - (big / 2 - 0.008);
    return std::hypot(ring, place.z()) - 0.008;
  }
  return (place.cwiseAbs() - Vector3::Constant(big / 2)).maxCoeff();
}

TEST_CASE(
    "A tool that begins deep in an object is led out, without a kick, and feels it as always") {
  const std::string object = GENERATE("box", "ball", "torus");
  const bool round = GENERATE(true, false);
  const Method method = GENERATE(Method::proxy, Method::spm);
  // In the very middle, where all normals cancel, and beside it.
  const Vector3 beside = GENERATE(Vector3(0, 0, 0), Vector3(0.001, -0.0015, 0.002));
  const Vector3 hand =
      beside + (object == "torus" ? Vector3(big / 2 - 0.008, 0, 0) : Vector3::Zero());
  INFO(object << (round ? ", round tool, by " : ", cubic tool, by ")
              << (method == Method::spm ? "spm, at " : "proxy, at ") << hand.transpose());
  Inside inside(object, round, method);
  for (int tick = 0; tick < 2000; ++tick) inside.watched(hand);
  const Vector3 middle = inside.force->tool().pose.translation();
  CHECK(outside_by(object, middle) > 0.8 * small / 2);
  // By the shortest way: no farther out than the nearest side and the tool itself, but for corners.
  CHECK((middle - hand).norm() < 1.3 * (small - outside_by(object, hand)));
  CHECK(inside.most_force <= inside.turning.force_cap * (1 + 1e-9));
  CHECK(inside.most_step < 0.06);
  CHECK(inside.most_way < 6e-5);
  CHECK(inside.left > 100);
  CHECK_FALSE(inside.force->tool().leaving);
  // The hand is pulled the way that the tool went, at the cap.
  CHECK(inside.last.normalized().dot((middle - hand).normalized()) > 0.9);
  // Once the hand has come out there is no force; what it presses on then is a wall as ever.
  const Vector3 out = (middle - hand).normalized();
  inside.settle(middle + 0.002 * out, Eigen::Quaterniond::Identity(), 50);
  CHECK(inside.settle(middle + 0.002 * out).force.norm() < 1e-9);
  const ContactForce wall = inside.settle(middle - 0.001 * out);
  // By spm, what presses with a small part of the tool is softer.
  CHECK(wall.force.norm() > (method == Method::spm ? 0.3 : 0.5));
  CHECK(wall.force.norm() < 1.3);
}

TEST_CASE("A tool that lies in an object upon another is not led into that one") {
  Inside inside("box");
  inside.scene.objects.push_back(inside.scene.objects[0]);
  inside.scene.objects[1].placement.position = {0, 0, -big};
  inside.begin();
  // Down is the shortest way out of the first.
  const Vector3 hand(0, 0, -0.010);
  for (int tick = 0; tick < 2000; ++tick) inside.watched(hand);
  const Vector3 middle = inside.force->tool().pose.translation();
  CHECK(middle.head<2>().cwiseAbs().maxCoeff() > big / 2 + 0.8 * small / 2);
  CHECK(inside.most_step < 0.06);
  CHECK_FALSE(inside.force->tool().leaving);
}

TEST_CASE("A tool that an object was put over is led out of it") {
  Inside inside("ball", true, GENERATE(Method::proxy, Method::spm));
  inside.scene.objects[0].placement.position = {0.2, 0, 0};
  inside.begin();
  const Vector3 hand(0.0005, 0, 0);
  for (int tick = 0; tick < 50; ++tick) inside.watched(hand);
  CHECK(inside.most_force == 0);
  inside.force->place(0, Vector3::Zero(), Eigen::Quaterniond::Identity());
  for (int tick = 0; tick < 1500; ++tick) inside.watched(hand);
  CHECK(outside_by("ball", inside.force->tool().pose.translation()) > 0.8 * small / 2);
  CHECK(inside.most_step < 0.06);
}

TEST_CASE(
    "A tool without a free way goes straight off its object, by the way to it and its own size") {
  constexpr double radius = small / 2, beside = 0.012, thin_margin = 1e-4;
  SparseCubeByHand ball(small), cube(big, {0.002, thin_margin});
  become(ball, test::sphere(radius, 2));
  const SurfaceSamples samples = *sample_surface(ball.view, 0.0015);
  const auto at = [](const Vector3& place) {
    return Eigen::Isometry3d(Eigen::Translation3d(place));
  };
  // The object, and a wall close to the tool on each of its sides.
  std::vector<ContactObject> objects{{&cube.view, at({0, 0, beside}), 0.1}};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1, 1}) {
      const double place = samples.radius + 2 * thin_margin + big / 2;
      objects.push_back({&cube.view, at(side * place * Vector3::Unit(axis))});
    }
  }
  ToolEscape escape(samples);
  const Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  for (int tick = 0; tick < 20; ++tick) escape.note({true, false, 0}, tool, objects);
  REQUIRE(escape.leads());
  Vector3 way = Vector3::Zero();
  for (int tick = 0; tick < 10000 && escape.leads(); ++tick) {
    way += escape.next(tool, objects, 6e-5);
  }
  CHECK_FALSE(escape.leads());
  const double from_middle = (samples.centre - Vector3(0, 0, beside)).norm();
  CHECK(way.norm() == Approx(from_middle + 2 * samples.radius).epsilon(1e-9));
  CHECK(-way.z() == Approx(way.norm()).epsilon(1e-3));
}

TEST_CASE("A tool that an object lies in as a whole is led off it") {
  Inside inside("box", true, GENERATE(Method::proxy, Method::spm));
  inside.scene.objects[0].placement.scale = 0.1;
  inside.begin();
  const Vector3 hand(0.0002, 0.0001, 0);
  for (int tick = 0; tick < 1000; ++tick) inside.watched(hand);
  const Vector3 middle = inside.force->tool().pose.translation();
  CHECK(middle.norm() > small / 2);
  CHECK(inside.most_step < 0.06);
  CHECK(inside.most_way < 6e-5);
}

TEST_CASE("Forces on a tool that is led out are the same again, to the bit") {
  const auto run = [](Inside& inside) {
    constexpr int ticks = 700;
    std::vector<Vector3> forces;
    forces.reserve(ticks);
    for (int tick = 0; tick < ticks; ++tick) {
      forces.push_back(inside.watched({0.001 * std::sin(0.01 * tick), 0, 0.0005}).force);
    }
    return forces;
  };
  const Method method = GENERATE(Method::proxy, Method::spm);
  Inside first("ball", true, method), second("ball", true, method);
  const std::vector<Vector3> forces = run(first);
  CHECK(run(second) == forces);
  // Also with room for objects of applications, of which a replay knows nothing.
  Inside roomy("ball", true, method);
  roomy.begin(40);
  CHECK(run(roomy) == forces);
  // Also after it was forgotten in the middle of its way.
  for (int tick = 0; tick < 333; ++tick) second.watched({0.002, 0.003, 0});
  second.force->reset();
  CHECK(run(second) == forces);
}

}  // namespace
}  // namespace spm::tool_escape_test
