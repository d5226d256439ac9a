// SPDX-License-Identifier: Apache-2.0
#include "servo/force/scene_force.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/smooth_change.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::scene_force_test {
namespace {

constexpr double size = 0.04;
constexpr double half = size / 2;
constexpr double tick = 1e-3;

using Assets = std::array<const AssetView*, 1>;

PlacedObject object_of(Method method, double stiffness = 1000) {
  PlacedObject object;
  object.force.method = method;
  object.force.stiffness = stiffness;
  return object;
}

/// The force on a hand that keeps its place, once what was changed has gone over.
Vector3 settled(SceneForce& force, const AssetView& asset, const Vector3& hand) {
  Vector3 last;
  for (int i = 0; i < 400; ++i) last = force.next(Assets{&asset}, hand).force;
  return last;
}

/// The largest step of the force on a hand that keeps its place, N.
double largest_step(SceneForce& force, const AssetView& asset, const Vector3& hand,
                    const Vector3& before) {
  double largest = 0;
  Vector3 last = before;
  for (int i = 0; i < 400; ++i) {
    const Vector3 next = force.next(Assets{&asset}, hand).force;
    largest = std::max(largest, (next - last).norm());
    last = next;
  }
  return largest;
}

/// A quarter turn about z: x becomes y.
Eigen::Quaterniond quarter() {
  return Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3::UnitZ()));
}

/// A hand that slides over the top of a cube, at a depth and with a step each tick (m).
Vector3 sliding(int at, double depth, double step) {
  return {-0.01 + step * at, 0.003, half - depth};
}

TEST_CASE("A scene of one object in the hand's frame gives the contact model's force to the bit") {
  const test::SparseCubeByHand cube(size);
  for (const Method method : {Method::spm, Method::proxy}) {
    EffectSettings effects;
    effects.friction = {0.5, 0.4, 2000};
    effects.damping = 2;
    effects.texture = {50e-6, 1e-3, 7};
    const ForceSettings force = object_of(method).force;
    ContactModel model({force, effects, tick, 20e-6});
    SceneForce scene(scene_of(force, effects), tick, 20e-6);
    for (int at = 0; at < 100; ++at) {
      const Vector3 point = sliding(at, 0.001 + 1e-5 * (at % 7), 1e-4);
      const ContactForce wanted = model.next(cube.view, point);
      const ContactForce found = scene.next(Assets{&cube.view}, point);
      CHECK(found.force == wanted.force);
      CHECK(found.depth == wanted.depth);
      CHECK(found.contact == wanted.contact);
    }
  }
}

TEST_CASE("What is known of the distance to a ball ends with the band, nearer by its radius") {
  const test::SparseCubeByHand cube(size, {0.002, 0.004});
  PlacedObject object = object_of(Method::spm);
  object.force.probe_radius = 0.001;
  for (const double scale : {1.0, 2.0}) {
    object.placement.scale = scale;
    // The scale makes the object larger, and neither the ball nor what is known of distances less.
    const PlacedContact contact(object, tick, 0);
    const NearSurface found = contact.near_surface(cube.view, {0.001, 0.002, scale * half + 0.003});
    CHECK(found.distance == Approx(0.002).epsilon(1e-3));
    CHECK(found.reach == Approx(scale * 0.004 - 0.001).epsilon(1e-3));
    CHECK(found.normal.isApprox(Vector3::UnitZ(), 1e-6));
  }
}

TEST_CASE("The forces of two objects add up, and the depth is that of the deeper one") {
  const test::SparseCubeByHand cube(size);
  ForceScene scene;
  scene.objects = {object_of(Method::spm), object_of(Method::spm, 500)};
  // The second stands beside the first; its face -x lies 1 mm inside the first one's face +x, and
  // it is turned, so that this face is another one of the asset's.
  scene.objects[1].placement.position = {size - 0.001, 0, 0};
  scene.objects[1].placement.rotation = quarter();
  SceneForce force(scene, tick, 0);
  const Assets assets{&cube.view};
  const ContactForce both = force.next(assets, {half - 0.0003, 0.002, 0.003});
  CHECK((both.force - Vector3(0.0003 * 1000 - 0.0007 * 500, 0, 0)).norm() < 1e-6);
  CHECK(both.depth == Approx(0.0007).epsilon(1e-4));
  CHECK(both.normal.x() == Approx(-1));
  const ContactForce first = force.next(assets, {half - 0.0015, 0.002, 0.003});
  CHECK((first.force - Vector3(1.5, 0, 0)).norm() < 1e-5);
  const ContactForce second = force.next(assets, {half + 0.0005, 0.002, 0.003});
  CHECK((second.force - Vector3(-0.75, 0, 0)).norm() < 1e-5);
  CHECK_FALSE(force.next(assets, {-half - 0.001, 0.002, 0.003}).contact);
}

