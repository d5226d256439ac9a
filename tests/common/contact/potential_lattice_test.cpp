// SPDX-License-Identifier: Apache-2.0
#include "common/contact/potential_lattice.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "common/base/octant.hpp"
#include "tests/common/support/mapped_cube.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/octree_by_hand.hpp"

namespace spm::potential_lattice_test {
namespace {

constexpr double size = 0.04;
constexpr double half = size / 2;
constexpr double spacing = 1e-4;
const ForceSettings spring{Method::spm, PaperRule::closest_plane, 1000, 0};
constexpr RuntimeSmoothing sharp{};

/// The upper half of a cube whose top is of two patches that do not meet: beyond x = 0 it lies 60
/// um lower, within the tolerance.
class BrokenCube : public test::MappedCube {
 public:
  BrokenCube() : MappedCube(size) {
    constexpr std::uint32_t top = 4;
    REQUIRE(planes[top].n == Vector3::UnitZ());
    const std::uint32_t high = add_map(top),
                        low = add_map(top, [](const Vector3&) { return 60e-6; });
    octree.root_words = {test::root_word(OctreeKind::split, 0)};
    octree.words = {2, test::octant_kinds(OctreeKind::map)};
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      octree.words.push_back(word_of_map(is_upper(octant, 0) ? low : high));
    }
    view.tolerance = 1e-4;
    show();
  }
};

/// J, on a tool that is led round a circle below the top at x = 0, in the plane y = 3 mm.
double circle_work(const std::function<Vector3(const Vector3&)>& force, bool is_reversed) {
  constexpr int steps = 8000;
  const auto place = [&](int at) {
    const double turn = (is_reversed ? -1 : 1) * 2 * std::numbers::pi * at / steps;
    return Vector3(5e-4 * std::cos(turn), 3.01e-3, half - 8e-4 + 5e-4 * std::sin(turn));
  };
  double work = 0;
  for (int at = 0; at < steps; ++at) {
    const Vector3 from = place(at), to = place(at + 1);
    work += (force(from) + force(to)).dot(to - from) / 2;
  }
  return work;
}

TEST_CASE(
    "Where patches do not meet, a closed path gains by the field's force, not the lattice's") {
  const BrokenCube cube;
  PotentialLattice lattice(spacing);
  const auto plain = [&](const Vector3& at) { return contact_force(cube.view, spring, at).force; };
  const auto interpolated = [&](const Vector3& at) {
    const auto found = lattice.force(cube.view, spring, sharp, at);
    REQUIRE(found);
    return found->force;
  };
  CHECK(std::max(circle_work(plain, false), circle_work(plain, true)) > 3e-5);
  for (const bool is_reversed : {false, true}) {
    CHECK(std::abs(circle_work(interpolated, is_reversed)) < 3e-7);
  }
}

TEST_CASE("The lattice's force is minus the gradient of k depth^2 / 2 by its own depths") {
  const BrokenCube cube;
  PotentialLattice lattice(spacing);
  // Distances by the field at the corners; along z the interpolant of two of them.
  const Vector3 low(2 * spacing, 3 * spacing, half - 5 * spacing);
  const Vector3 at = low + Vector3(0, 0, 0.3 * spacing);
  const double below = query_point(cube.view, low).distance;
  const double above = query_point(cube.view, low + Vector3(0, 0, spacing)).distance;
  const double depth = -(below + 0.3 * (above - below));
  const auto found = lattice.force(cube.view, spring, sharp, at);
  REQUIRE(found);
  CHECK(found->force.z() == Approx(1000 * depth * (above - below) / spacing).epsilon(1e-6));
  CHECK(found->force.norm() == Approx(1000 * found->depth));
  CHECK((found->force - 1000 * found->depth * found->normal).norm() < 1e-12);
}

TEST_CASE("About an edge the direction turns with the field, and does not jump") {
  const test::SparseCubeByHand cube(size);
  PotentialLattice lattice(5e-5);
  ForceSettings ball = spring;
  ball.probe_radius = 4e-4;
  constexpr double round = 3e-4;  // from the edge, m
  constexpr int steps = 1000;
  Vector3 last = Vector3::Zero();
  double sharpest = 0, farthest = 0;
  for (int at = 0; at < steps; ++at) {
    const double turn = 0.1 + (std::numbers::pi / 2 - 0.2) * at / steps;
    const Vector3 away(std::cos(turn), 0, std::sin(turn));
    const Vector3 point = Vector3(half, 0.003, half) + round * away;
    const auto found = lattice.force(cube.view, ball, sharp, point);
    REQUIRE(found);
    REQUIRE(found->contact);
    farthest = std::max(farthest, (found->normal - away).norm());
    if (at > 0) sharpest = std::max(sharpest, (found->normal - last).norm());
    last = found->normal;
  }
  // If it were linear in each tetrahedron, it would jump by spacing / radius = 0.17.
  CHECK(farthest < 0.02);
  CHECK(sharpest < 0.02);
}

TEST_CASE("On a flat side the lattice's force is the field's, for a point and a ball") {
  const test::SparseCubeByHand cube(size);
  PotentialLattice lattice(spacing);
  for (const double radius : {0.0, 2e-4}) {
    ForceSettings settings = spring;
    settings.probe_radius = radius;
    for (int at = -5; at < 170; ++at) {
      const Vector3 point(0.002 + 3.7e-6 * at, 0.003, half + radius - 1.03e-5 * at);
      const ContactForce wanted = contact_force(cube.view, settings, point);
      const auto found = lattice.force(cube.view, settings, sharp, point);
      REQUIRE(found);
      CHECK((found->force - wanted.force).norm() < 1e-5);
      CHECK(found->depth == Approx(wanted.depth).margin(1e-8));
      CHECK(found->contact == wanted.contact);
    }
  }
}

TEST_CASE("The force depends on the place alone, whatever was asked before") {
  const BrokenCube cube;
  PotentialLattice walked(spacing);
  for (int at = 0; at < 400; ++at) {
    const Vector3 point(1e-3 * std::sin(0.7 * at), 3e-3 + 1e-4 * std::cos(1.3 * at),
                        half - 6e-4 + 5e-4 * std::sin(0.3 * at));
    PotentialLattice fresh(spacing);
    const auto wanted = fresh.force(cube.view, spring, sharp, point);
    const auto found = walked.force(cube.view, spring, sharp, point);
    REQUIRE(found.has_value() == wanted.has_value());
    if (found) CHECK(found->force == wanted->force);
  }
}

TEST_CASE("What a lattice remembers of an asset it forgets when told to") {
  const test::SparseCubeByHand large(size), small(size - 4e-4);
  PotentialLattice lattice(spacing);
  const Vector3 point(0.002, 0.003, half - 5e-4);
  CHECK(lattice.force(large.view, spring, sharp, point)->depth == Approx(5e-4));
  lattice.forget();
  CHECK(lattice.force(small.view, spring, sharp, point)->depth == Approx(3e-4));
}

TEST_CASE("A lattice pushes nowhere outside, and tells nothing where the band ends") {
  const test::SparseCubeByHand cube(size);  // the band is from 2 mm deep to 0.5 mm outside
  PotentialLattice lattice(spacing);
  for (int at = 0; at < 40; ++at) {
    const auto found =
        lattice.force(cube.view, spring, sharp, {0.002, 0.003, half + 1e-6 + 1e-5 * at});
    REQUIRE(found);
    CHECK_FALSE(found->contact);
    CHECK(found->force.isZero());
  }
  CHECK_FALSE(lattice.force(cube.view, spring, sharp, {0.002, 0.003, half + 1e-3}));
  CHECK_FALSE(lattice.force(cube.view, spring, sharp, {0.002, 0.003, half - 2.05e-3}));
}

TEST_CASE("What is no place, or too far for a lattice, gets no answer") {
  const test::SparseCubeByHand cube(size);
  PotentialLattice lattice(spacing);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity(), 1e300, 1e6}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vector3 point(0.002, 0.003, half - 1e-3);
      point[axis] = bad;
      CHECK_FALSE(lattice.force(cube.view, spring, sharp, point));
    }
  }
}

}  // namespace
}  // namespace spm::potential_lattice_test
