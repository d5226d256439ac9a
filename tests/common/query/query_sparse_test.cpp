// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/base/octahedral.hpp"
#include "common/base/random.hpp"
#include "common/query/query.hpp"
#include "tests/common/support/mapped_cube.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/octree_by_hand.hpp"
#include "tests/support/shapes.hpp"

namespace spm::query_sparse_test {
namespace {

using test::MappedCube;
using test::SparseCubeByHand;
using test::TriangleByHand;

constexpr double size = 0.04;
constexpr double half = size / 2;
constexpr std::int32_t face = SparseCubeByHand::half_steps;

/// Makes all of a cube's space one cube of a kind, with its words.
void fill(SparseCubeByHand& cube, OctreeKind kind, const std::vector<std::uint32_t>& words = {}) {
  cube.octree.root_words = {test::root_word(kind, 0)};
  cube.octree.words = words;
  cube.refresh();
}

/// Makes a list the answer in all of a cube's space: triangles of solids, then of sheets.
void fill_with_list(SparseCubeByHand& cube, const std::vector<TriangleByHand>& triangles,
                    const std::vector<TriangleByHand>& sheets = {},
                    ListSide side = ListSide::surface) {
  test::clear_triangles(cube.octree);
  std::vector<std::uint32_t> listed, listed_sheets;
  for (const TriangleByHand& triangle : triangles) {
    listed.push_back(test::add_triangle(cube.octree, triangle));
  }
  for (const TriangleByHand& sheet : sheets) {
    listed_sheets.push_back(test::add_triangle(cube.octree, sheet));
  }
  const auto unit = test::add_list(cube.octree, listed, listed_sheets, side);
  fill(cube, OctreeKind::list, {unit.begin(), unit.end()});
}

Vector3 random_place(Random& random, double edge) {
  return {random.between(-edge / 2, edge / 2), random.between(-edge / 2, edge / 2),
          random.between(-edge / 2, edge / 2)};
}

/// Signed distance of a point to the cube.
double cube_distance(const Vector3& point) {
  const Vector3 off = point.cwiseAbs() - Vector3::Constant(half);
  return off.maxCoeff() < 0 ? off.maxCoeff() : off.cwiseMax(0).norm();
}

TEST_CASE("A distance map answers with its plane") {
  MappedCube cube(size);
  cube.fill_with_maps(word_of_map(cube.add_map(2)));
  const Answer answer = query_point(cube.view, {0.003, 0.019, -0.002});
  CHECK(answer.status == Status::exact);
  CHECK(answer.distance == Approx(-0.001));
  CHECK((answer.normal - Vector3::UnitY()).norm() < 1e-6);
  CHECK(answer.plane == 2);
  CHECK(answer.layer == -1);
  CHECK(answer.source == Source::map);
  CHECK(query_point(cube.view, {0.003, 0.0203, -0.002}).distance == Approx(0.0003));
}

TEST_CASE("A bent map answers with the distance and the normal of its tangent plane") {
  MappedCube cube(size);
  // z of a surface below the face at +z, and its slopes.
  const auto height = [](double x, double y) {
    return 0.018 + 0.1 * x - 0.2 * y - 8 * x * x + 3 * x * y + 5 * y * y;
  };
  const auto slopes = [](double x, double y) {
    return Vector3(0.1 - 16 * x + 3 * y, -0.2 + 3 * x + 10 * y, 0);
  };
  cube.fill_with_maps(word_of_map(
      cube.add_map(4, [&](const Vector3& at) { return half - height(at.x(), at.y()); })));
  constexpr double x = 0.0042, y = -0.0031;
  const Vector3 foot(x, y, height(x, y)), normal = (Vector3::UnitZ() - slopes(x, y)).normalized();
  for (const double above : {-0.0012, 0.0, 0.0004}) {
    const Answer answer = query_point(cube.view, foot + above * Vector3::UnitZ());
    REQUIRE(answer.status == Status::exact);
    CHECK(answer.distance == Approx(above * normal.z()).margin(1e-8));
    CHECK((answer.normal - normal).norm() < 1e-5);
  }
  // On the surface the direction is that of the steepest ascent of the distance.
  constexpr double step = 1e-5;
  Vector3 ascent;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 off = step * Vector3::Unit(axis);
    ascent[axis] =
        query_point(cube.view, foot + off).distance - query_point(cube.view, foot - off).distance;
  }
  CHECK((normal - ascent / (2 * step)).norm() < 1e-3);
}

TEST_CASE("Of two maps the smaller or the larger distance counts, with its own plane") {
  MappedCube cube(size);
  const std::uint32_t x = cube.add_map(0), y = cube.add_map(2);
  const Vector3 point(0.0195, 0.0192, 0.001);
  // The edge of a solid below both.
  cube.fill_with_maps(word_of_maps(x, y, {.larger = true}));
  CHECK(query_point(cube.view, point).distance == Approx(-0.0005));
  CHECK(query_point(cube.view, point).plane == 0);
  CHECK((query_point(cube.view, point).normal - Vector3::UnitX()).norm() < 1e-6);
  cube.fill_with_maps(word_of_maps(x, y, {}));
  CHECK(query_point(cube.view, point).distance == Approx(-0.0008));
  CHECK(query_point(cube.view, point).plane == 2);
}

TEST_CASE("A map of an offset surface answers with its offset added, and with the same normal") {
  constexpr float offset = -0.001F;
  MappedCube cube(size);
  const std::uint32_t own = cube.add_map(2), inner = cube.add_offset_map(2, offset);
  REQUIRE(cube.charts[inner].offset == offset);
  // Outside, between the surface and the offset surface, and below both.
  for (const double wanted : {0.0003, 0.0, -0.0004, -0.001, -0.0017}) {
    const Vector3 point(0.003, half + wanted, -0.002);
    cube.fill_with_maps(word_of_map(own));
    const Answer of_surface = query_point(cube.view, point);
    cube.fill_with_maps(word_of_map(inner));
    const Answer answer = query_point(cube.view, point);
    CHECK(answer.status == Status::exact);
    CHECK(answer.distance == Approx(wanted).margin(1e-9));
    CHECK(answer.normal == of_surface.normal);
    CHECK(answer.plane == 2);
    CHECK(answer.source == Source::map);
  }
}

TEST_CASE("Of two maps each has its own offset added") {
  MappedCube cube(size);
  const std::uint32_t x = cube.add_offset_map(0, -0.0015F), y = cube.add_map(2);
  const Vector3 point(0.0195, 0.0192, 0.001);
  cube.fill_with_maps(word_of_maps(x, y, {.larger = true}));
  CHECK(query_point(cube.view, point).distance == Approx(-0.0005).margin(1e-9));
  CHECK(query_point(cube.view, point).plane == 0);
  cube.fill_with_maps(word_of_maps(x, y, {}));
  CHECK(query_point(cube.view, point).distance == Approx(-0.0008).margin(1e-9));
  CHECK(query_point(cube.view, point).plane == 2);
  // In front of their edge.
  const Vector3 beyond(half + 0.0003, half + 0.0004, 0.001);
  cube.fill_with_maps(word_of_maps(x, y, {.larger = true, .edge = true}));
  CHECK(query_point(cube.view, beyond).distance == Approx(0.0005).margin(1e-9));
  CHECK((query_point(cube.view, beyond).normal - Vector3(0.6, 0.8, 0)).norm() < 1e-5);
}

TEST_CASE("A place whose projection is not on the map of its cube is far") {
  MappedCube cube(size);
  const std::uint32_t small = cube.add_map(2), whole = cube.add_map(2);
  cube.charts[small].columns = 3;
  const Vector3 point(0.003, 0.0199, -0.002);
  for (const std::uint32_t word :
       {word_of_map(small), word_of_maps(small, whole, {}), word_of_maps(whole, small, {}),
        word_of_map(2), word_of_maps(whole, 2, {}), word_of_map(max_named_maps)}) {
    cube.fill_with_maps(word);
    CHECK(query_point(cube.view, point).status == Status::far);
    CHECK(std::isnan(query_point(cube.view, point).distance));
  }
  cube.fill_with_maps(word_of_map(whole));
  CHECK(query_point(cube.view, point).status == Status::exact);
}

TEST_CASE("Where triangles tell the side, a cube of them answers as the cube") {
  const SparseCubeByHand cube(size);
  Random random(7);
  int exact = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Vector3 point = random_place(random, size + 0.001);
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
      REQUIRE(answer.source == Source::triangles);
    }
  }
  CHECK(exact > 1000);
}