TEST_CASE("Each object reads the asset that it names") {
  const test::SparseCubeByHand large(size), small(size / 2);
  ForceScene scene;
  scene.objects = {object_of(Method::spm), object_of(Method::spm)};
  scene.objects[0].asset = 1;
  scene.objects[1].asset = 0;
  scene.objects[1].placement.position = {0.1, 0, 0};
  SceneForce force(scene, tick, 0);
  const std::array<const AssetView*, 2> assets{&large.view, &small.view};
  CHECK(force.next(assets, {0.001, 0.002, size / 4 - 0.001}).force.z() == Approx(1).epsilon(1e-4));
  CHECK_FALSE(force.next(assets, {0.001, 0.002, half - 0.001}).contact);
  CHECK(force.next(assets, {0.101, 0.002, half - 0.001}).force.z() == Approx(1).epsilon(1e-4));
}

TEST_CASE("A scale makes an object larger and not softer, whatever its effects") {
  const test::SparseCubeByHand cube(size);
  constexpr double scale = 2.5;
  for (const Method method : {Method::spm, Method::proxy}) {
    PlacedObject object = object_of(method);
    object.effects.friction = {0.5, 0.4, 2000};
    object.effects.damping = 2;
    object.effects.texture = {50e-6, 1e-3, 7};
    // The same cube, two and a half times as large in the asset's own metres.
    const test::SparseCubeByHand grown(scale * size, {scale * 0.002, scale * 0.0005});
    SceneForce wanted({{}, {object}}, tick, 20e-6);
    object.placement.scale = scale;
    SceneForce found({{}, {object}}, tick, 20e-6);
    for (int at = 0; at < 100; ++at) {
      const Vector3 point(-0.01 + 1e-4 * at, 0.003, scale * half - 0.001 - 1e-5 * (at % 7));
      const ContactForce large = wanted.next(Assets{&grown.view}, point);
      const ContactForce scaled = found.next(Assets{&cube.view}, point);
      REQUIRE(scaled.contact == large.contact);
      CHECK((scaled.force - large.force).norm() < 1e-6);
      CHECK(scaled.depth == Approx(large.depth).margin(1e-9));
    }
  }
}

TEST_CASE("A probe's radius and the smoothing's are those of the world") {
  const test::SparseCubeByHand cube(size);
  PlacedObject object = object_of(Method::spm);
  object.placement.scale = 2;
  object.force.probe_radius = 0.0006;
  const ContactSettings local = in_asset_frame(object, tick, 1e-5);
  CHECK(local.force.probe_radius == Approx(0.0003));
  CHECK(local.force.stiffness == Approx(2000));
  CHECK(local.encoder_step == Approx(5e-6));
  SceneForce force({{}, {object}}, tick, 0);
  const ContactForce found = force.next(Assets{&cube.view}, {0.002, 0.003, size + 0.0004});
  CHECK(found.depth == Approx(0.0002).epsilon(1e-3));
  CHECK(found.force.z() == Approx(0.2).epsilon(1e-3));
}

TEST_CASE("A workspace turns, moves and scales the hand, and the force comes back into its frame") {
  const test::SparseCubeByHand cube(size);
  ForceScene scene;
  scene.objects = {object_of(Method::spm)};
  scene.workspace.position = {0.01, 0.02, 0.03};
  scene.workspace.rotation = quarter();
  scene.workspace.scale = 2;
  SceneForce force(scene, tick, 0);
  // A place 1 mm under the face +x of the world, 2 mm of the world being one of the hand.
  const Vector3 world(half - 0.001, 0.002, 0.003);
  const ContactForce found = force.next(Assets{&cube.view}, scene.workspace.from_world(world));
  CHECK(found.depth == Approx(0.001).epsilon(1e-4));
  // The world's x is minus the hand's y.
  CHECK((found.force - Vector3(0, -1, 0)).norm() < 1e-3);
  CHECK((found.normal - Vector3(0, -1, 0)).norm() < 1e-3);
}

