// SPDX-License-Identifier: Apache-2.0
#include "common/query/side_votes.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

namespace spm::side_votes_test {
namespace {

constexpr double tie = 1e-5;
constexpr double rounding = 1e-6;

/// A vote at a distance whose normal meets the point at this cosine.
SideVote vote(double distance, bool inside, double cosine) {
  return {distance, inside, cosine * distance};
}

/// Whether the votes together say inside. The result must not depend on their order.
bool inside_by_votes(std::vector<SideVote> votes) {
  const auto ask = [&votes] {
    SideVotes sides(tie, rounding);
    for (const SideVote& each : votes) sides.add(each);
    return sides.inside();
  };
  const bool inside = ask();
  std::reverse(votes.begin(), votes.end());
  CHECK(ask() == inside);
  return inside;
}

TEST_CASE("The nearest vote that faces the point tells the side") {
  for (const bool inside : {false, true}) {
    CHECK(inside_by_votes({vote(1e-3, inside, 1)}) == inside);
    CHECK(inside_by_votes({vote(1e-3, inside, 1), vote(1.2e-3, !inside, 1)}) == inside);
    CHECK(inside_by_votes({vote(1e-3, inside, 1), vote(1.0001e-3, !inside, 1)}) == inside);
  }
}

TEST_CASE("At an edge the vote that faces the point more tells the side") {
  for (const bool inside : {false, true}) {
    CHECK(inside_by_votes({vote(1e-3, inside, 0.9), vote(1e-3, !inside, 0.3)}) == inside);
    // The edge of one of the two is a little off.
    CHECK(inside_by_votes({vote(1.003e-3, inside, 0.9), vote(1e-3, !inside, 0.3)}) == inside);
  }
}

TEST_CASE("A border that is nearest gives way to a vote within a tie that faces the point") {
  CHECK(inside_by_votes({vote(1e-3, false, 0), vote(1e-3 + 0.9 * tie, true, 1)}));
  CHECK_FALSE(inside_by_votes({vote(1e-3, true, 0), vote(1e-3 + 0.9 * tie, false, 1)}));
}

TEST_CASE("A farther vote that faces the point does not beat a nearer one beyond the tie") {
  for (const double cosine : {0.0, 0.1, 0.5, 1.0}) {
    CHECK(inside_by_votes({vote(1e-3, true, cosine), vote(1e-3 + 1.01 * tie, false, 1)}));
    CHECK_FALSE(inside_by_votes({vote(1e-3, false, cosine), vote(1e-3 + 1.01 * tie, true, 1)}));
  }
}

TEST_CASE("On the surface itself its own vote tells the side") {
  CHECK(inside_by_votes({vote(0, true, 0), vote(1e-6, false, 1)}));
}

TEST_CASE("Votes beyond the limit change nothing, and the limit only shrinks") {
  SideVotes sides(tie, rounding);
  CHECK(sides.limit() == std::numeric_limits<double>::infinity());
  sides.add(vote(1e-3, true, 0.25));
  const double sine = std::sqrt(1 - 0.25 * 0.25);
  const double first = 1e-3 + sine * std::sqrt(sine) * tie;
  CHECK(sides.limit() == Approx(first));
  sides.add(vote(1.0001 * sides.limit(), false, 1));
  CHECK(sides.inside());
  sides.add(vote(0.9999 * sides.limit(), false, 1));
  CHECK_FALSE(sides.inside());
  const double limit = sides.limit();
  CHECK(limit < first);
  sides.add(vote(2e-3, true, 1));
  CHECK(sides.limit() == limit);
}

TEST_CASE("Of triangles only those count that are for the side they tell among themselves") {
  const Vector3 closest_point(0, 0, 0), behind(0, 0, -2 * rounding);
  const Vector3 left(-1, 0, 0), right(1, 0, 0);
  const std::array<Vector3, 3> front{left, right, Vector3(0, -1, -0.1)};
  const std::array<Vector3, 3> back{right, left, Vector3(0, 1, -0.1)};
  for (const bool inside : {false, true}) {
    SideVotes sides(tie, rounding);
    // A crack: the other wall faces the point a little more, and is a little farther.
    sides.add_exact(vote(1e-3 + 2 * rounding, !inside, 1), front, behind);
    for (const auto& face : {front, back})
      sides.add_exact(vote(1e-3, inside, 0.999), face, closest_point);
    CHECK(sides.inside() == inside);
    CHECK(sides.margin() == std::numeric_limits<double>::infinity());
    // A fitted surface is not bound by that.
    sides.add(vote(0.9e-3, !inside, 1));
    CHECK(sides.inside() != inside);
  }
}

TEST_CASE("A vote that is no number says nothing") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const SideVote& wrong : {SideVote{nan, true, 1}, SideVote{1e-3, true, nan},
                                SideVote{std::numeric_limits<double>::infinity(), true, 0}}) {
    CHECK_FALSE(inside_by_votes({wrong, vote(1e-3, false, 0.5)}));
  }
}

}  // namespace
}  // namespace spm::side_votes_test
