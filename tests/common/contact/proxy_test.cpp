// SPDX-License-Identifier: Apache-2.0
#include "common/contact/proxy.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "common/query/query.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/common/support/mapped_cube.hpp"
#include "tests/servo/support/shape_asset.hpp"
#include "tests/support/shapes.hpp"

namespace spm::proxy_test {
namespace {

/// Shapes are made of exact triangles: 2 mm of depth, 1 mm of margin.
struct Made {
  explicit Made(const test::Shape& shape) : asset(test::shape_asset(shape)) {}
  Asset asset;
  AssetTables tables = tables_of(asset);

  [[nodiscard]] const AssetView& view() const { return tables.view(); }
};

/// Moves the hand along a line in `ticks` ticks; returns the contact of the last tick.
ProxyContact sweep(const AssetView& asset, double radius, const Vector3& from, const Vector3& to,
                   int ticks, ProxyState& state) {
  ProxyContact contact;
  for (int tick = 0; tick <= ticks; ++tick) {
    const double share = static_cast<double>(tick) / ticks;
    contact = move_proxy(asset, radius, from + share * (to - from), state);
  }
  return contact;
}

TEST_CASE("In free space the proxy is where the hand is, and feels nothing") {
  const Made box(test::box({0.02, 0.03, 0.04}));
  ProxyState state;
  for (const double speed : {0.001, 0.01}) {  // m per tick
    for (int tick = 0; tick < 50; ++tick) {
      const double turn = speed * tick / 0.03;
      const Vector3 point(0.03 * std::cos(turn), 0.03 * std::sin(turn), 0.001 * tick);
      const ProxyContact contact = move_proxy(box.view(), 0, point, state);
      CHECK_FALSE(contact.contact);
      CHECK((contact.proxy - point).norm() < 1e-6);
    }
  }
}

TEST_CASE("Pressed into a face the proxy stays on it above the hand, at any depth") {
  const Made box(test::box({0.02, 0.03, 0.04}));
  for (const double radius : {0.0, 0.5e-3}) {
    for (const double depth : {0.0001, 0.001, 0.003, 0.012}) {
      ProxyState state;
      const Vector3 over(0.002, 0.004, 0.025);
      const Vector3 deep(0.002, 0.004, 0.02 + radius - depth);
      const ProxyContact contact = sweep(box.view(), radius, over, deep, 40, state);
      REQUIRE(contact.contact);
      CHECK(contact.depth == Approx(depth).margin(1e-6));
      CHECK((contact.normal - Vector3::UnitZ()).norm() < 1e-3);
    }
  }
}

TEST_CASE("A proxy slides along a face, over its edge and down the next") {
  const Made box(test::box({0.02, 0.03, 0.04}));
  ProxyState state;
  sweep(box.view(), 0, {0.005, 0, 0.025}, {0.005, 0, 0.019}, 20, state);
  const ProxyContact along = sweep(box.view(), 0, {0.005, 0, 0.019}, {0.0085, 0, 0.019}, 90, state);
  CHECK((along.proxy - Vector3(0.0085, 0, 0.02)).norm() < 1e-6);
  const ProxyContact over = sweep(box.view(), 0, {0.0085, 0, 0.019}, {0.012, 0, 0.019}, 90, state);
  CHECK_FALSE(over.contact);
  const ProxyContact down = sweep(box.view(), 0, {0.012, 0, 0.019}, {0.009, 0, 0.01}, 200, state);
  CHECK((down.proxy - Vector3(0.01, 0, 0.01)).norm() < 1e-6);
}

TEST_CASE("A ball's proxy keeps its distance around a sphere, and the force its direction") {
  constexpr double radius = 0.01, probe = 0.5e-3;
  const Made sphere(test::sphere(radius, 4));
  ProxyState state;
  sweep(sphere.view(), probe, {0.013, 0, 0}, {0.0095, 0, 0}, 20, state);
  for (int tick = 1; tick <= 400; ++tick) {
    const double turn = 0.004 * tick;
    const Vector3 hand = 0.0095 * Vector3(std::cos(turn), std::sin(turn), 0);
    const ProxyContact contact = move_proxy(sphere.view(), probe, hand, state);
    REQUIRE(contact.contact);
    // The margin allows for the facets, which are not exactly on the sphere.
    CHECK(contact.proxy.norm() == Approx(radius + probe).margin(3e-5));
    // The facets are off by up to 4 degrees.
    CHECK(contact.normal.dot(hand.normalized()) > 0.997);
  }
}

/// Two walls that meet in a groove along y, open to +z, whose faces make this angle.
test::Shape groove(double angle) {
  const double slope = 1 / std::tan(angle / 2), wide = 0.008, low = -0.01;
  test::Shape shape;
  for (const double y : {-0.01, 0.01}) {
    for (const auto& [x, z] : {std::pair{-wide, wide * slope},
                               {0.0, 0.0},
                               {wide, wide * slope},
                               {wide, low},
                               {-wide, low}}) {
      shape.vertices.emplace_back(x, y, z);
    }
  }
  shape.triangles = {{0, 1, 4}, {1, 3, 4}, {1, 2, 3}, {5, 9, 6}, {6, 9, 8}, {6, 8, 7}};
  for (std::uint32_t k = 0; k < 5; ++k) {
    const std::uint32_t next = (k + 1) % 5;
    shape.triangles.push_back({k, k + 5, next});
    shape.triangles.push_back({next, k + 5, next + 5});
  }
  for (auto& triangle : shape.triangles) std::swap(triangle[1], triangle[2]);
  return shape;
}

TEST_CASE("In a groove a ball rests between both walls, without ripple from tick to tick") {
  constexpr double probe = 0.5e-3;
  for (const double degrees : {60.0, 90.0, 120.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    const Made made(groove(angle));
    ProxyState state;
    sweep(made.view(), probe, {0.0005, 0, 0.004}, {0, 0, -0.0005}, 200, state);
    const Vector3 rest(0, 0, probe / std::sin(angle / 2));
    for (int tick = 0; tick < 100; ++tick) {
      const Vector3 hand(1e-5 * std::sin(0.3 * tick), 5e-5 * tick, -0.0005);
      const ProxyContact contact = move_proxy(made.view(), probe, hand, state);
      INFO("angle " << degrees << ", tick " << tick);
      REQUIRE(contact.contact);
      CHECK((contact.proxy - rest - Vector3(0, hand.y(), 0)).norm() < 5e-6);
    }
  }
}

TEST_CASE("No proxy passes through a plate of 0.2 mm at 1 m/s") {
  const Made plate(test::plate({0.02, 0.02, 0.0002}));
  std::mt19937_64 bits(11);
  const auto random = [&bits](double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11U) * 0x1p-53;
  };
  int passed = 0, missed = 0;
  for (int attempt = 0; attempt < 10000; ++attempt) {
    const Vector3 aim(random(-0.008, 0.008), random(-0.008, 0.008), 0);
    Vector3 way(random(-1, 1), random(-1, 1), random(-1, -0.2));
    way *= 1e-3 / way.norm();
    const double radius = attempt % 2 == 0 ? 0 : 0.5e-3;
    ProxyState state;
    ProxyContact contact;
    const double start = random(3, 4);
    // Until the hand is 1.5 mm behind the plate, or almost beside it.
    for (double tick = -start; tick * way.z() > -0.0015; ++tick) {
      const Vector3 hand = aim + tick * way;
      if (hand.head<2>().cwiseAbs().maxCoeff() > 0.0095) break;
      contact = move_proxy(plate.view(), radius, hand, state);
      if (contact.proxy.z() < 0) ++passed;
      if (hand.z() < 0 && !contact.contact) ++missed;
    }
  }
  CHECK(passed == 0);
  CHECK(missed == 0);
}

/// A floor, and on it a wall along y, of this thickness from x = 0 on.
test::Shape walled_floor(double thickness) {
  constexpr double wide = 0.008, low = -0.01, high = 0.004;
  test::Shape shape;
  for (const double y : {-0.01, 0.01}) {
    for (const auto& [x, z] : {std::pair{-wide, 0.0},
                               {0.0, 0.0},
                               {0.0, high},
                               {thickness, high},
                               {thickness, 0.0},
                               {wide, 0.0},
                               {wide, low},
                               {-wide, low}}) {
      shape.vertices.emplace_back(x, y, z);
    }
  }
  for (const auto& [a, b, c] : {std::array{0U, 7U, 1U},
                                {1U, 7U, 6U},
                                {1U, 6U, 4U},
                                {4U, 6U, 5U},
                                {1U, 3U, 2U},
                                {1U, 4U, 3U}}) {
    shape.triangles.push_back({a, b, c});
    shape.triangles.push_back({a + 8, c + 8, b + 8});
  }
  for (std::uint32_t k = 0; k < 8; ++k) {
    const std::uint32_t next = (k + 1) % 8;
    shape.triangles.push_back({k, next, k + 8});
    shape.triangles.push_back({next, next + 8, k + 8});
  }
  return shape;
}

TEST_CASE("A proxy that slides along a floor does not pass through a thin wall on it") {
  const double thickness = GENERATE(0.0001, 0.00015, 0.0002);
  const Made walled(walled_floor(thickness));
  std::mt19937_64 bits(11);
  const auto random = [&bits](double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11U) * 0x1p-53;
  };
  int passed = 0;
  for (int attempt = 0; attempt < 1000; ++attempt) {
    Vector3 hand(-0.001 + random(0, 1e-4), 0, 0.0005);
    const Vector3 way(random(1e-5, 1e-3), random(-1e-5, 1e-5), 0);  // m a tick
    ProxyState state;
    for (const double deep = -random(0, 5e-4); hand.z() > deep; hand.z() -= 5e-5) {
      static_cast<void>(move_proxy(walled.view(), 0, hand, state));
    }
    ProxyContact contact;
    for (; hand.x() < 0.0015; hand += way) contact = move_proxy(walled.view(), 0, hand, state);
    if (contact.proxy.x() > thickness / 2) ++passed;
  }
  INFO("a wall of " << 1e3 * thickness << " mm");
  CHECK(passed == 0);
}

TEST_CASE("Along the corner of a floor and a wall a proxy takes few queries a tick") {
  const Made walled(walled_floor(0.0004));
  for (const double radius : {0.0, 0.3e-3}) {
    const double deep = radius - 0.3e-3;
    ProxyState state;
    sweep(walled.view(), radius, {-0.001, 0, 0.0005}, {-0.001, 0, deep}, 20, state);
    sweep(walled.view(), radius, {-0.001, 0, deep}, {-deep, 0, deep}, 20, state);
    std::uint32_t most = 0;
    for (int tick = 1; tick <= 50; ++tick) {
      const Vector3 hand(-deep, 1e-4 * tick, deep);
      most = std::max(most, move_proxy(walled.view(), radius, hand, state).queries);
    }
    INFO("a ball of " << 1e3 * radius << " mm: " << most << " queries");
    CHECK(most <= 8);
    CHECK((state.position - Vector3(-radius, 0.005, radius)).norm() < 1e-6);
  }
}

TEST_CASE("A proxy that is behind catches up by no more in a tick than it may") {
  const Made box(test::box({0.02, 0.03, 0.04}));
  const Vector3 hand(0.008, 0, 0.0199);
  ProxyState state{true, {-0.008, 0, 0.02}, hand, true};
  // The hand rests.
  for (int tick = 0; tick < 20; ++tick) {
    const Vector3 before = state.position;
    const ProxyContact contact = move_proxy(box.view(), 0, hand, state);
    CHECK((contact.proxy - before).norm() == Approx(proxy_catch_up).epsilon(1e-3));
    CHECK(contact.contact);
  }
  // And moves.
  const Vector3 before = state.position, moved = hand + Vector3(0, 0.0004, 0);
  const ProxyContact contact = move_proxy(box.view(), 0, moved, state);
  CHECK((contact.proxy - before).norm() ==
        Approx(proxy_catch_up + proxy_catch_up_share * 0.0004).epsilon(1e-3));
}

TEST_CASE("A proxy is lifted out of two walls in turn, in up to eight steps") {
  test::MappedCube cube(0.04);
  // A groove along y, whose walls are 60 degrees apart: what takes the proxy out of one takes it
  // into the other, half as deep.
  cube.planes = {plane_with_normal(Vector3::Zero(), Vector3(std::sqrt(0.75), 0, 0.5)),
                 plane_with_normal(Vector3::Zero(), Vector3(-std::sqrt(0.75), 0, 0.5))};
  const std::uint32_t right = cube.add_map(0), left = cube.add_map(1);
  cube.fill_with_maps(word_of_maps(right, left, {}));
  REQUIRE(query_point(cube.view, {0, 0, -1e-4}).distance == Approx(-5e-5));
  // Seven halvings leave a 128th of the first such depth.
  const auto is_lifted_from = [&](double depth) {
    ProxyState state{true, {0, 0, -depth}, {0, 0, -depth}, true};
    static_cast<void>(move_proxy(cube.view, 0, {0, 0, -depth}, state));
    return state.known;
  };
  CHECK(is_lifted_from(2e-5));
  CHECK_FALSE(is_lifted_from(1e-3));
}

TEST_CASE("A proxy that begins inside is lifted out, or where the surface is too far, not known") {
  const Made box(test::box({0.02, 0.03, 0.04}));
  ProxyState state;
  const ProxyContact near = move_proxy(box.view(), 0, {0, 0, 0.019}, state);
  CHECK(near.contact);
  CHECK((near.proxy - Vector3(0, 0, 0.02)).norm() < 1e-6);
  state = {};
  const ProxyContact deep = move_proxy(box.view(), 0, {0, 0, 0.001}, state);
  CHECK(deep.proxy.allFinite());
  CHECK((deep.contact || !state.known));
}

TEST_CASE("What is not finite forgets the proxy and gives nothing") {
  const Made box(test::box({0.02, 0.03, 0.04}));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    ProxyState state{true, Vector3(0, 0, 0.02), Vector3(0, 0, 0.02), false};
    const ProxyContact contact = move_proxy(box.view(), 0, {bad, 0, 0.019}, state);
    CHECK_FALSE(contact.contact);
    CHECK(contact.depth == 0);
    CHECK_FALSE(state.known);
  }
}