TEST_CASE("Where the list tells the side, no triangle is asked for it") {
  SparseCubeByHand cube(size);
  const Vector3 below(0.003, 0.0197, -0.002), above(0.003, 0.0203, -0.002);
  for (const auto& [told, side] : {std::pair(ListSide::inside, -1), {ListSide::outside, 1}}) {
    cube.octree.words[1] = list_word(12, 0, told, false);
    cube.refresh();
    CHECK(query_point(cube.view, below).distance == Approx(side * 0.0003));
    CHECK(query_point(cube.view, above).distance == Approx(side * 0.0003));
    CHECK(
        (query_point(cube.view, told == ListSide::inside ? below : above).normal - Vector3::UnitY())
            .norm() < 1e-6);
  }
}

TEST_CASE("Far and pruned places say so, and a place of no known kind is far") {
  SparseCubeByHand cube(size);
  const Vector3 point(0.003, 0.0199, -0.002);
  fill(cube, OctreeKind::pruned);
  CHECK(query_point(cube.view, point).status == Status::pruned);
  CHECK(std::isnan(query_point(cube.view, point).distance));
  for (const std::uint32_t kind : {0U, 2U, 3U, 6U, 7U, 10U, 11U, 12U, 13U, 14U, 15U}) {
    fill(cube, static_cast<OctreeKind>(kind), std::vector<std::uint32_t>(16, 0));
    const Answer answer = query_point(cube.view, point);
    CHECK(answer.status == Status::far);
    CHECK(std::isnan(answer.distance));
    CHECK(answer.normal.isZero());
  }
}

