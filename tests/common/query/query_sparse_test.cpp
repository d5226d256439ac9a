// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "common/query/query.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/tree_by_hand.hpp"

namespace spm::query_sparse_test {
namespace {

using test::bvh_over;
using test::fan_child;
using test::octants;
using test::TileByHand;
using test::TiledCubeByHand;

constexpr double size = 0.04;
constexpr double half = size / 2;
constexpr float half_f = static_cast<float>(half);

/// Sets all of a cube's space to one kind.
void fill(TiledCubeByHand& cube, SignKind kind) {
  cube.sign_octree = {octants(kind), 0};
  cube.refresh();
}

/// Makes a cube an asset of lone triangles, the last of which are caps.
void replace_tiles(TiledCubeByHand& cube, const std::vector<float>& corners, std::uint32_t caps) {
  const auto count = static_cast<std::uint32_t>(corners.size() / 9);
  cube.triangles = corners;
  cube.view.first_cap = 3 * (count - caps);
  std::vector<test::BoxedChild> fans;
  for (std::uint32_t k = 0; k < count; ++k) fans.push_back(fan_child(3 * k, 1));
  cube.bvh = bvh_over(fans);
  cube.refresh();
}

/// Random places in a cube about the origin.
class Places {
 public:
  explicit Places(double edge) : edge_(edge) {}
  Vector3 next() { return {one(), one(), one()}; }

 private:
  double one() { return (static_cast<double>(bits_() >> 11U) * 0x1p-53 - 0.5) * edge_; }
  double edge_;
  std::mt19937_64 bits_{7};
};

/// Signed distance of a point to the cube.
double cube_distance(const Vector3& point) {
  const Vector3 off = point.cwiseAbs() - Vector3::Constant(half);
  return off.maxCoeff() < 0 ? off.maxCoeff() : off.cwiseMax(0).norm();
}

TEST_CASE("A tile answers with its plane and crossing") {
  TiledCubeByHand cube(size);
  cube.by_hand[2].tile.first_layer = 4;
  cube.refresh();
  const Answer answer = query_point(cube.view, {0.003, 0.019, -0.002});
  CHECK(answer.status == Status::exact);
  CHECK(answer.distance == Approx(-0.001));
  CHECK((answer.normal - Vector3::UnitY()).norm() < 1e-6);
  CHECK(answer.plane == 2);
  CHECK(answer.layer == 4);
  CHECK(answer.source == Source::map);
  CHECK(query_point(cube.view, {0.003, -0.002, 0.0203}).distance == Approx(0.0003));
}

TEST_CASE("Where the elements tell the side, a cube of tiles answers as the cube") {
  const TiledCubeByHand cube(size);
  Places places(size + 0.001);
  int exact = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Vector3 point = places.next();
    const double wanted = cube_distance(point);
    const Answer answer = query_point(cube.view, point);
    REQUIRE(answer.status != Status::pruned);
    if (answer.status == Status::far) {
      REQUIRE(wanted > cube.view.band.margin);
    } else if (answer.status == Status::deep) {
      REQUIRE(wanted < -cube.view.band.max_depth + 1e-7);
    } else {
      ++exact;
      REQUIRE(answer.distance == Approx(wanted).margin(1e-7));
    }
  }
  CHECK(exact > 1000);
}

TEST_CASE("Where the place tells the side, no element is asked for it") {
  TiledCubeByHand cube(size);
  const Vector3 below(0.003, 0.0197, -0.002), above(0.003, 0.0203, -0.002);
  for (const auto& [kind, side] :
       {std::pair(SignKind::inside, -1), std::pair(SignKind::outside, 1)}) {
    fill(cube, kind);
    CHECK(query_point(cube.view, below).distance == Approx(side * 0.0003));
    CHECK(query_point(cube.view, above).distance == Approx(side * 0.0003));
  }
  CHECK((query_point(cube.view, above).normal - Vector3::UnitY()).norm() < 1e-6);
  fill(cube, SignKind::inside);
  CHECK((query_point(cube.view, below).normal - Vector3::UnitY()).norm() < 1e-6);
}

TEST_CASE("Far and pruned places say so, and a place of no known kind is far") {
  TiledCubeByHand cube(size);
  const Vector3 point(0.003, 0.0199, -0.002);
  fill(cube, SignKind::pruned);
  CHECK(query_point(cube.view, point).status == Status::pruned);
  CHECK(std::isnan(query_point(cube.view, point).distance));
  for (const std::uint32_t kind : {3U, 5U, 6U, 8U, 15U}) {
    fill(cube, static_cast<SignKind>(kind));
    const Answer answer = query_point(cube.view, point);
    CHECK(answer.status == Status::far);
    CHECK(std::isnan(answer.distance));
    CHECK(answer.normal.isZero());
  }
}

TEST_CASE("Octants of one space answer each by its own kind") {
  TiledCubeByHand cube(size);
  cube.sign_octree = {octants(SignKind::boundary, {{0, SignKind::pruned}, {7, SignKind::split}}), 1,
                      octants(SignKind::far, {{7, SignKind::boundary}}), 0};
  cube.refresh();
  CHECK(query_point(cube.view, {-0.01, -0.01, -0.0199}).status == Status::pruned);
  CHECK(query_point(cube.view, {0.01, -0.01, -0.0199}).distance == Approx(-0.0001));
  CHECK(query_point(cube.view, {0.005, 0.005, 0.0199}).status == Status::far);
  CHECK(query_point(cube.view, {0.015, 0.015, 0.0199}).distance == Approx(-0.0001));
}

TEST_CASE("Beyond the margin the answer is far, told or outside") {
  TiledCubeByHand cube(size);
  cube.view.sign_octree.edge = 1;  // so that the point lies in it
  for (const SignKind kind : {SignKind::boundary, SignKind::outside}) {
    fill(cube, kind);
    CHECK(query_point(cube.view, {0, 0, half + 0.00049}).status == Status::exact);
    const Answer answer = query_point(cube.view, {0, 0, half + 0.00052});
    CHECK(answer.status == Status::far);
    CHECK(std::isnan(answer.distance));
    CHECK(query_point(cube.view, {0, 0.3, 0}).status == Status::far);
  }
}

TEST_CASE("Deeper than the band the answer is its bound and the normal of a near enough face") {
  TiledCubeByHand cube(size);
  for (const SignKind kind : {SignKind::boundary, SignKind::inside}) {
    fill(cube, kind);
    const Answer answer = query_point(cube.view, {0, 0.015, 0});
    CHECK(answer.status == Status::deep);
    CHECK(answer.distance == -cube.view.band.max_depth);
    CHECK((answer.normal - Vector3::UnitY()).norm() < 1e-6);
    Places places(0.035);
    for (int trial = 0; trial < 500; ++trial) {
      const Vector3 point = places.next();
      const Answer deep = query_point(cube.view, point);
      REQUIRE(deep.status == Status::deep);
      REQUIRE(deep.normal.norm() == Approx(1));
      // The face that the normal names is at most a quarter farther than the nearest.
      const double named = half - point.dot(deep.normal);
      REQUIRE(named <= -1.25 * cube_distance(point) + 1e-6);
    }
  }
}

TEST_CASE("Points that are not finite are far in the sparse form too") {
  const TiledCubeByHand cube(size);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vector3& point : {Vector3(nan, 0, 0), Vector3(0, infinity, 0),
                               Vector3(0, 0, -infinity), Vector3(1e308, 1e308, 1e308)}) {
    CHECK(query_point(cube.view, point).status == Status::far);
  }
}

