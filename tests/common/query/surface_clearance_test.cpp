// SPDX-License-Identifier: Apache-2.0
#include "common/query/surface_clearance.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tests/support/asset_by_hand.hpp"
#include "tests/support/tree_by_hand.hpp"

namespace spm::surface_clearance_test {
namespace {

constexpr double size = 0.04;

/// The tree of a cube of tiles with the boxes of its faces.
void fit_boxes(test::TiledCubeByHand& cube) {
  std::vector<test::BoxedChild> leaves;
  for (std::uint32_t k = 0; k < 6; ++k) {
    test::BoxedChild leaf = test::tile_child(k);
    (k % 2 == 0 ? leaf.low : leaf.high)[k / 2] = k % 2 == 0 ? 255 : 0;
    leaves.push_back(leaf);
  }
  cube.bvh = test::bvh_over(leaves);
  cube.refresh();
}

TEST_CASE("The clearance by boxes is never more than the distance, and is it where boxes fit") {
  test::TiledCubeByHand cube(size);
  fit_boxes(cube);
  std::mt19937_64 bits(5);
  const auto one = [&bits] {
    return (static_cast<double>(bits() >> 11U) * 0x1p-53 - 0.5) * 3 * size;
  };
  for (int trial = 0; trial < 5000; ++trial) {
    const Vector3 point(one(), one(), one());
    const Vector3 off = point.cwiseAbs() - Vector3::Constant(size / 2);
    const double wanted = off.maxCoeff() < 0 ? -off.maxCoeff() : off.cwiseMax(0).norm();
    const double clearance = box_clearance(cube.view, point);
    REQUIRE(clearance <= wanted);
    REQUIRE(clearance == Approx(wanted).margin(1e-6));
  }
}

TEST_CASE("The clearance by elements is never more than the distance and no less than 0.8 of it") {
  const test::TiledCubeByHand cube(size);
  std::mt19937_64 bits(6);
  const auto one = [&bits] {
    return (static_cast<double>(bits() >> 11U) * 0x1p-53 - 0.5) * 3 * size;
  };
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 point(one(), one(), one());
    const Vector3 off = point.cwiseAbs() - Vector3::Constant(size / 2);
    const double wanted = off.maxCoeff() < 0 ? -off.maxCoeff() : off.cwiseMax(0).norm();
    const double clearance = surface_clearance(cube.view, point);
    REQUIRE(clearance <= wanted);
    REQUIRE(clearance >= 0.8 * wanted - 1.1 * cube.view.tolerance);
  }
  CHECK(surface_clearance(cube.view, Vector3::Constant(std::nan(""))) == 0);
}

TEST_CASE("A tree too large to be opened whole still gives a bound") {
  test::TiledCubeByHand cube(size);
  std::vector<test::BoxedChild> leaves(400, test::tile_child(4));  // a chain of 134 nodes
  cube.bvh = test::bvh_over(leaves);
  cube.refresh();
  CHECK(box_clearance(cube.view, {0, 0, 0.03}) == Approx(0.01).margin(1e-6));
  CHECK(box_clearance(cube.view, {0, 0, 0}) == 0);
}

TEST_CASE("Without elements the clearance is infinite, and words that lead astray give a number") {
  test::TiledCubeByHand cube(size);
  cube.bvh.clear();
  cube.refresh();
  CHECK(std::isinf(box_clearance(cube.view, {0, 0, 0})));
  std::mt19937_64 bits(9);
  for (int trial = 0; trial < 500; ++trial) {
    cube.bvh.resize(50);
    for (std::uint32_t& word : cube.bvh) word = static_cast<std::uint32_t>(bits());
    cube.refresh();
    CHECK(box_clearance(cube.view, {0, 0, 0.03}) >= 0);
  }
  CHECK(box_clearance(cube.view, Vector3::Constant(std::nan(""))) >= 0);
}

}  // namespace
}  // namespace spm::surface_clearance_test