TEST_CASE("Octants answer each by its own kind") {
  SparseCubeByHand cube(size);
  const std::vector<std::uint32_t> whole = cube.octree.words;
  const auto list = OctreeKind::list, far_kind = OctreeKind::far;
  std::vector<std::uint32_t> units{
      2, test::octant_kinds(
             far_kind,
             {{0, OctreeKind::pruned}, {1, list}, {6, OctreeKind::deep}, {7, OctreeKind::split}})};
  units.insert(units.end(), whole.begin(), whole.end());
  units.insert(units.end(), {pack_octahedral(Vector3::UnitX())});
  units.insert(units.end(), {7, test::octant_kinds(far_kind, {{7, list}})});
  units.insert(units.end(), whole.begin(), whole.end());
  fill(cube, OctreeKind::split, units);
  CHECK(query_point(cube.view, {-0.01, -0.01, -0.0199}).status == Status::pruned);
  CHECK(query_point(cube.view, {0.01, -0.01, -0.0199}).distance == Approx(-0.0001));
  CHECK(query_point(cube.view, {-0.01, 0.01, -0.0199}).status == Status::far);
  const Answer deep = query_point(cube.view, {-0.01, 0.01, 0.0199});
  CHECK(deep.status == Status::deep);
  CHECK(deep.distance == -cube.view.band.max_depth);
  CHECK((deep.normal - Vector3::UnitX()).norm() < 1e-3);
  CHECK(query_point(cube.view, {0.005, 0.005, 0.0199}).status == Status::far);
  CHECK(query_point(cube.view, {0.015, 0.015, 0.0199}).distance == Approx(-0.0001));
}

TEST_CASE("Beyond the margin and outside all cubes the answer is far") {
  SparseCubeByHand cube(size);
  cube.octree.edge = 1;  // so that the point lies in it
  for (const ListSide side : {ListSide::surface, ListSide::outside}) {
    cube.octree.words[1] = list_word(12, 0, side, false);
    cube.refresh();
    CHECK(query_point(cube.view, {0, 0, half + 0.00049}).status == Status::exact);
    const Answer answer = query_point(cube.view, {0, 0, half + 0.00052});
    CHECK(answer.status == Status::far);
    CHECK(std::isnan(answer.distance));
    CHECK(query_point(cube.view, {0, 0.3, 0}).status == Status::far);
    CHECK(query_point(cube.view, {0, 3, 0}).status == Status::far);
  }
}

TEST_CASE("Deeper than the band the answer is its bound and the normal of the nearest face") {
  SparseCubeByHand cube(size);
  for (const ListSide side : {ListSide::surface, ListSide::inside}) {
    cube.octree.words[1] = list_word(12, 0, side, false);
    cube.refresh();
    const Answer answer = query_point(cube.view, {0, 0.015, 0});
    CHECK(answer.status == Status::deep);
    CHECK(answer.distance == -cube.view.band.max_depth);
    CHECK((answer.normal - Vector3::UnitY()).norm() < 1e-6);
    Random random(3);
    for (int trial = 0; trial < 500; ++trial) {
      const Vector3 point = random_place(random, 0.035);
      const Answer deep = query_point(cube.view, point);
      REQUIRE(deep.status == Status::deep);
      REQUIRE(deep.normal.norm() == Approx(1));
      REQUIRE(half - point.dot(deep.normal) <= -cube_distance(point) + 1e-6);
    }
  }
}