TEST_CASE("An object that moves takes its proxy along: the hand is not let through") {
  const Made plate(test::plate({0.02, 0.02, 0.0005}));
  ProxyState state;
  // The hand stands still; the plate comes from below at 0.1 m/s and moves 3 mm past it.
  for (int tick = 0; tick < 60; ++tick) {
    const Vector3 hand(0, 0, 0.003 - 1e-4 * tick);
    const ProxyContact contact = move_proxy(plate.view(), 0, hand, state);
    CHECK(contact.proxy.z() > 0);
    CHECK(contact.contact == (hand.z() < 0.00025 - 1e-9));
  }
}

TEST_CASE("The queries of a tick are bounded, and sliding takes few") {
  const Made sphere(test::sphere(0.01, 4));
  ProxyState state;
  std::uint32_t most = 0;
  for (int tick = 0; tick < 500; ++tick) {
    const double turn = 0.004 * tick;
    const ProxyContact contact =
        move_proxy(sphere.view(), 0, 0.009 * Vector3(std::cos(turn), std::sin(turn), 0.1), state);
    most = std::max(most, contact.queries);
  }
  CHECK(most <= 12);
  const ProxyContact jump = move_proxy(sphere.view(), 0, {-0.5, 0.3, 0.2}, state);
  CHECK(jump.queries <= proxy_queries + 8);
}

}  // namespace
}  // namespace spm::proxy_test
