// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/object_contact.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/query/query.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/random.hpp"

namespace spm::object_contact_test {
namespace {

using Eigen::Isometry3d;
using test::RandomTwister;
using test::SparseCubeByHand;

constexpr double field_size = 0.04;
constexpr double tool_size = 0.012;
constexpr double stiffness = 1e9;

Vector3 to_vector(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

SurfaceSamples tool_samples(double spacing) {
  const SparseCubeByHand tool(tool_size);
  return *sample_surface(tool.view, spacing);
}

Isometry3d at(double x, double y, double z) { return Isometry3d(Eigen::Translation3d(x, y, z)); }

/// Pose of the tool, pressed this deep into the middle of the upper face.
Isometry3d pressed_by(double depth) { return at(0, 0, (field_size + tool_size) / 2 - depth); }

/// The contact of all finest samples, queried one by one.
ContactSum every_sample(const SurfaceSamples& tool, const Isometry3d& pose,
                        std::span<const ContactObject> objects) {
  ContactSum sum;
  for (const ContactObject& object : objects) {
    const Isometry3d to_object = object.pose.inverse() * pose;
    const SampleLevel& finest = tool.levels.back();
    for (std::uint32_t i = finest.first; i < finest.first + finest.count; ++i) {
      const Vector3 place = to_vector(tool.places[i].position);
      const Answer answer = query_point(*object.field, to_object * place);
      if (!(answer.distance < 0)) continue;
      sum.add(stiffness * static_cast<double>(tool.shares[i].area), -answer.distance,
              answer.distance * answer.distance, 1, object.pose.linear() * answer.normal,
              pose.linear() * place);
    }
  }
  return sum;
}

ObjectContactSettings settings(std::uint32_t objects = 1) {
  ObjectContactSettings made;
  made.stiffness = stiffness;
  made.objects = objects;
  return made;
}

Isometry3d turned(const Isometry3d& pose, const Vector3& by) {
  Isometry3d made = pose;
  if (by.norm() > 0) made.linear() = Eigen::AngleAxisd(by.norm(), by.normalized()) * pose.linear();
  return made;
}

TEST_CASE("A cube pressed on a cube is pushed back by stiffness, area and depth") {
  const SparseCubeByHand field(field_size);
  const SurfaceSamples tool = tool_samples(0.0002);
  ObjectContact contact(tool, settings());
  const std::array objects{ContactObject{&field.view, Isometry3d::Identity()}};
  constexpr double depth = 0.0005;
  const ObjectContactReport report = contact.tick(pressed_by(depth), objects);
  // The face below, and the strips beside it, which are half as deep on average.
  const double wanted = stiffness * depth * tool_size * (tool_size + 4 * depth / 2);
  CHECK(report.sum.forces().force.z() == Approx(wanted).epsilon(0.02));
  CHECK(report.sum.forces().force.head<2>().norm() < 1e-3 * wanted);
  CHECK(report.sum.forces().torque.norm() < 1e-3 * wanted * tool_size);
  CHECK(report.sum.deepest == Approx(depth).epsilon(1e-3));
  CHECK(report.sum.stiffness(2, 2) ==
        Approx(stiffness * tool_size * (tool_size + 4 * depth)).epsilon(0.04));
  CHECK(report.level + 1 == tool.levels.size());
  CHECK_FALSE(report.degraded);
  CHECK(report.tested < tool.levels.back().count);
}

TEST_CASE("Clear of all objects there is no force, and hardly a sample is asked") {
  const SparseCubeByHand field(field_size);
  const SurfaceSamples tool = tool_samples(0.0002);
  ObjectContact contact(tool, settings());
  const std::array objects{ContactObject{&field.view, Isometry3d::Identity()}};
  CHECK(contact.tick(pressed_by(-0.003), objects).tested < 100);
  const ObjectContactReport report = contact.tick(pressed_by(-0.002999), objects);
  CHECK(report.tested == 0);
  CHECK(report.sum.contacts == 0);
  CHECK(report.sum.wrench.isZero(0));
}

TEST_CASE("A tool wholly inside an object, deeper than the band, is pushed by all its surface") {
  const SparseCubeByHand field(field_size);
  const SurfaceSamples tool = tool_samples(0.0002);
  ObjectContact contact(tool, settings());
  const std::array objects{ContactObject{&field.view, Isometry3d::Identity()}};
  const Isometry3d pose = pressed_by(tool_size + 0.008);
  const ContactSum wanted = every_sample(tool, pose, objects);
  CHECK(wanted.forces().force.z() > 1);
  const ObjectContactReport report = contact.tick(pose, objects);
  CHECK(report.clearance == 0);
  CHECK((report.sum.forces().force - wanted.forces().force).norm() <
        0.01 * wanted.forces().force.norm());
}

TEST_CASE("Culling and memory of the last tick change no force: objects and tool move at random") {
  const SparseCubeByHand field(field_size), small(0.02);
  const SurfaceSamples tool = tool_samples(0.0007);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    RandomTwister random(seed);
    ObjectContact contact(tool, settings(2));
    std::array objects{ContactObject{&field.view, Isometry3d::Identity()},
                       ContactObject{&small.view, at(0.032, 0, 0.01)}};
    Isometry3d pose = at(0.015, 0, field_size / 2 + tool_size / 2);
    std::uint64_t contacts = 0;
    for (int tick = 0; tick < 150; ++tick) {
      const bool jump = tick % 50 == 49;
      const double step = jump ? 0.01 : 0.0001;
      pose = turned(pose, random.vector(jump ? 1 : 0.01));
      pose.pretranslate(random.vector(step) - Vector3(0, 0, 0.00002));
      objects[1].pose = turned(objects[1].pose, random.vector(0.005));
      objects[1].pose.pretranslate(random.vector(0.00005));
      const ObjectContactReport report = contact.tick(pose, objects);
      const ContactSum wanted = every_sample(tool, pose, objects);
      REQUIRE(report.sum.contacts == wanted.contacts);
      // Readings are kept in floats.
      REQUIRE((report.sum.wrench - wanted.wrench).norm() <= 1e-4 * wanted.wrench.norm() + 1e-6);
      REQUIRE((report.sum.stiffness - Matrix6(wanted.stiffness.selfadjointView<Eigen::Lower>()))
                  .norm() <= 1e-4 * wanted.stiffness.norm());
      contacts += wanted.contacts;
    }
    CHECK(contacts > 1000);
  }
}

TEST_CASE("Looks within the way that was told look at listed samples alone, and change no force") {
  const SparseCubeByHand field(field_size), small(0.02);
  const SurfaceSamples tool = tool_samples(0.0003);
  ObjectContact contact(tool, settings(2)), listing(tool, settings(2));
  std::array objects{ContactObject{&field.view, Isometry3d::Identity()},
                     ContactObject{&small.view, at(0.032, 0, 0.01)}};
  RandomTwister random(11);
  Isometry3d pose = turned(pressed_by(-0.0002), {0.1, 0.05, 0.3});
  TickBudget budget;
  budget.ahead = 1.5e-4;
  int listed = 0;
  std::uint64_t contacts = 0;
  for (int tick = 0; tick < 300; ++tick) {
    pose = turned(pose, random.vector(0.002));
    pose.pretranslate(Vector3(2e-5, 1e-5, 0) + random.vector(1e-5));
    if (tick % 50 == 49) objects[1].pose.pretranslate(random.vector(0.001));
    objects[1].field = tick / 20 % 3 == 2 ? nullptr : &small.view;
    const ObjectContactReport whole = contact.tick(pose, objects);
    const ObjectContactReport report = listing.tick(pose, objects, budget);
    REQUIRE(report.sum.contacts == whole.sum.contacts);
    REQUIRE((report.sum.wrench - whole.sum.wrench).norm() <= 1e-4 * whole.sum.wrench.norm());
    REQUIRE(report.level == whole.level);
    contacts += whole.sum.contacts;
    if (report.worked < whole.worked / 2) ++listed;
  }
  CHECK(contacts > 1000);
  CHECK(listed > 100);
}

TEST_CASE("The wrench is the gradient of the energy, so a closed path gains nothing") {
  const SparseCubeByHand field(field_size);
  const SurfaceSamples tool = tool_samples(0.0004);
  ObjectContact contact(tool, settings());
  const std::array objects{
      ContactObject{&field.view, turned(at(0.001, 0.002, 0), {0.2, 0.1, 0.3})}};
  const Isometry3d pose = turned(pressed_by(-0.001), {0.3, 0.2, 0.1});
  const auto energy = [&](const Isometry3d& place) {
    return contact.tick(place, objects).sum.energy;
  };
  const ContactSum sum = contact.tick(pose, objects).sum;
  REQUIRE(sum.contacts > 30);
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double step = 1e-7, turn = 1e-5;
    const Vector3 by = step * Vector3::Unit(axis);
    const double force = (energy(Isometry3d(Eigen::Translation3d(-by)) * pose) -
                          energy(Isometry3d(Eigen::Translation3d(by)) * pose)) /
                         (2 * step);
    CHECK(sum.wrench[axis] == Approx(force).margin(1e-2 * sum.wrench.head<3>().norm()));
    const Vector3 around = turn * Vector3::Unit(axis);
    const double torque =
        (energy(turned(pose, -around)) - energy(turned(pose, around))) / (2 * turn);
    CHECK(sum.wrench[3 + axis] == Approx(torque).margin(1e-2 * sum.wrench.tail<3>().norm()));
  }
}

TEST_CASE("The two levels above the finest give its force within a tenth in the mean") {
  const SparseCubeByHand field(field_size);
  const SurfaceSamples tool = tool_samples(0.00025);
  ObjectContact contact(tool, settings());
  const std::array objects{ContactObject{&field.view, Isometry3d::Identity()}};
  const auto levels = static_cast<std::uint32_t>(tool.levels.size());
  RandomTwister random(3);
  std::array<double, 2> error{};
  double whole = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Isometry3d pose =
        turned(pressed_by(-0.0004 * (1 + random.between(-1, 1))), random.vector(0.15));
    const Vector3 finest = contact.tick(pose, objects).sum.forces().force;
    whole += finest.squaredNorm();
    for (std::uint32_t coarser = 1; coarser <= 2; ++coarser) {
      TickBudget budget;
      budget.finest_level = levels - 1 - coarser;
      const ObjectContactReport report = contact.tick(pose, objects, budget);
      CHECK((report.level == budget.finest_level || report.sum.contacts == 0));
      error[coarser - 1] += (report.sum.forces().force - finest).squaredNorm();
    }
  }
  REQUIRE(whole > 0);
  CHECK(std::sqrt(error[0] / whole) < 0.05);
  CHECK(std::sqrt(error[1] / whole) < 0.10);
}