TEST_CASE("Points that are not finite are far in the sparse form too") {
  const SparseCubeByHand cube(size);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vector3& point : {Vector3(nan, 0, 0), Vector3(0, infinity, 0),
                               Vector3(0, 0, -infinity), Vector3(1e308, 1e308, 1e308)}) {
    CHECK(query_point(cube.view, point).status == Status::far);
    CHECK(clearance(cube.view, point) >= 0);
  }
}

TEST_CASE("On the surface the normal is the triangle's own") {
  const SparseCubeByHand cube(size);
  // Within a thousandth of the tolerance, beyond the edge of the face at +y.
  const Answer edge = query_point(cube.view, {0.003, half, half + 5e-9});
  CHECK(edge.status == Status::exact);
  CHECK(edge.distance == Approx(5e-9).epsilon(1e-6));
  CHECK(std::max(edge.normal.y(), edge.normal.z()) == Approx(1));
  CHECK((query_point(cube.view, {0.001, 0.002, half}).normal - Vector3::UnitZ()).norm() < 1e-12);
}

TEST_CASE("Corners of triangles are where the lattice's origin and step put them") {
  SparseCubeByHand cube(size);
  TriangleByHand triangle;
  triangle.corners = {{{-20000, -20000, 500}, {20000, -20000, 500}, {-20000, 20000, 500}}};
  for (const double step : {1e-6, 2e-6, 5e-6}) {
    test::set_lattice(cube.octree, Vector3(0, 0, 0.0195 - 500 * step), step);
    fill_with_list(cube, {triangle});
    const Answer answer = query_point(cube.view, {-0.01, -0.01, 0.019});
    CHECK(answer.distance == Approx(-0.0005));
    CHECK(answer.source == Source::triangles);
    CHECK(answer.plane == -1);
    CHECK(answer.layer == -1);
    CHECK((answer.normal - Vector3::UnitZ()).norm() < 1e-9);
  }
}

TEST_CASE("Each triangle of a list is found, in single precision and exactly") {
  SparseCubeByHand cube(size);
  // Four triangles around the middle of a face, so that each covers a quarter of it.
  std::vector<TriangleByHand> fan;
  constexpr std::array<std::array<std::int32_t, 2>, 5> ring{
      {{-face, -face}, {face, -face}, {face, face}, {-face, face}, {-face, -face}}};
  for (std::size_t k = 0; k < 4; ++k) {
    TriangleByHand quarter;
    quarter.corners = {
        {{0, 0, face}, {ring[k][0], ring[k][1], face}, {ring[k + 1][0], ring[k + 1][1], face}}};
    fan.push_back(quarter);
  }
  // Repeated, so that there are fewer than a packet's, several packets, and some that are not full.
  for (const std::size_t times : {1U, 2U, 3U, 11U}) {
    for (const unsigned thin : {0U, 0xFFFFFFFFU, 0x5A5A5A5AU}) {
      std::vector<TriangleByHand> many;
      for (std::size_t k = 0; k < 4 * times; ++k) {
        many.push_back(fan[k % 4]);
        many.back().thin = (thin >> k % 32 & 1U) != 0;
      }
      fill_with_list(cube, many);
      for (const double x : {-0.013, 0.001, 0.012}) {
        for (const double y : {-0.011, 0.002, 0.014}) {
          CHECK(query_point(cube.view, {x, y, half - 0.0004}).distance ==
                Approx(-0.0004).margin(1e-8));
        }
      }
    }
  }
  // One triangle fewer leaves its quarter open.
  fill_with_list(cube, {fan[0], fan[1], fan[2]});
  CHECK_FALSE(std::abs(query_point(cube.view, {-0.013, 0.001, half - 0.0004}).distance) < 0.0008);
  CHECK(query_point(cube.view, {0.013, 0.001, half - 0.0004}).distance ==
        Approx(-0.0004).margin(1e-8));
}

