// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/sixdof/object_contact.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/random.hpp"

namespace spm::object_quadrature_test {
namespace {

using Eigen::Isometry3d;
using test::RandomTwister;
using test::SparseCubeByHand;

constexpr double field_size = 0.04;
constexpr double tool_size = 0.012;
constexpr double accuracy = 0.08;

struct CubeOnCube {
  SparseCubeByHand field{field_size};
  SparseCubeByHand tool{tool_size};
  SurfaceSamples samples;
  std::array<ContactObject, 1> objects{ContactObject{&field.view, Isometry3d::Identity()}};

  explicit CubeOnCube(double spacing) : samples(*sample_surface(tool.view, spacing)) {}
  [[nodiscard]] ObjectContact contact() const {
    ObjectContactSettings settings;
    settings.stiffness = 1e9;
    return {samples, settings};
  }
};

/// The tool above the upper face, pressed so deep, moved aside and turned.
Isometry3d pressed(double depth, double aside = 0, const Vector3& turn = Vector3::Zero()) {
  Isometry3d pose(Eigen::Translation3d(aside, 0, (field_size + tool_size) / 2 - depth));
  if (turn.norm() > 0) pose.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).matrix();
  return pose;
}

TickBudget settling() {
  TickBudget budget;
  budget.accuracy = accuracy;
  return budget;
}

double difference(const Vector3& one, const Vector3& other) {
  return (one - other).norm() / other.norm();
}

TEST_CASE("Wide contact is settled on a coarser level, for a fraction of the queries") {
  const CubeOnCube cubes(0.0001);
  ObjectContact all = cubes.contact(), settled = cubes.contact();
  RandomTwister random(3);
  for (int i = 0; i < 20; ++i) {
    const Isometry3d pose = pressed(random.between(4e-4, 1.2e-3), random.between(-0.01, 0.01),
                                    0.03 * random.direction());
    const ObjectContactReport finest = all.tick(pose, cubes.objects);
    const ObjectContactReport report = settled.tick(pose, cubes.objects, settling());
    INFO("try " << i);
    CHECK(report.asked < finest.asked / 4);
    CHECK(difference(report.sum.forces().force, finest.sum.forces().force) < accuracy);
    CHECK_FALSE(report.degraded);
    CHECK(report.level + 1 == cubes.samples.levels.size());
    CHECK(report.clearance == 0);
  }
}

TEST_CASE("Contact of few samples is resolved to the finest") {
  const CubeOnCube cubes(0.0003);
  ObjectContact all = cubes.contact(), settled = cubes.contact();
  // An edge touches.
  const Isometry3d pose = pressed(-0.0023, 0, {M_PI / 4, 0, 0});
  const ObjectContactReport finest = all.tick(pose, cubes.objects);
  const ObjectContactReport report = settled.tick(pose, cubes.objects, settling());
  REQUIRE(finest.sum.contacts > 20);
  // Small squares in place of points: some more of them touch.
  CHECK(report.sum.contacts >= finest.sum.contacts);
  CHECK(difference(report.sum.forces().force, finest.sum.forces().force) < 0.2);
}

TEST_CASE("Where few samples touch, their divided squares tell the force better than points do") {
  const CubeOnCube cubes(0.0008);
  ObjectContact points = cubes.contact(), squares = cubes.contact();
  RandomTwister random(5);
  double of_points = 0, of_squares = 0;
  constexpr int tries = 200;
  for (int i = 0; i < tries; ++i) {
    // An edge, pressed in: two strips, whose depth falls evenly from the edge on.
    const double depth = random.between(2e-4, 8e-4);
    Isometry3d pose = pressed(0, random.between(-4e-4, 4e-4), {M_PI / 4, 0, 0});
    pose.translation().z() = field_size / 2 + tool_size * M_SQRT1_2 - depth;
    const double wanted = 1e9 * tool_size * depth * depth * M_SQRT2;
    const ObjectContactReport found = squares.tick(pose, cubes.objects, settling());
    INFO("depth " << depth << ", " << found.sum.forces().force.z() << " N of " << wanted);
    const double error = found.sum.forces().force.z() / wanted - 1;
    CHECK(std::abs(error) < 0.17);
    of_squares += error * error;
    of_points += std::pow(points.tick(pose, cubes.objects).sum.forces().force.z() / wanted - 1, 2);
  }
  CHECK(std::sqrt(of_squares / tries) < 0.06);
  CHECK(of_squares < of_points / 9);
}

TEST_CASE("The force of few samples jumps by no more than a fiftieth where more come to touch") {
  const CubeOnCube cubes(0.0008);
  ObjectContact contact = cubes.contact();
  double before = 0;
  const double step = 1e-7;
  for (int i = 0; i < 9000; ++i) {
    const double depth = step * i;
    Isometry3d pose = pressed(0, 0, {M_PI / 4, 0, 0});
    pose.translation().z() = field_size / 2 + tool_size * M_SQRT1_2 - depth;
    const double force = contact.tick(pose, cubes.objects, settling()).sum.forces().force.z();
    // How the exact force grows. Samples in rows that lie along the edge come to touch at once.
    const double rises = 1e9 * tool_size * M_SQRT2 * 2 * (depth + 2e-5) * step;
    INFO("depth " << depth << ", " << force << " N after " << before << " N");
    REQUIRE(std::abs(force - before) < 3 * rises + 0.02 * before);
    before = force;
  }
}

TEST_CASE("Where enough presses, parts of the tool that nothing presses are looked at no finer") {
  const CubeOnCube cubes(0.0002);
  RandomTwister random(9);
  for (int i = 0; i < 20; ++i) {
    ObjectContact all = cubes.contact(), settled = cubes.contact();
    // A strip along one edge of the face presses; the rest of it hovers close above.
    const double tilt = random.between(0.03, 0.05);
    Isometry3d pose = pressed(0, random.between(-0.005, 0.005), {0, tilt, 0});
    pose.translation().z() += tool_size / 2 * std::sin(tilt) - 1e-4;
    const ObjectContactReport finest = all.tick(pose, cubes.objects);
    const ObjectContactReport report = settled.tick(pose, cubes.objects, settling());
    INFO("try " << i << ": " << finest.asked << " and " << report.asked << " queries, "
                << finest.sum.contacts << " and " << report.sum.contacts << " contacts, "
                << finest.sum.forces().force.transpose() << " and "
                << report.sum.forces().force.transpose());
    CHECK(report.asked < finest.asked / 4);
    CHECK(difference(report.sum.forces().force, finest.sum.forces().force) < 0.1);
  }
}

TEST_CASE("The force does not jump where another level settles it") {
  const CubeOnCube cubes(0.0001);
  ObjectContact contact = cubes.contact();
  const double step = 2e-7, stiffness = 1e9 * tool_size * (tool_size + 0.004);
  double before = 0;
  std::uint64_t contacts = 0;
  for (int i = 0; i < 6000; ++i) {
    const Isometry3d pose = pressed(-1e-4 + step * i, 0.003, {0.02, 0.05, 0.01});
    const ObjectContactReport report = contact.tick(pose, cubes.objects, settling());
    const double force = report.sum.forces().force.norm();
    INFO("step " << i << ", " << force << " N after " << before << " N");
    // What a spring over all of the face would change by, and as much again between two levels.
    if (i > 0) REQUIRE(std::abs(force - before) < 6 * step * stiffness);
    contacts = report.sum.contacts;
    before = force;
  }
  // It was settled on coarser ones meanwhile.
  ObjectContact all = cubes.contact();
  CHECK(contacts <
        all.tick(pressed(1.1e-3, 0.003, {0.02, 0.05, 0.01}), cubes.objects).sum.contacts / 4);
}

TEST_CASE(
    "From some hundreds of contacts on a level is settled, by however much it changed the sum") {
  const CubeOnCube cubes(0.0001);
  ObjectContact all = cubes.contact(), settled = cubes.contact();
  TickBudget budget;
  budget.accuracy = 1e-12;
  for (const double tilt : {0.0, 0.02, 0.05, 0.08}) {
    // About 700 contacts on the level that is settled, and some 4000 on the next.
    const Isometry3d pose = pressed(4e-4, 0.003, {tilt / 2, tilt, 0.01});
    const ObjectContactReport finest = all.tick(pose, cubes.objects);
    const ObjectContactReport report = settled.tick(pose, cubes.objects, budget);
    INFO("tilt " << tilt << ": " << report.asked << " queries of " << finest.asked);
    CHECK(report.asked < finest.asked / 10);
    CHECK(difference(report.sum.forces().force, finest.sum.forces().force) < 1e-3);
  }
}

TEST_CASE("What was skipped because nothing could touch there changes no force") {
  const CubeOnCube cubes(0.0002);
  ObjectContact contact = cubes.contact();
  RandomTwister random(7);
  Isometry3d pose = pressed(5e-4);
  for (int i = 0; i < 400; ++i) {
    const double depth = 4e-4 + 1.4e-3 * std::sin(0.02 * i);
    pose = pressed(depth, 0.01 * std::sin(0.013 * i), 0.1 * std::sin(0.01 * i) * Vector3(1, 2, 0));
    ObjectContact fresh = cubes.contact();
    const ContactSum sum = contact.tick(pose, cubes.objects, settling()).sum;
    const ContactSum wanted = fresh.tick(pose, cubes.objects, settling()).sum;
    INFO("tick " << i);
    REQUIRE(sum.contacts == wanted.contacts);
    REQUIRE((sum.wrench - wanted.wrench).norm() <= 1e-9 * wanted.wrench.norm());
  }
}

TEST_CASE(
    "Patches whose plane parts them from the object are looked at no finer, nor called clear") {
  const CubeOnCube cubes(0.0003);
  RandomTwister random(13);
  std::uint64_t asked = 0, of_all = 0;
  for (int i = 0; i < 50; ++i) {
    ObjectContact all = cubes.contact(), settled = cubes.contact();
    // Few samples touch, along an edge of the face; the rest is as far above as it is tilted.
    const double tilt = random.between(0.02, 0.04), gap = random.between(-3e-5, 2e-5);
    Isometry3d pose = pressed(0, random.between(-0.005, 0.005), {0, tilt, 0});
    pose.translation().z() += tool_size / 2 * std::sin(tilt) + gap;
    const ObjectContactReport finest = all.tick(pose, cubes.objects);
    const ObjectContactReport report = settled.tick(pose, cubes.objects, settling());
    INFO("try " << i << ", gap " << gap);
    CHECK((report.sum.wrench - finest.sum.wrench).norm() <
          0.1 * finest.sum.wrench.norm() + 1e9 * 1e-5 * tool_size * 3e-4);
    CHECK(report.clearance <= std::max(0.0, gap));
    asked += report.asked;
    of_all += finest.asked;
  }
  INFO(asked << " queries, and " << of_all << " of all samples");
  CHECK(asked < of_all / 2);
}

TEST_CASE("A tick that is ended by its work is repeated to the bit") {
  const CubeOnCube cubes(0.0001);
  ObjectContact live = cubes.contact(), again = cubes.contact();
  for (int i = 0; i < 100; ++i) {
    const Isometry3d pose = pressed(6e-4, 1e-4 * i);
    TickBudget budget = settling();
    budget.work = 50U + 40U * static_cast<std::uint32_t>(i);
    const ObjectContactReport report = live.tick(pose, cubes.objects, budget);
    budget.work = report.stopped ? report.worked : ~0U;
    const ObjectContactReport repeated = again.tick(pose, cubes.objects, budget);
    REQUIRE(report.sum.wrench == repeated.sum.wrench);
    REQUIRE(report.level == repeated.level);
  }
}

TEST_CASE("A tick without time for finer levels counts what the coarser ones know") {
  const CubeOnCube cubes(0.0001);
  ObjectContact all = cubes.contact(), contact = cubes.contact();
  const Isometry3d pose = pressed(8e-4);
  const double wanted = all.tick(pose, cubes.objects).sum.forces().force.norm();
  for (std::uint32_t level = 3; level < cubes.samples.levels.size(); ++level) {
    TickBudget budget = settling();
    budget.finest_level = level;
    const ObjectContactReport report = contact.tick(pose, cubes.objects, budget);
    INFO("level " << level);
    CHECK(report.sum.forces().force.norm() == Approx(wanted).epsilon(0.3));
  }
}

TEST_CASE("Samples that friction or a texture is on are all looked at, whatever the accuracy") {
  const CubeOnCube cubes(0.0003);
  for (const bool rough : {false, true}) {
    ObjectContact all = cubes.contact(), settled = cubes.contact();
    std::array objects = cubes.objects;
    if (rough) {
      objects[0].texture.amplitude = 5e-5;
      objects[0].texture.wavelength = 1e-3;
    } else {
      objects[0].grip.stick = objects[0].grip.slide = 0.5;
    }
    const ObjectContactReport finest = all.tick(pressed(5e-4), objects);
    const ObjectContactReport report = settled.tick(pressed(5e-4), objects, settling());
    CHECK(report.sum.wrench == finest.sum.wrench);
    CHECK(report.sum.contacts == finest.sum.contacts);
  }
}

TEST_CASE("Each object is settled by itself, in whatever frame it stands") {
  const CubeOnCube cubes(0.0001);
  ObjectContactSettings settings;
  settings.stiffness = 1e9;
  settings.objects = 2;
  ObjectContact both(cubes.samples, settings), one = cubes.contact(), other = cubes.contact();
  Isometry3d mirror = Isometry3d::Identity();
  mirror.linear().diagonal() = Vector3(-1, 1, 1);
  const std::array<ContactObject, 1> below{cubes.objects[0]};
  // Above the tool, mirrored, and smaller in the world than in its file.
  const Isometry3d above =
      Isometry3d(Eigen::Translation3d(0.002, 0, field_size / 2 + 0.0111 + 0.3 * field_size)) *
      mirror;
  std::array<ContactObject, 1> over{ContactObject{&cubes.field.view, above, 0.6}};
  const std::array together{below[0], over[0]};
  const Isometry3d pose = pressed(4e-4, 0.001, {0.01, 0.02, 0.3});
  const ContactSum sum = both.tick(pose, together, settling()).sum;
  const ContactSum first = one.tick(pose, below, settling()).sum;
  const ContactSum second = other.tick(pose, over, settling()).sum;
  const ContactSum finest = cubes.contact().tick(pose, over).sum;
  REQUIRE(first.contacts > 0);
  REQUIRE(second.contacts > 0);
  CHECK((sum.wrench - first.wrench - second.wrench).norm() < 1e-9 * sum.wrench.norm());
  CHECK(difference(second.forces().force, finest.forces().force) < accuracy);
  CHECK(difference(second.forces().torque, finest.forces().torque) < 2 * accuracy);
}

}  // namespace
}  // namespace spm::object_quadrature_test