std::int64_t counted = 0;
std::int64_t count_readings() noexcept { return counted++; }

TEST_CASE("When time is over a tick ends with the levels it came to, and says so") {
  const SparseCubeByHand field(field_size);
  const SurfaceSamples tool = tool_samples(0.0001);
  ObjectContact contact(tool, settings());
  const std::array objects{ContactObject{&field.view, Isometry3d::Identity()}};
  const Isometry3d pose = pressed_by(0.0003);
  const double whole = contact.tick(pose, objects).sum.forces().force.z();
  std::uint64_t last = 0;
  for (const std::int64_t budget : {1, 30, 300, 1000}) {
    contact.forget(0);
    counted = 0;
    const ObjectContactReport report = contact.tick(pose, objects, {budget, &count_readings});
    CHECK(report.degraded);
    CHECK(report.level + 1 < tool.levels.size());
    CHECK(report.refined < 1);
    // No more than a few samples are queried between two readings of the clock.
    CHECK(report.tested <= 12 * static_cast<std::uint64_t>(budget) + 100);
    CHECK(report.tested >= last);
    last = report.tested;
    if (budget >= 300) CHECK(report.sum.forces().force.z() == Approx(whole).epsilon(0.1));
  }
}

TEST_CASE("More contacts than there is room for degrade the answer and do not spoil it") {
  const SparseCubeByHand field(field_size);
  const SurfaceSamples tool = tool_samples(0.0001);
  ObjectContactSettings narrow = settings();
  narrow.max_active = 2000;
  ObjectContact contact(tool, narrow);
  const std::array objects{ContactObject{&field.view, Isometry3d::Identity()}};
  const ObjectContactReport report = contact.tick(pressed_by(0.0003), objects);
  CHECK(report.degraded);
  CHECK(report.sum.forces().force.z() ==
        Approx(stiffness * 0.0003 * tool_size * (tool_size + 2 * 0.0003)).epsilon(0.1));
}