TEST_CASE("No object is felt stiffer than the cap, an added or a changed one neither") {
  const test::SparseCubeByHand cube(size);
  ForceScene scene;
  scene.objects = {object_of(Method::spm, 3000)};
  scene.workspace.scale = 2;  // so that 1000 N/m of the hand are 500 of the world
  SceneForce force(scene, tick, 0, 1, {.stiffness = 1000});
  const Vector3 hand = scene.workspace.from_world({0.002, 0.003, half - 0.001});
  CHECK(force.next(Assets{&cube.view}, hand).force.z() == Approx(0.5).epsilon(1e-4));
  force.change(0, object_of(Method::spm, 2000));
  CHECK(force.next(Assets{&cube.view}, hand).force.z() == Approx(0.5).epsilon(1e-4));
  force.change(0, object_of(Method::spm, 200));
  CHECK(settled(force, cube.view, hand).z() == Approx(0.2).epsilon(1e-4));
  REQUIRE(force.add(object_of(Method::spm, 9000)));
  CHECK(settled(force, cube.view, hand).z() == Approx(0.5).epsilon(1e-4));
}

TEST_CASE("However many objects lie in one place, all together are no stiffer than the cap") {
  const test::SparseCubeByHand cube(size);
  PlacedObject object = object_of(Method::spm, 3000);
  object.effects.friction = {0.5, 0.4, 3000};
  ForceScene scene;
  scene.objects.assign(60, object);
  SceneForce many(scene, tick, 0, 0, {.stiffness = 3000});
  SceneForce one({{}, {object}}, tick, 0, 0, {.stiffness = 3000});
  for (int at = 0; at < 100; ++at) {
    const Vector3 hand = sliding(at, 1e-5 * at, 1e-5);
    const Vector3 wanted = one.next(Assets{&cube.view}, hand).force;
    CHECK((many.next(Assets{&cube.view}, hand).force - wanted).norm() < 1e-6);
  }
  CHECK(std::abs(many.reaction(7).force.z()) == Approx(3000 * 99e-5 / 60).epsilon(1e-3));
}

TEST_CASE("An object that is met while another is pressed makes no step of the force") {
  const test::SparseCubeByHand cube(size);
  ForceScene scene;
  scene.objects = {object_of(Method::spm, 3000), object_of(Method::spm, 3000)};
  scene.objects[1].placement.position = {0, 0, -0.0005};
  SceneForce force(scene, tick, 0, 0, {.stiffness = 3000});
  double last = 0;
  for (int at = 0; at < 150; ++at) {
    const double found = force.next(Assets{&cube.view}, sliding(0, 1e-5 * at, 0)).force.z();
    CHECK(found - last < 3000 * 1e-5 * 1.01);
    last = found;
  }
  CHECK(last == Approx(3000 * 149e-5).epsilon(1e-3));
}

TEST_CASE("Two walls of a groove at right angles are each as stiff as the cap allows") {
  const test::SparseCubeByHand cube(size);
  ForceScene scene;
  scene.objects = {object_of(Method::spm, 3000), object_of(Method::spm, 3000)};
  scene.objects[1].placement.position = {size - 0.002, 0, -0.001 + size};
  // Above the first and beside the second: each pushes out of its own face.
  SceneForce force(scene, tick, 0, 0, {.stiffness = 3000});
  const ContactForce corner = force.next(Assets{&cube.view}, {half - 0.0017, 0.003, half - 0.0005});
  CHECK(corner.force.x() == Approx(-3000 * 0.0003).epsilon(1e-3));
  CHECK(corner.force.z() == Approx(3000 * 0.0005).epsilon(1e-3));
}

