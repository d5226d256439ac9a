// SPDX-License-Identifier: GPL-3.0-or-later
// How far answers jump where leaves of the octree meet.
#include "baker/verify/border_jumps.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <optional>

#include "baker/pipeline/bake.hpp"
#include "common/contact/proxy.hpp"
#include "common/field/octree_leaves.hpp"
#include "common/query/query.hpp"
#include "formats/asset/asset_writer.hpp"
#include "tests/baker/pipeline/bake_support.hpp"
#include "tests/baker/verify/spoilt_asset.hpp"
#include "tests/support/shapes.hpp"

namespace spm::baker::border_jumps_test {
namespace {

constexpr double tolerance = 100e-6;

/// A baked shape and its exact surface.
struct Baked {
  Mesh mesh;
  Asset asset;
  ExactSurface exact;

  explicit Baked(const test::Shape& shape, std::optional<std::uint64_t> bytes = {})
      : mesh(test::mesh_of(shape)), asset(baked(mesh, bytes)), exact(mesh) {}

  [[nodiscard]] JumpReport jumps(std::uint64_t seed, std::uint64_t count = 20000) const {
    const AssetTables tables = tables_of(asset);
    return border_jumps({exact, tables.view(), asset.metadata.band, tolerance, seed}, count);
  }

  [[nodiscard]] static Asset baked(const Mesh& mesh, std::optional<std::uint64_t> bytes) {
    BakeOptions options;
    options.tolerance = tolerance;
    options.max_depth = 1e-3;
    options.max_bytes = bytes;
    return bake(mesh, options).asset;
  }
};

test::Shape sphere() { return test::sphere(0.02, 3); }
test::Shape box() { return test::box({0.03, 0.02, 0.01}); }

}  // namespace

TEST_CASE("Answers of a baked sphere and of a baked box jump by at most twice the tolerance") {
  for (const test::Shape& shape : {sphere(), box()}) {
    const Baked baked(shape);
    const JumpReport found = baked.jumps(1);
    CHECK(found.places > 19000);
    CHECK(found.borders > 100);
    CHECK(found.borders <= found.places);
    CHECK(found.allowed == Approx(200e-6).epsilon(1e-3));
    CHECK(found.beyond == 0);
    CHECK(found.distance.max > 0);
    CHECK(found.distance.max <= found.allowed);
  }
}

TEST_CASE("Directions that jump at the medial surface of a thin lens are told apart") {
  test::Shape lens = test::sphere(0.015, 4);
  for (Vector3& vertex : lens.vertices) vertex[2] *= 0.08;
  const JumpReport found = Baked(lens).jumps(1);
  CHECK(found.contested > 0);
  CHECK(found.contested < found.places);
  // Across it the truth turns by almost 180 degrees.
  CHECK(found.contested_direction.max > 1.4);
  CHECK(found.direction.p99 < 0.7);
}

TEST_CASE("Whatever the seed, jumps are in order and within what the tolerance allows") {
  const Baked baked(sphere());
  Vector3 worst = Vector3::Zero();
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const JumpReport found = baked.jumps(seed, 4000);
    INFO("seed " << seed);
    CHECK(found.beyond == 0);
    CHECK(found.distance.p50 <= found.distance.p99);
    CHECK(found.distance.p99 <= found.distance.max);
    CHECK(found.direction.p50 <= found.direction.p99);
    CHECK(found.direction.p99 <= found.direction.max);
    CHECK(found.borders <= found.places);
    CHECK(found.places <= 4000);
    CHECK(found.worst_point != worst);
    worst = found.worst_point;
  }
}

TEST_CASE("A distance map that is off shows as jumps on the faces of its cube") {
  Baked baked(sphere());
  constexpr double by = 500e-6;
  const Leaf spoilt = test::spoil_largest_map(baked.asset, by);
  const JumpReport found = baked.jumps(3);
  CHECK(found.beyond > 0);
  // Heights are along the plane's normal, and distances are shorter.
  CHECK(found.distance.max > 0.9 * by - 2 * tolerance);
  CHECK(found.distance.max < by + 2 * tolerance);
  const double from = (found.worst_point - spoilt.middle).lpNorm<Eigen::Infinity>();
  CHECK(from == Approx(spoilt.half).epsilon(1e-6));
}

TEST_CASE("A jump that the tolerance allows holds no proxy that slides over it") {
  Baked baked(sphere());
  const Leaf spoilt = test::spoil_largest_map(baked.asset, 180e-6);
  const AssetTables tables = tables_of(baked.asset);
  const Vector3 over = spoilt.middle.normalized();
  const Vector3 along = over.unitOrthogonal(), beside = over.cross(along);
  for (int way = 0; way < 8; ++way) {
    const double turn = way * std::numbers::pi / 4;
    const Vector3 towards = std::cos(turn) * along + std::sin(turn) * beside;
    ProxyState state;
    ProxyContact contact;
    for (int tick = -600; tick < 600; ++tick) {
      const double angle = 1e-3 * tick;
      const Vector3 hand = 0.0193 * (std::cos(angle) * over + std::sin(angle) * towards);
      contact = move_proxy(tables.view(), 0, hand, state);
      INFO("way " << way << ", " << angle << " rad past the middle");
      if (angle > -0.5) REQUIRE(contact.depth < 1.5e-3);
    }
  }
}

TEST_CASE("A jump that the tolerance allows holds no proxy of a hand that is deep") {
  Baked baked(sphere());
  test::raise_maps(baked.asset, 180e-6, [](const Leaf& leaf) { return leaf.middle.x() < 0; });
  const AssetTables tables = tables_of(baked.asset);
  const double hand_radius = GENERATE(0.018, 0.016, 0.012);
  ProxyState state;
  ProxyContact contact;
  for (int tick = -600; tick < 600; ++tick) {
    const double angle = 1e-3 * tick;
    const Vector3 hand =
        hand_radius * (std::cos(angle) * Vector3::UnitZ() + std::sin(angle) * Vector3::UnitX());
    contact = move_proxy(tables.view(), 0, hand, state);
    INFO(angle << " rad past the jump");
    if (angle > -0.5) REQUIRE(contact.depth < 0.0203 - hand_radius);
  }
  // The hand comes to rest at the jump, and then the proxy does.
  ProxyContact before;
  for (int tick = 0; tick < 100; ++tick) {
    before = contact;
    contact = move_proxy(tables.view(), 0, hand_radius * Vector3::UnitZ(), state);
  }
  CHECK((contact.proxy - before.proxy).norm() < 1e-6);
}

TEST_CASE("A jump that is too large fails the verdict, even where no sample is off") {
  Baked baked(sphere());
  VerifyOptions options;
  options.samples = 20000;
  const auto verdict = [&] {
    const AssetTables tables = tables_of(baked.asset);
    return verify_against(baked.mesh, tables.view(), baked.asset.metadata, options);
  };
  const VerifyReport good = verdict();
  CHECK(good.passed());
  CHECK(good.jumps.places > 4900);
  (void)test::spoil_largest_map(baked.asset, 500e-6);
  VerifyReport bad = verdict();
  CHECK(bad.jumps.beyond > 0);
  bad.counts = {};
  bad.adversarial.counts = {};
  CHECK_FALSE(bad.passed());
}

}  // namespace spm::baker::border_jumps_test