TEST_CASE("A field that was replaced is asked anew") {
  const SparseCubeByHand field(field_size), larger(0.05);
  const SurfaceSamples tool = tool_samples(0.0004);
  ObjectContact contact(tool, settings());
  std::array objects{ContactObject{&field.view, Isometry3d::Identity()}};
  const Isometry3d pose = pressed_by(-0.0045);  // half a millimetre deep in the larger one
  CHECK(contact.tick(pose, objects).sum.contacts == 0);
  objects[0].field = &larger.view;
  const std::uint64_t contacts = contact.tick(pose, objects).sum.contacts;
  CHECK(contacts == every_sample(tool, pose, objects).contacts);
  CHECK(contacts > 100);
}

TEST_CASE("Poses that are no numbers and objects beyond the room give no contact") {
  const SparseCubeByHand field(field_size);
  const SurfaceSamples tool = tool_samples(0.001);
  ObjectContact contact(tool, settings());
  std::array objects{ContactObject{&field.view, Isometry3d::Identity()},
                     ContactObject{&field.view, Isometry3d::Identity()}};
  const std::uint64_t contacts = contact.tick(pressed_by(0.0005), objects).sum.contacts;
  CHECK(contacts > 0);
  CHECK(contact.tick(pressed_by(0.0005), std::span(objects).first(1)).sum.contacts == contacts);
  CHECK(contact.tick(at(std::nan(""), 0, 0), objects).sum.contacts == 0);
  objects[0].pose.translation().x() = INFINITY;
  CHECK(contact.tick(pressed_by(0.0005), std::span(objects).first(1)).sum.contacts == 0);
}