TEST_CASE("Packets that are too far by their bounds are not looked at") {
  SparseCubeByHand cube(size);
  TriangleByHand low, high;  // 0.1 mm apart
  low.corners = {{{-face, -face, 0}, {face, -face, 0}, {-face, face, 0}}};
  high.corners = {{{-face, -face, face}, {face, -face, face}, {-face, face, face}}};
  test::clear_triangles(cube.octree);
  test::set_lattice(cube.octree, Vector3(0, 0, 0.0193), 1e-4 / face);
  cube.octree.reach = 0.00255;
  const std::uint32_t lower = test::add_triangle(cube.octree, low);
  const std::uint32_t upper = test::add_triangle(cube.octree, high);
  std::vector<std::uint32_t> listed(2 * packet_size, lower);
  listed.push_back(upper);
  const Vector3 point(-2e-5, -2e-5, 0.0198);  // 0.5 mm above the lower one, 0.4 mm above the other
  for (const auto& [bound, found] : {std::pair(39U, 0.0004), {60U, 0.0005}}) {
    const auto unit = test::add_list(cube.octree, listed, {}, ListSide::surface, {0, 0, bound});
    fill(cube, OctreeKind::list, {unit.begin(), unit.end()});
    CHECK(query_point(cube.view, point).distance == Approx(found).margin(1e-9));
  }
}

TEST_CASE("A wide list answers as a narrow one") {
  SparseCubeByHand cube(size);
  const TriangleByHand top{
      .corners = {{{-face, -face, face}, {face, -face, face}, {0, face, face}}}};
  const std::uint32_t first = test::add_triangle(cube.octree, top);
  const auto place = static_cast<std::uint32_t>(cube.octree.lists.size());
  cube.octree.lists.insert(cube.octree.lists.end(), {first - 1, 1});
  fill(cube, OctreeKind::list, {place, list_word(1, 0, ListSide::surface, true)});
  CHECK(query_point(cube.view, {0, 0, half - 0.0004}).distance == Approx(-0.0004).margin(1e-8));
}

TEST_CASE("Beyond a sharp edge the side is what the bake told, whichever triangle is found") {
  SparseCubeByHand cube(size);
  // A wedge along z that ends at x = y = 0, below y = 0.
  test::Shape wedge;
  wedge.vertices = {{0, 0, -half}, {0, 0, half}, {-half, 0, 0}, {-half, -0.006, 0}};
  wedge.triangles = {{0, 2, 1}, {1, 3, 0}};
  for (const bool swapped : {false, true}) {
    if (swapped) std::swap(wedge.triangles[0], wedge.triangles[1]);
    cube.replace_triangles(wedge);
    const Vector3 off(0.0003, -0.00002, 0);
    const Answer answer = query_point(cube.view, off);
    CHECK(answer.distance == Approx(off.norm()).margin(1e-9));
    CHECK((answer.normal - off.normalized()).norm() < 1e-6);
    CHECK(query_point(cube.view, {-0.005, -0.0003, 0}).distance == Approx(-0.0003).margin(1e-9));
    // The other way round it is a notch, and the same place is inside.
    cube.replace_triangles(test::turned_inside_out(wedge));
    CHECK(query_point(cube.view, off).distance == Approx(-off.norm()).margin(1e-9));
    CHECK(query_point(cube.view, {-0.005, -0.0003, 0}).distance == Approx(0.0003).margin(1e-9));
  }
}

/// A triangle of a sheet in the plane z = 0, which faces +z.
TriangleByHand level_sheet() {
  TriangleByHand sheet;
  sheet.corners = {{{-face, -face, 0}, {face, -face, 0}, {0, face, 0}}};
  sheet.sides = 0x1555;  // outside all around
  return sheet;
}

TEST_CASE("A sheet is felt from both sides at its half-thickness, and has no inside") {
  SparseCubeByHand cube(size, {0.02, 0.02});
  cube.view.sheet_thickness = 0.0003;
  for (const ListSide side : {ListSide::surface, ListSide::inside, ListSide::outside}) {
    fill_with_list(cube, {}, {level_sheet()}, side);
    for (const double height : {-0.001, -0.0001, 0.0001, 0.001}) {
      const Answer answer = query_point(cube.view, {0, 0, height});
      CHECK(answer.status == Status::exact);
      CHECK(answer.source == Source::triangles);
      CHECK(answer.distance == Approx(std::abs(height) - 0.0003).margin(1e-7));
      CHECK(answer.normal.z() == Approx(height > 0 ? 1 : -1));
    }
  }
}