TEST_CASE("No damping is felt above the cap, of one object or of many") {
  const test::SparseCubeByHand cube(size);
  PlacedObject object = object_of(Method::spm, 1000);
  object.effects.damping = 1000;
  for (const std::size_t count : {std::size_t{1}, std::size_t{60}}) {
    ForceScene scene;
    scene.objects.assign(count, object);
    SceneForce force(scene, tick, 0, 0, {.stiffness = 3000, .damping = 20});
    Vector3 found;
    for (int at = 0; at < 50; ++at) {
      found = force.next(Assets{&cube.view}, sliding(at, 0.001, 1e-4)).force;
    }
    CHECK(std::abs(found.x()) <= 20 * 0.1 * 1.001);
  }
}

TEST_CASE("A hand pressed past the middle of a plate stays on its side when what is felt changes") {
  const test::SparseCubeByHand plate(0.001, {0.0005, 0.0005});
  const Vector3 above(0.0001, 0.0001, 0.0006), pressed(0.0001, 0.0001, -0.0003);
  for (const int change : {0, 1, 2}) {
    SceneForce force({{}, {object_of(Method::proxy)}}, tick, 0);
    const Assets assets{&plate.view};
    (void)force.next(assets, above);
    for (int at = 0; at < 100; ++at) {
      (void)force.next(assets, above + at / 99.0 * (pressed - above));
    }
    REQUIRE(force.next(assets, pressed).force.z() == Approx(0.8).epsilon(0.01));
    if (change == 0) force.change(0, object_of(Method::proxy, 1500));
    if (change == 1) force.stabilize(recommended_stabilization);
    if (change == 2) force.exchange();
    CHECK(force.next(assets, pressed).force.z() > 0.75);
  }
}

TEST_CASE("After ticks that were skipped a hand is as fast as it is") {
  const test::SparseCubeByHand cube(size);
  PlacedObject object = object_of(Method::spm);
  object.effects.damping = 5;
  SceneForce force({{}, {object}}, tick, 0);
  for (int at = 0; at < 20; ++at) (void)force.next(Assets{&cube.view}, sliding(at, 0.001, 2e-4));
  const Vector3 after = force.next(Assets{&cube.view}, sliding(25, 0.001, 2e-4), 6).force;
  CHECK(after.x() == Approx(-5 * 0.2).epsilon(1e-3));
}

TEST_CASE("Friction, damping and texture each belong to their own object") {
  const test::SparseCubeByHand cube(size);
  ForceScene scene;
  scene.objects = {object_of(Method::spm), object_of(Method::spm)};
  scene.objects[0].effects.friction = {0.4, 0.4, 5000};
  scene.objects[1].placement.position = {0.1, 0, 0};
  SceneForce force(scene, tick, 0);
  const Assets assets{&cube.view};
  ContactForce rough, smooth;
  for (int at = 0; at < 60; ++at) rough = force.next(assets, sliding(at, 0.001, 1e-4));
  CHECK(rough.force.x() == Approx(-0.4).epsilon(1e-4));
  for (int at = 0; at < 60; ++at) {
    smooth = force.next(assets, sliding(at, 0.001, 1e-4) + Vector3(0.1, 0, 0));
  }
  CHECK(smooth.force.x() == Approx(0).margin(1e-9));
  CHECK(smooth.force.z() == Approx(1).epsilon(1e-4));
}

TEST_CASE("An object that was skipped while the hand was far answers as if it had been asked") {
  const test::SparseCubeByHand cube(size);
  const Assets assets{&cube.view};
  for (const Method method : {Method::spm, Method::proxy}) {
    PlacedObject object = object_of(method);
    object.effects.damping = 2;
    SceneForce scene({{}, {object}}, tick, 0);
    ContactModel asked(in_asset_frame(object, tick, 0));
    // In from 10 mm above at 0.5 m/s, along at 1.5 mm below the surface, and out again.
    for (int at = 0; at < 80; ++at) {
      const double height = std::max(0.01 - 5e-4 * at, -0.0015) + std::max(0.0, 5e-4 * (at - 60));
      const Vector3 point(-0.01 + 1e-4 * at, 0.003, half + height);
      const ContactForce wanted = asked.next(cube.view, point);
      const ContactForce found = scene.next(assets, point);
      CHECK(found.contact == wanted.contact);
      CHECK((found.force - wanted.force).norm() < 1e-9);
    }
  }
}