TEST_CASE("Poses that scale, such as those of quaternions that are not unit, give no contact") {
  const SparseCubeByHand field(field_size);
  const SurfaceSamples tool = tool_samples(0.001);
  ObjectContact contact(tool, settings());
  std::array objects{ContactObject{&field.view, Isometry3d::Identity()}};
  Isometry3d pose = pressed_by(0.0005);
  CHECK(contact.tick(pose, objects).sum.contacts > 0);
  pose.linear() = Eigen::Quaterniond(1.1, 0, 0, 0.1).toRotationMatrix();
  CHECK(contact.tick(pose, objects).sum.contacts == 0);
  pose.linear() = 2 * Eigen::Matrix3d::Identity();
  CHECK(contact.tick(pose, objects).sum.contacts == 0);
  objects[0].pose.linear() = 0.5 * Eigen::Matrix3d::Identity();
  CHECK(contact.tick(pressed_by(0.0005), objects).sum.contacts == 0);
}

TEST_CASE("Friction that is looked at alone holds the tool as a whole look tells it") {
  const SparseCubeByHand cube(0.01);
  std::array<ContactObject, 2> objects;
  for (ContactObject& object : objects) {
    object.field = &cube.view;
    object.grip = {0.4, 0.3, 1};
  }
  objects[0].pose = Isometry3d(Eigen::AngleAxisd(0.3, Vector3::UnitZ()));
  objects[1].pose = Isometry3d(Eigen::Translation3d(0.008, 0, 0));
  ObjectContactSettings settings;
  settings.objects = 2;
  const SurfaceSamples samples = *sample_surface(SparseCubeByHand(0.006).view, 0.0005);
  ObjectContact contact(samples, settings), whole(samples, settings);
  for (int tick = 0; tick < 60; ++tick) {
    // It slides, turns and lifts off for a while.
    const double lift = tick > 30 && tick < 35 ? 1e-3 : 0;
    const Isometry3d pose = Eigen::Translation3d(1e-5 * tick, 2e-6 * tick, 0.008 - 2e-5 + lift) *
                            Eigen::AngleAxisd(1e-4 * tick, Vector3::UnitZ());
    for (ObjectContact* each : {&contact, &whole}) {
      static_cast<void>(each->tick(pose, objects));
      each->keep();
      each->settle();
    }
    REQUIRE(contact.grip_moved() == whole.grip_moved());
    ContactSum alone;
    REQUIRE(contact.grip_anew(alone));
    const ContactSum wanted = whole.tick(pose, objects).sum;
    whole.keep();
    REQUIRE(alone.contacts == wanted.contacts);
    REQUIRE(alone.wrench.isApprox(wanted.wrench, 1e-5));
    REQUIRE(alone.stiffness.isApprox(wanted.stiffness, 1e-5));
    REQUIRE(alone.energy == Approx(wanted.energy).epsilon(1e-5));
    REQUIRE(contact.patches().size() == whole.patches().size());
    for (std::size_t k = 0; k < whole.patches().size(); ++k) {
      REQUIRE(contact.patches()[k].force.isApprox(whole.patches()[k].force, 1e-5));
      REQUIRE(contact.patches()[k].torque.isApprox(whole.patches()[k].torque, 1e-5));
    }
  }
}

TEST_CASE("Two objects in one place push a tool twice as one, and a mirrored one as its picture") {
  const SparseCubeByHand field(field_size);
  const SurfaceSamples tool = tool_samples(0.0005);
  ObjectContact contact(tool, settings(2)), single(tool, settings()), mirrored(tool, settings());
  const ContactObject object{&field.view, at(0.003, 0, 0)};
  const Isometry3d pose = turned(pressed_by(0.0005), {0.05, 0.1, 0.02});
  const std::array one{object};
  const std::array both{object, object};
  const Vector6 alone = single.tick(pose, one).sum.wrench;
  CHECK(alone.norm() > 1);
  CHECK(contact.tick(pose, both).sum.wrench.isApprox(2 * alone, 1e-9));
  // A cube is its own mirror image, so the mirrored field in the same place is the same object.
  std::array picture{object};
  picture[0].pose.linear().col(0) *= -1;
  CHECK(mirrored.tick(pose, picture).sum.wrench.isApprox(alone, 1e-3));
}

}  // namespace
}  // namespace spm::object_contact_test
