// SPDX-License-Identifier: Apache-2.0
#include "common/query/band_distance.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/field/octree_leaves.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/random.hpp"

using namespace spm;
using spm::test::RandomTwister;
using spm::test::SparseCubeByHand;

TEST_CASE("The distance to the band is that to the nearest of all cubes that are not far") {
  const SparseCubeByHand cube(0.04);
  const DistanceOctree& octree = cube.view.octree;
  RandomTwister random(5);
  constexpr double most = 0.01;
  int between = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 point = random.vector(0.05);
    double nearest = most;
    visit_leaves(octree, [&](const Leaf& leaf) {
      if (leaf.kind == OctreeKind::far) return;
      const Vector3 apart = ((point - leaf.middle).cwiseAbs() - Vector3::Constant(leaf.half))
                                .cwiseMax(Vector3::Zero());
      nearest = std::min(nearest, apart.norm());
    });
    const double told = distance_to_band(octree, point, most);
    REQUIRE(told <= nearest);
    REQUIRE(told == Approx(nearest).margin(1e-12).epsilon(1e-8));
    if (nearest > 0 && nearest < most) ++between;
  }
  CHECK(between > 100);
}