TEST_CASE("Where a border is nearest, a tile within a tie that faces the point tells the side") {
  TiledCubeByHand cube(size);
  cube.by_hand[0].tile.base = 1e-6;                // the face at +x lies a little too deep
  const Vector3 point(0.0203, 0.01999995, 0.003);  // outside +x, and just below +y's own plane
  cube.refresh();
  const Answer outside = query_point(cube.view, point);
  CHECK(outside.distance == Approx(0.0003).margin(2e-7));
  CHECK((outside.normal - Vector3::UnitX()).norm() < 1e-6);
  cube.by_hand[0].tile.base = 8.5e-6;  // nearly a tie deeper, and too far to give the normal
  cube.refresh();
  CHECK(query_point(cube.view, point).distance == Approx(0.0003).margin(1e-8));
  cube.view.tolerance = 1e-7;  // now the farther one is no tie
  CHECK(query_point(cube.view, point).distance < 0);
}

TEST_CASE("A closest point that faces the point gives the normal where a border is little nearer") {
  // The left half of the face at +z is in place, the right half lies too deep.
  TiledCubeByHand tiled(size);
  tiled.by_hand[4].tile.valid = 0x0F0F0F0F0F0F0F0FU;
  tiled.by_hand[5] = tiled.by_hand[4];
  tiled.by_hand[5].tile.valid = ~tiled.by_hand[4].tile.valid;
  tiled.by_hand[5].tile.base = 3e-5;
  tiled.refresh();
  TiledCubeByHand meshed(size);
  constexpr float high = 0.02F, low = 0.02F - 3e-5F;
  replace_tiles(meshed,
                {0, -high, high, 0, high, high, -high, 0, high,  // left
                 0, -high, low, high, 0, low, 0, high, low},     // right
                0);
  // Above the right half, just beside the left one's border.
  const SupportPlane& plane = tiled.planes[4];
  const Vector3 off = 0.0001 * plane.u + 0.0003 * plane.n;
  const Vector3 point = plane.x0 + off;
  for (TiledCubeByHand* asset : {&tiled, &meshed}) {
    asset->view.tolerance = 5e-5;
    const Answer faced = query_point(asset->view, point);
    CHECK(faced.status == Status::exact);
    CHECK(faced.distance == Approx(off.norm()).margin(1e-8));
    CHECK((faced.normal - plane.n).norm() < 1e-6);
    // The right half's closest point is 1.4e-5 farther, which is now more than 0.7 tolerances.
    asset->view.tolerance = 1.5e-5;
    const Answer border = query_point(asset->view, point);
    CHECK(border.distance == Approx(off.norm()).margin(1e-8));
    CHECK((border.normal - off.normalized()).norm() < 1e-3);
  }
}

