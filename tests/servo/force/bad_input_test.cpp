// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "servo/force/contact_model.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/octree_by_hand.hpp"

namespace spm::bad_input_test {
namespace {

constexpr double size = 0.04;
constexpr double half = size / 2;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

constexpr std::array methods{Method::spm, Method::paper, Method::proxy};

ContactSettings settings_of(Method method, double stiffness) {
  ContactSettings settings;
  settings.force.method = method;
  settings.force.stiffness = stiffness;
  settings.effects.friction = {0.6, 0.5, 2000};
  settings.effects.damping = 1;
  settings.effects.texture = {20e-6, 1e-3, 3};
  return settings;
}

/// The asset that a method can read.
struct Assets {
  test::SparseCubeByHand sparse{size};
  test::BoxByHand full{{size, size, size}};

  [[nodiscard]] const AssetView& of(Method method) const {
    return method == Method::paper ? full.view : sparse.view;
  }
};

/// Places on borders of all kinds, and out of all reach.
std::vector<Vector3> awkward_places() {
  std::vector<Vector3> places;
  for (const double x : {0.0, half, -half, half / 2, half - 0.001, half + 0.0005, half - 0.002}) {
    for (const double y : {0.0, half, half - 0.001}) {
      for (const double z : {0.0, half, -half, half - 0.001}) places.emplace_back(x, y, z);
    }
  }
  for (const double far : {1.0, 1e9, 1e300, std::numeric_limits<double>::max(), infinity, nan}) {
    places.emplace_back(far, 0, half);
    places.emplace_back(-far, far, -far);
  }
  places.emplace_back(std::numeric_limits<double>::denorm_min(), 0, half - 1e-300);
  return places;
}

TEST_CASE("On every border, on the medial axis and out of all reach the force is finite") {
  const Assets assets;
  for (const Method method : methods) {
    // One model goes on from the last place, and one begins anew at each place.
    ContactModel goes_on(settings_of(method, 1000));
    for (const Vector3& place : awkward_places()) {
      ContactModel begins(settings_of(method, 1000));
      for (ContactModel* model : {&goes_on, &begins}) {
        for (int tick = 0; tick < 3; ++tick) {
          const ContactForce contact = model->next(assets.of(method), place);
          INFO("method " << static_cast<int>(method) << " at " << place.transpose());
          CHECK(contact.force.allFinite());
          CHECK(contact.normal.allFinite());
          CHECK(std::isfinite(contact.depth));
          if (!place.allFinite()) CHECK(contact.force.isZero());
        }
      }
    }
  }
}

TEST_CASE("A hand that begins inside is pushed out, or feels nothing, but never inwards") {
  const Assets assets;
  for (const Method method : methods) {
    for (const double depth : {0.0005, 0.0015, 0.005, half}) {
      ContactSettings settings = settings_of(method, 1000);
      settings.effects = {};
      ContactModel model(settings);
      const ContactForce contact = model.next(assets.of(method), {0.001, 0.002, half - depth});
      CHECK(contact.force.z() >= 0);
      CHECK(contact.force.norm() <= 1000 * (depth + 1e-6));
    }
  }
}

TEST_CASE("Stiffness that is zero, below zero or no number gives no force") {
  const Assets assets;
  for (const Method method : methods) {
    for (const double stiffness : {0.0, -1000.0, nan, infinity}) {
      ContactModel model(settings_of(method, stiffness));
      for (const double depth : {-0.0002, 0.0005, 0.001}) {
        const ContactForce contact = model.next(assets.of(method), {0.001, 0.002, half - depth});
        CHECK(contact.force.isZero());
      }
    }
  }
}

TEST_CASE("In a place that the bake left out there is no force") {
  test::SparseCubeByHand cube(size);
  cube.octree.root_words = {test::root_word(OctreeKind::pruned, 0)};
  cube.refresh();
  for (const Method method : {Method::spm, Method::proxy}) {
    ContactModel model(settings_of(method, 1000));
    for (const double depth : {-0.0002, 0.0005, 0.001}) {
      CHECK(model.next(cube.view, {0.001, 0.002, half - depth}).force.isZero());
    }
  }
}

TEST_CASE("Two objects in one place push twice as one, each with a model of its own") {
  const Assets assets;
  for (const Method method : methods) {
    ContactModel one(settings_of(method, 1000)), other(settings_of(method, 1000));
    for (int tick = 0; tick < 20; ++tick) {
      const Vector3 point(0.001 + 1e-4 * tick, 0.002, half - 0.0005);
      CHECK(one.next(assets.of(method), point).force == other.next(assets.of(method), point).force);
    }
  }
}

TEST_CASE("An asset without triangles gives no force") {
  test::SparseCubeByHand cube(size);
  test::clear_triangles(cube.octree);
  cube.refresh();
  for (const Method method : {Method::spm, Method::proxy}) {
    ContactModel model(settings_of(method, 1000));
    CHECK(model.next(cube.view, {0.001, 0.002, half - 0.001}).force.isZero());
  }
}

}  // namespace
}  // namespace spm::bad_input_test