TEST_CASE("A proxy holds a hand that crosses the whole object between two ticks") {
  const test::SparseCubeByHand cube(0.001);
  const Assets assets{&cube.view};
  SceneForce force({{}, {object_of(Method::proxy)}}, tick, 0);
  CHECK_FALSE(force.next(assets, {1e-4, 1e-4, 0.004}).contact);
  const ContactForce held = force.next(assets, {1e-4, 1e-4, -0.004});
  CHECK(held.contact);
  CHECK(held.force.z() > 1);
  CHECK(force.next(assets, {1e-4, 1e-4, -0.005}).force.z() > held.force.z());
}

TEST_CASE("An object that moves into a still hand pushes as if the hand had moved into it") {
  const test::SparseCubeByHand cube(size);
  for (const Method method : {Method::spm, Method::proxy}) {
    const ForceScene scene{{}, {object_of(method)}};
    SceneForce pressed(scene, tick, 0), met(scene, tick, 0);
    const Vector3 start(0.002, 0.003, half + 5e-4);
    for (int at = 0; at < 150; ++at) {
      const double way = 1e-5 * at;
      met.place(0, Vector3(0, 0, way), Eigen::Quaterniond::Identity());
      const ContactForce wanted = pressed.next(Assets{&cube.view}, start - Vector3(0, 0, way));
      const ContactForce found = met.next(Assets{&cube.view}, start);
      CHECK((found.force - wanted.force).norm() < 1e-9);
      CHECK(found.contact == wanted.contact);
    }
  }
}

TEST_CASE("What holds a hand moves with its object: carried together, the force stays") {
  const test::SparseCubeByHand cube(size);
  for (const Method method : {Method::spm, Method::proxy}) {
    PlacedObject object = object_of(method);
    object.effects.friction = {0.5, 0.4, 2000};
    SceneForce scene({{}, {object}}, tick, 0);
    const Vector3 held(0.002, 0.003, half - 1e-3);
    static_cast<void>(scene.next(Assets{&cube.view}, Vector3(0.002, 0.003, half + 1e-4)));
    const ContactForce first = scene.next(Assets{&cube.view}, held);
    REQUIRE(first.contact);
    for (int at = 1; at < 100; ++at) {
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(1e-3 * at, Vector3(1, 2, 3).normalized()));
      const Vector3 moved(1e-4 * at, -5e-5 * at, 2e-5 * at);
      scene.place(0, moved, turn);
      const ContactForce found = scene.next(Assets{&cube.view}, moved + turn * held);
      CHECK((found.force - turn * first.force).norm() < 1e-6);
    }
  }
}

TEST_CASE("Objects come and go while there is room, and one that went pushes no more") {
  const test::SparseCubeByHand cube(size);
  SceneForce scene({{}, {object_of(Method::spm)}}, tick, 0, 2);
  PlacedObject second = object_of(Method::spm);
  second.placement.position = {0.1, 0, 0};
  REQUIRE(scene.add(second) == std::size_t{1});
  REQUIRE(scene.add(second) == std::size_t{2});
  CHECK_FALSE(scene.add(second));
  const Vector3 pressed(0.102, 0.003, half - 1e-3);
  const double both = scene.next(Assets{&cube.view}, pressed).force.norm();
  scene.remove(1);
  CHECK(settled(scene, cube.view, pressed).norm() == Approx(both / 2));
  CHECK(scene.add(second) == std::size_t{1});
  scene.remove(1);
  scene.remove(2);
  CHECK(settled(scene, cube.view, pressed).isZero());
  scene.remove(7);
  scene.place(7, Vector3::Zero(), Eigen::Quaterniond::Identity());
  CHECK(scene.size() == 3);
}