TEST_CASE("On the surface the normal is the element's own") {
  TiledCubeByHand cube(size);
  // Within a tenth of the tolerance, beyond the border of the face at +y.
  const Answer tile = query_point(cube.view, {0.003, half, half + 5e-7});
  CHECK(tile.status == Status::exact);
  CHECK(tile.normal.norm() == Approx(1));
  CHECK(std::max(tile.normal.y(), tile.normal.z()) == Approx(1));
  replace_tiles(cube, {0, 0, 0.01F, 0.01F, 0, 0.01F, 0, 0.01F, 0.01F}, 0);
  const Answer triangle = query_point(cube.view, {0.001, -5e-7, static_cast<double>(0.01F)});
  CHECK(triangle.distance == Approx(5e-7).margin(1e-9));
  CHECK((triangle.normal - Vector3::UnitZ()).norm() < 1e-9);
}

TEST_CASE("Triangles of 16-bit numbers are found where origin and step put them") {
  TiledCubeByHand cube(size);
  cube.view.triangle_origin = Vector3(-0.02, -0.02, 0.0195);
  cube.view.triangle_step = 1e-6;
  cube.view.first_cap = 3;
  cube.small_triangles = {0, 0, 0, 40000, 0, 0, 0, 40000, 0};
  cube.bvh = bvh_over({fan_child(0, 1)});
  cube.refresh();
  const Answer answer = query_point(cube.view, {-0.01, -0.01, 0.019});
  CHECK(answer.distance == Approx(-0.0005));
  CHECK(answer.source == Source::triangles);
  CHECK(answer.plane == -1);
  CHECK(answer.layer == -1);
  CHECK((answer.normal - Vector3::UnitZ()).norm() < 1e-9);
}

TEST_CASE("Each triangle of a fan is found, the first corner being every one's") {
  TiledCubeByHand cube(size);
  // Four triangles around the middle of a face, so that each covers a quarter of it.
  cube.triangles = {0,      0,      half_f, -half_f, -half_f, half_f, half_f,  -half_f, half_f,
                    half_f, half_f, half_f, -half_f, half_f,  half_f, -half_f, -half_f, half_f};
  cube.view.first_cap = 6;
  cube.bvh = bvh_over({fan_child(0, 4)});
  cube.refresh();
  for (const double x : {-0.013, 0.001, 0.012}) {
    for (const double y : {-0.011, 0.002, 0.014}) {
      CHECK(query_point(cube.view, {x, y, half - 0.0004}).distance == Approx(-0.0004).margin(1e-8));
    }
  }
  // One triangle fewer leaves its quarter open.
  cube.bvh = bvh_over({fan_child(0, 3)});
  cube.refresh();
  CHECK(query_point(cube.view, {-0.013, 0.001, half - 0.0004}).distance < -0.0008);
  CHECK(query_point(cube.view, {0.013, 0.001, half - 0.0004}).distance ==
        Approx(-0.0004).margin(1e-8));
}

TEST_CASE("At the edge of two triangles the side is that of the one that faces the point more") {
  TiledCubeByHand cube(size);
  // Two faces that meet at the edge x = y = 0.02, solid below both.
  replace_tiles(cube,
                {0.02F, 0.02F, 1, 0.02F, 0.02F, -1, -1, 0.02F, 0, 0.02F, 0.02F, -1, 0.02F, 0.02F, 1,
                 0.02F, -1, 0},
                0);
  const Answer outside = query_point(cube.view, {0.02018, 0.02024, 0});
  CHECK(outside.distance == Approx(0.0003).margin(1e-8));
  CHECK((outside.normal - Vector3(0.6, 0.8, 0)).norm() < 1e-3);
  // Outside one face, and below the plane of the other.
  CHECK(query_point(cube.view, {0.02024, 0.01999, 0}).distance == Approx(0.00024).margin(1e-8));
  CHECK(query_point(cube.view, {0, 0.0195, 0}).distance == Approx(-0.0005).margin(1e-8));
}

