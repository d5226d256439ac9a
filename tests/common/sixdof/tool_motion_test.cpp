// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/tool_motion.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "common/base/random.hpp"

namespace spm::tool_motion_test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;

Isometry3d some_pose(Random& random, double turn, double way) {
  Isometry3d pose = Isometry3d::Identity();
  const Vector3 axis(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  pose.rotate(AngleAxisd(turn, axis.normalized()));
  pose.translation() = way * axis;
  return pose;
}

TEST_CASE("Many motions at once are bounds as each alone is, and hardly longer") {
  Random random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const double size = std::pow(10, random.between(-9, 0));
    const Isometry3d from = some_pose(random, random.between(0, 3), 0.1);
    const Isometry3d to = from * some_pose(random, size, 0.1 * size);
    const ToolMotion motion(from, to);
    std::vector<SamplePlace> places(37);
    for (SamplePlace& place : places) {
      for (float& x : place.position) x = static_cast<float>(random.between(-0.1, 0.1));
      place.radius = static_cast<float>(random.between(0, 0.01));
    }
    std::vector<float> ways(places.size());
    motion.of_each(places, ways);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double way = motion.of(places[i]);
      REQUIRE(static_cast<double>(ways[i]) >= way);
      REQUIRE(static_cast<double>(ways[i]) <= way * (1 + 1e-5) + 2e-6 * size);
    }
  }
}

TEST_CASE("What stands still has moved by nothing") {
  Random random(5);
  const Isometry3d pose = some_pose(random, 1, 0.1);
  const std::vector<SamplePlace> places(5, SamplePlace{{0.01F, 0.02F, 0.03F}, 0.01F});
  std::vector<float> ways(places.size(), 1);
  ToolMotion(pose, pose).of_each(places, ways);
  CHECK(ways == std::vector<float>(places.size(), 0.0F));
}

}  // namespace
}  // namespace spm::tool_motion_test
