// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/cluster_sums.hpp"

#include <array>
#include <catch2/catch.hpp>

namespace spm::cluster_sums_test {
namespace {

constexpr std::array<double, 3> nothing{0, 0, 0};

TEST_CASE("The change of a cluster is how far its sums on two levels are apart") {
  ClusterSums sums;
  sums.begin();
  sums.add(2, {1, 0, 0}, {0, 0.5, 0});
  sums.add(2, {2, 0, 0}, nothing);
  sums.add(7, {0, 1, 0}, nothing);
  sums.end_level();
  // Of the first level there is nothing above.
  REQUIRE(sums.changes().size() == 2);
  CHECK(sums.changes()[0].key == 2);
  CHECK(sums.changes()[0].force == 3);
  CHECK(sums.changes()[0].torque == 0.5F);
  sums.add(2, {3, 4, 0}, {0, 0.5, 2});
  sums.add(5, {0, 0, 1}, nothing);
  sums.end_level();
  REQUIRE(sums.changes().size() == 3);
  CHECK(sums.changes()[0].force == 4);
  CHECK(sums.changes()[0].torque == 2);
  // One that begins to press, and one that presses no more.
  CHECK(sums.changes()[1].key == 5);
  CHECK(sums.changes()[1].force == 1);
  CHECK(sums.changes()[2].key == 7);
  CHECK(sums.changes()[2].force == 1);
  sums.begin();
  sums.end_level();
  CHECK(sums.changes().empty());
}

TEST_CASE("As many clusters as there is room for need no more memory, on any number of levels") {
  ClusterSums sums;
  constexpr std::uint32_t room = 100;
  sums.reserve(room);
  const std::size_t bytes = sums.bytes();
  sums.begin();
  for (std::uint32_t level = 0; level < 3; ++level) {
    // None of them is of the level above.
    for (std::uint32_t k = 0; k < room; ++k) sums.add(2 * k + level % 2, {1, 0, 0}, nothing);
    sums.end_level();
    CHECK(sums.changes().size() == (level > 0 ? 2 : 1) * room);
  }
  CHECK(sums.bytes() == bytes);
}

}  // namespace
}  // namespace spm::cluster_sums_test