TEST_CASE("What happens to an object that is pressed makes no step of the force") {
  const test::SparseCubeByHand cube(size);
  const Vector3 hand(0.002, 0.003, half - 2e-3);
  const double most = change_rate * tick + 1e-9;
  SceneForce force({{}, {object_of(Method::proxy, 2000)}}, tick, 0, 2);
  Vector3 before = settled(force, cube.view, hand);
  CHECK(before.z() == Approx(4).epsilon(1e-4));
  const auto steps = [&] {
    const double largest = largest_step(force, cube.view, hand, before);
    before = force.next(Assets{&cube.view}, hand).force;
    return largest;
  };
  force.change(0, object_of(Method::proxy, 500));
  CHECK(steps() <= most);
  CHECK(before.z() == Approx(1).epsilon(1e-4));
  force.change(0, object_of(Method::proxy, 2000));
  CHECK(steps() <= most);
  force.change(0, object_of(Method::spm, 1000));
  CHECK(steps() <= most);
  CHECK(before.z() == Approx(2).epsilon(1e-4));
  REQUIRE(force.add(object_of(Method::proxy, 1000)) == std::size_t{1});
  CHECK(steps() <= most);
  CHECK(before.z() == Approx(4).epsilon(1e-4));
  PlacedObject away = object_of(Method::spm, 1000);
  away.placement.position.x() = 1;
  force.change(0, away);
  CHECK(steps() <= most);
  StabilizationSettings other;
  other.damping_share = 0.5;
  other.passivity = true;
  force.stabilize(other);
  CHECK(steps() <= most);
  force.remove(1);
  CHECK(steps() <= most);
  CHECK(before.isZero());
}

TEST_CASE("An object that is removed gives back no more than was pressed into it") {
  const test::SparseCubeByHand cube(size);
  SceneForce force({{}, {object_of(Method::proxy, 2000)}}, tick, 0);
  // J: in by 2 mm within 40 ms, removed there, and out as fast.
  double energy = 0, before = 0;
  for (int i = 0; i <= 80; ++i) {
    if (i == 40) force.remove(0);
    const double depth = 5e-5 * (i <= 40 ? i : 80 - i);
    const double now = force.next(Assets{&cube.view}, {0.002, 0.003, half - depth}).force.z();
    if (i > 0) energy += 0.5 * (before + now) * (i <= 40 ? -5e-5 : 5e-5);
    before = now;
  }
  CHECK(energy <= 0);
  CHECK(energy > -0.5 * 2000 * 4e-6);
}

TEST_CASE("What a hand does to an object is told about the object's own origin") {
  const test::SparseCubeByHand cube(size);
  PlacedObject object = object_of(Method::spm);
  object.placement.position = {0.1, 0.2, 0.3};
  SceneForce scene({{}, {object}}, tick, 0);
  const Vector3 from_origin(0.004, 0.003, half - 1e-3);
  const ContactForce found =
      scene.next(Assets{&cube.view}, object.placement.position + from_origin);
  REQUIRE(found.contact);
  CHECK(scene.reaction(0).force == -found.force);
  CHECK((scene.reaction(0).torque + from_origin.cross(found.force)).norm() < 1e-12);
  static_cast<void>(scene.next(Assets{&cube.view}, Vector3(1, 1, 1)));
  CHECK(scene.reaction(0).force.isZero());
}

TEST_CASE("Positions that are not finite or far beyond any object give nothing") {
  const test::SparseCubeByHand cube(size);
  PlacedObject object = object_of(Method::spm);
  object.effects.damping = 1;
  SceneForce force({{}, {object, object}}, tick, 0);
  const Assets assets{&cube.view};
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::max()}) {
    static_cast<void>(force.next(assets, sliding(0, 0.001, 0)));
    const ContactForce none = force.next(assets, {bad, 0, half});
    CHECK(none.force == Vector3::Zero());
    CHECK_FALSE(none.contact);
    CHECK(force.next(assets, sliding(0, 0.001, 0)).force.allFinite());
  }
}

TEST_CASE("By the paper's letter a scene has friction, damping and noise of eq. 17 to 19") {
  const test::BoxByHand box({size, size, size});
  PlacedObject object = object_of(Method::paper);
  object.effects.friction_force = 0.3;
  object.effects.friction_depth = 100;
  object.effects.damping = 2;
  object.placement.scale = 2;
  SceneForce force({{}, {object}}, tick, 0);
  const Assets assets{&box.view};
  static_cast<void>(force.next(assets, {0.001, 0.002, size - 0.001}));
  const ContactForce found = force.next(assets, {0.0011, 0.002, size - 0.001});
  CHECK(found.force.z() == Approx(1));
  CHECK(found.force.x() == Approx(-0.3 * (1 + 100 * 0.001) - 2 * 0.1));
}

}  // namespace
}  // namespace spm::scene_force_test