TEST_CASE("Beyond a sharp edge the side is outside, though a face's own plane lies above") {
  TiledCubeByHand cube(size);
  // A wedge along z that ends at x = y = 0, below y = 0.
  const std::vector<float> upper{0, 0, -0.02F, -0.02F, 0, 0, 0, 0, 0.02F};
  const std::vector<float> lower{0, 0, 0.02F, -0.02F, -0.006F, 0, 0, 0, -0.02F};
  for (const bool upper_first : {false, true}) {
    std::vector<float> both = upper_first ? upper : lower;
    const std::vector<float>& other = upper_first ? lower : upper;
    both.insert(both.end(), other.begin(), other.end());
    replace_tiles(cube, both, 0);
    const Vector3 off(0.0003, -0.00002, 0);
    const Answer answer = query_point(cube.view, off);
    CHECK(answer.distance == Approx(off.norm()).margin(1e-9));
    CHECK((answer.normal - off.normalized()).norm() < 1e-6);
    CHECK(query_point(cube.view, {-0.005, -0.0003, 0}).distance == Approx(-0.0003).margin(1e-9));
  }
}

TEST_CASE("A cap decides the side of a sparse query and carries no distance") {
  TiledCubeByHand cube(size, {0.02, 0.02});
  replace_tiles(cube,
                {-0.001F, 0, 0.01F, 0.001F, 0, 0.01F, 0, 0.001F, 0.01F,  // faces +z
                 -0.02F, -0.02F, 0, 0.02F, -0.02F, 0, 0, 0.02F, 0},      // cap, faces +z
                1);
  const Answer above = query_point(cube.view, {0, 0, 0.001});
  CHECK(above.distance == Approx(0.009).margin(1e-7));
  CHECK(above.source == Source::triangles);
  CHECK(query_point(cube.view, {0, 0, -0.001}).distance == Approx(-0.011).margin(1e-7));
  // Where the space gives the side, the cap has no effect.
  fill(cube, SignKind::inside);
  CHECK(query_point(cube.view, {0, 0, 0.001}).distance == Approx(-0.009).margin(1e-7));
}

TEST_CASE("Caps alone are no surface") {
  TiledCubeByHand cube(size);
  replace_tiles(cube, {-0.02F, -0.02F, 0, 0.02F, -0.02F, 0, 0, 0.02F, 0}, 1);
  for (const SignKind kind : {SignKind::boundary, SignKind::inside, SignKind::outside}) {
    fill(cube, kind);
    CHECK(query_point(cube.view, {0, 0, -0.0001}).status == Status::far);
  }
}

TEST_CASE("A triangle without area on a face changes neither side nor distance") {
  TiledCubeByHand cube(size);
  cube.triangles.assign(9, 0);
  cube.triangles[2] = cube.triangles[5] = cube.triangles[8] = 0.02F;
  cube.view.first_cap = 3;
  cube.bvh = bvh_over({fan_child(0, 1), test::tile_child(4)});
  cube.refresh();
  for (const double height : {0.0003, -0.0003}) {
    CHECK(query_point(cube.view, {0, 0, half + height}).distance == Approx(height).margin(1e-8));
  }
}

TEST_CASE("An asset without elements is far wherever its space is not pruned") {
  TiledCubeByHand cube(size);
  cube.bvh.clear();
  for (const SignKind kind : {SignKind::boundary, SignKind::inside, SignKind::outside}) {
    fill(cube, kind);
    CHECK(query_point(cube.view, {0, 0, 0.0199}).status == Status::far);
  }
}

TEST_CASE("Trees and tiles that were damaged under the map never lead outside it") {
  std::mt19937_64 bits(12);
  const auto random = [&bits](std::uint32_t bound) {
    return static_cast<std::uint32_t>(bits() % bound);
  };
  const Vector3 point(0.001, 0.019, 0.002);
  int answers = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    TiledCubeByHand cube(size);
    cube.small_triangles.assign(18, 1000);
    cube.view.triangle_step = 1e-6;
    cube.view.first_cap = random(3);
    for (std::uint32_t& word : cube.bvh) {
      if (trial % 3 == 0) word = static_cast<std::uint32_t>(bits());
      if (random(4) == 0) word = (word & 0xFF000000U) | random(9);
    }
    if (trial % 2 == 0) cube.sign_octree = {octants(static_cast<SignKind>(random(16))), random(3)};
    for (TileByHand& made : cube.by_hand) {
      for (std::uint16_t& height : made.heights) height = static_cast<std::uint16_t>(bits());
    }
    cube.refresh();
    const Answer answer = query_point(cube.view, point);
    const bool answered = answer.status == Status::exact || answer.status == Status::deep;
    CHECK(answered == std::isfinite(answer.distance));
    answers += answered ? 1 : 0;
  }
  CHECK(answers > 100);
}

}  // namespace
}  // namespace spm::query_sparse_test