TEST_CASE("Of a solid and a sheet in one list the one that is felt sooner answers") {
  SparseCubeByHand cube(size, {0.02, 0.02});
  cube.view.sheet_thickness = 0.001;
  TriangleByHand solid;  // faces +z, 10 mm above the sheet
  solid.corners = {{{-819, 0, 8192}, {819, 0, 8192}, {0, 819, 8192}}};
  fill_with_list(cube, {solid}, {level_sheet()}, ListSide::outside);
  CHECK(query_point(cube.view, {0, 0, 0.004}).distance == Approx(0.003).margin(1e-7));
  CHECK(query_point(cube.view, {0, 0, 0.007}).distance == Approx(0.003).margin(1e-7));
  CHECK(query_point(cube.view, {0, 0, 0.007}).normal.z() == Approx(-1));
  // A sheet changes nothing deep in a solid.
  fill_with_list(cube, {solid}, {level_sheet()}, ListSide::inside);
  CHECK(query_point(cube.view, {0, 0, 0.004}).distance == Approx(-0.006).margin(1e-7));
}

TEST_CASE(
    "How far the surface is at least is told by far roots, and by the way to the next other cube") {
  SparseCubeByHand cube(size);
  cube.forget_box();
  cube.octree.edge = 0.1;
  cube.octree.roots = {2, 1, 1};
  cube.octree.clearance_unit = 1e-3;
  cube.octree.root_words.push_back(test::root_word(OctreeKind::far, 70));
  cube.refresh();
  const Vector3 middle = cube.octree.origin + Vector3(0.15, 0.05, 0.05);
  CHECK(clearance(cube.view, middle) == Approx(0.07));
  const double margin = cube.view.band.margin;
  CHECK(clearance(cube.view, middle + Vector3(0.03, 0.04, 0)) == Approx(margin + 0.08));
  CHECK(clearance(cube.view, middle + Vector3(-0.049, 0.049, 0.049)) == Approx(margin + 0.001));
  CHECK(clearance(cube.view, Vector3::Zero()) == 0);
  CHECK(clearance(cube.view, {0, 0, half + 0.002}) == cube.view.band.margin);
  cube.octree.beyond_share = 0.5;
  cube.refresh();
  CHECK(clearance(cube.view, {0, 0, half + 0.002}) == Approx((margin + 0.002) / 2));
  CHECK(clearance(cube.view, {0, 0, half + margin / 2}) == 0);
  CHECK(clearance(cube.view, {0, 0, -1}) ==
        Approx(cube.view.band.margin + 1 + cube.octree.origin.z()));
}

TEST_CASE("A far root behind a place tells more of how far the surface is than its own does") {
  SparseCubeByHand cube(size);
  cube.forget_box();
  cube.octree.edge = 0.1;
  cube.octree.roots = {3, 1, 1};
  cube.octree.clearance_unit = 1e-3;
  cube.octree.root_words.push_back(test::root_word(OctreeKind::far, 70));
  cube.octree.root_words.push_back(test::root_word(OctreeKind::far, 170));
  cube.refresh();
  const Vector3 middle = cube.octree.origin + Vector3(0.15, 0.05, 0.05);
  CHECK(clearance(cube.view, middle + Vector3(0.04, 0, 0)) == Approx(0.17 - 0.06));
  // Also of a place outside all roots.
  CHECK(clearance(cube.view, middle + Vector3(0.1, 0, 0.06)) == Approx(0.17 - 0.06));
}

TEST_CASE("Many points at once are answered as each by itself") {
  SparseCubeByHand cube(size);
  Random random(11);
  for (const std::size_t count : {0U, 1U, 7U, 8U, 9U, 500U}) {
    std::vector<Vector3> points(count);
    for (Vector3& point : points) point = random_place(random, size + 0.002);
    std::vector<Answer> answers(count);
    query_points(cube.view, points, answers);
    for (std::size_t k = 0; k < count; ++k) {
      const Answer wanted = query_point(cube.view, points[k]);
      REQUIRE(answers[k].status == wanted.status);
      REQUIRE(answers[k].normal == wanted.normal);
      REQUIRE((answers[k].distance == wanted.distance || std::isnan(wanted.distance)));
    }
  }
}

}  // namespace
}  // namespace spm::query_sparse_test
