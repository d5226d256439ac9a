// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/outer_surface.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "baker/mesh/triangle_height.hpp"
#include "baker/mesh/winding_number.hpp"
#include "baker/surface/triangle_split.hpp"
#include "baker/verify/exact_surface.hpp"
#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/support/random.hpp"

namespace spm::test::outer_surface_test {
namespace {

using baker::outer_surface;
using baker::OuterSurface;
using baker::Triangle;
using baker::WindingNumber;

[[nodiscard]] OuterSurface surface_of(const Shape& shape) {
  return outer_surface(load_shape(shape));
}

[[nodiscard]] double volume_of(const OuterSurface& surface) {
  return signed_volume(surface.vertices, surface.triangles);
}

[[nodiscard]] double kept_area(const OuterSurface& surface) {
  return area(surface.vertices,
              {surface.triangles.begin(),
               surface.triangles.begin() + static_cast<std::ptrdiff_t>(surface.solid_count)});
}

/// Total length of the edges that the triangles leave open.
[[nodiscard]] double open_length(const OuterSurface& surface) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const Triangle& t : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k];
      const std::uint32_t to = t[(k + 1) % 3];
      balance[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  }
  double length = 0;
  for (const auto& [edge, count] : balance) {
    if (count != 0) length += (surface.vertices[edge.first] - surface.vertices[edge.second]).norm();
  }
  return length;
}

[[nodiscard]] Shape turned(Shape shape, double angle, const Vector3& axis) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  for (Vector3& vertex : shape.vertices) vertex = turn * vertex;
  return shape;
}

/// The same surface of more triangles: each is cut into so many squared.
[[nodiscard]] Shape subdivided(const Shape& shape, int parts) {
  Shape fine;
  for (const Triangle& triangle : shape.triangles) {
    const Vector3 &a = shape.vertices[triangle[0]], &b = shape.vertices[triangle[1]],
                  &c = shape.vertices[triangle[2]];
    const auto corner = [&](int i, int j) {
      fine.vertices.push_back(((parts - i - j) * a + i * b + j * c) / parts);
      return static_cast<std::uint32_t>(fine.vertices.size() - 1);
    };
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; i + j < parts; ++j) {
        fine.triangles.push_back({corner(i, j), corner(i + 1, j), corner(i, j + 1)});
        if (i + j + 1 == parts) continue;
        fine.triangles.push_back({corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)});
      }
    }
  }
  return fine;
}

/// A cube with edges of 2 under z = 0, whose top has a sliver from side to side that is tilted by
/// 22 degrees, 3 um wide and 1.2 um high.
[[nodiscard]] Shape cube_with_sliver() {
  return {{{-1, -1, 0},
           {1, -1, 0},
           {1, 1, 0},
           {-1, 1, 0},
           {-1, 0, 0},
           {1, 0, 0},
           {0.3, 3e-6, 1.2e-6},
           {-1, -1, -2},
           {1, -1, -2},
           {1, 1, -2},
           {-1, 1, -2}},
          {{0, 1, 5},
           {0, 5, 4},
           {4, 5, 6},
           {4, 6, 3},
           {6, 5, 2},
           {6, 2, 3},
           {8, 7, 10},
           {8, 10, 9},
           {0, 7, 8},
           {0, 8, 1},
           {2, 9, 10},
           {2, 10, 3},
           {4, 3, 10},
           {4, 10, 7},
           {4, 7, 0},
           {5, 1, 8},
           {5, 8, 9},
           {5, 9, 2}}};
}

}  // namespace

TEST_CASE("A closed mesh without intersections is its own outer surface") {
  const Shape shape = torus(0.04, 0.01, 40, 20);
  const OuterSurface surface = surface_of(shape);
  CHECK(surface.triangles.size() == shape.triangles.size());
  CHECK(surface.solid_count == shape.triangles.size());
  CHECK(surface.hidden == 0);
  CHECK(surface.hidden_area == 0);
}

TEST_CASE("Overlapping boxes leave exactly the surface of their union") {
  const OuterSurface surface = surface_of(merged(box({2, 2, 2}), moved(box({2, 2, 2}), {1, 1, 1})));
  CHECK(kept_area(surface) == Approx(48 - 6).epsilon(1e-12));
  CHECK(volume_of(surface) == Approx(15).epsilon(1e-12));
  CHECK(surface.hidden_area == Approx(6).epsilon(1e-12));
  CHECK(open_length(surface) == 0);
}

TEST_CASE("Boxes at any angle leave a closed surface with the union's volume") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    RandomTwister random(seed);
    Shape shape = box({2, 2, 2});
    const int parts = 4;
    for (int i = 0; i < parts; ++i) {
      const Shape part = turned(box({1, 2, 3}), 6 * random.unit(), random.direction());
      shape = merged(shape, moved(part, random.in_box({-1, -1, -1}, {1, 1, 1})));
    }
    const baker::Mesh mesh = load_shape(shape);
    const OuterSurface surface = outer_surface(mesh);
    CHECK(open_length(surface) < 1e-9);
    CHECK(surface.intersecting.count > 0);
    const WindingNumber before(mesh.vertices, mesh.triangles);
    const WindingNumber after(surface.vertices, surface.triangles);
    for (int i = 0; i < 300; ++i) {
      const Vector3 point = random.in_box(mesh.box_min, mesh.box_max);
      const double inside = before.at(point) >= 0.5 ? 1 : 0;
      CHECK(after.at(point) == Approx(inside).margin(2e-3));
    }
  }
}

TEST_CASE("Boxes that share part of a face become one") {
  // Coplanar faces that overlap, one way and the other.
  const OuterSurface beside =
      surface_of(merged(box({2, 2, 2}), moved(box({2, 2, 2}), {2, 0.5, 0})));
  CHECK(volume_of(beside) == Approx(16).epsilon(1e-12));
  CHECK(kept_area(beside) == Approx(48 - 2 * 3).epsilon(1e-12));
  const OuterSurface through =
      surface_of(merged(box({2, 2, 2}), moved(box({2, 2, 2}), {1, 0.5, 0})));
  CHECK(volume_of(through) == Approx(16 - 3).epsilon(1e-12));
  CHECK(kept_area(through) == Approx(2 * 6.5 + 2 * 11).epsilon(1e-12));
  CHECK(open_length(through) == 0);
}

TEST_CASE("Faces of many triangles that lie on each other are cut along their outlines alone") {
  const Shape fine = subdivided(box({2, 2, 2}), 16);
  const std::size_t triangles = fine.triangles.size();
  // The top of one on the bottom of the other, at an angle; then faces of both that face one way.
  const OuterSurface on =
      surface_of(merged(fine, moved(turned(fine, 0.3, Vector3::UnitZ()), {0.3, 0.2, 2})));
  CHECK(volume_of(on) == Approx(16).epsilon(1e-12));
  CHECK(open_length(on) == 0);
  CHECK(on.triangles.size() + on.hidden < 2 * triangles + 500);
  const OuterSurface through =
      surface_of(merged(fine, moved(turned(fine, 0.3, Vector3::UnitZ()), {0.3, 0.2, 0})));
  CHECK(open_length(through) == 0);
  CHECK(through.triangles.size() + through.hidden < 3 * triangles);
  // Thrice: those that lie on each other count as often as they do.
  const OuterSurface thrice =
      surface_of(merged(merged(fine, moved(fine, {0, 1, 0})), turned(fine, 1.5, Vector3::UnitZ())));
  CHECK(open_length(thrice) == 0);
  RandomTwister random(7);
  const WindingNumber winding(thrice.vertices, thrice.triangles);
  for (int i = 0; i < 300; ++i) {
    const Vector3 place = random.in_box({-2, -2, -1.2}, {2, 2.5, 1.2});
    const Vector3 back = Eigen::AngleAxisd(-1.5, Vector3::UnitZ()) * place;
    const auto inside = [](const Vector3& p) { return p.cwiseAbs().maxCoeff() < 1; };
    const bool any = inside(place) || inside(place - Vector3::UnitY()) || inside(back);
    CHECK(winding.at(place) == Approx(any ? 1 : 0).margin(1e-6));
  }
}

TEST_CASE(
    "A face that another one lies on goes, and one beside it stays, wherever their diagonals run") {
  // The mirrored box is the same, but for the diagonals of its faces.
  const auto mirrored = [](Shape shape) {
    for (Vector3& vertex : shape.vertices) vertex.x() = -vertex.x();
    return turned_inside_out(shape);
  };
  const auto both = [&](const Vector3& size, const Vector3& place) {
    return std::array{moved(box(size), place), moved(mirrored(box(size)), place)};
  };
  for (const Shape& one : both({2, 2, 2}, {0, 0, 0})) {
    for (const Shape& on : both({1, 1, 1}, {0, 0, 1.5})) {
      CHECK(volume_of(surface_of(merged(one, on))) == Approx(9).epsilon(1e-12));
    }
    // Faces that lie beside each other in one plane stay.
    for (const Shape& other : both({2, 1, 2}, {2, 0, 0})) {
      const OuterSurface surface = surface_of(merged(one, other));
      CHECK(volume_of(surface) == Approx(12).epsilon(1e-12));
      CHECK(open_length(surface) == 0);
    }
  }
}

TEST_CASE("The same box twice leaves one") {
  // A quarter turn gives some faces another diagonal: only the others are dropped when loading.
  Shape twice =
      merged(box({1, 1, 1}), turned(box({1, 1, 1}), 3.14159265358979323846 / 2, {0, 0, 1}));
  for (Vector3& vertex : twice.vertices) vertex = (2 * vertex).array().round() / 2;
  const OuterSurface surface = surface_of(twice);
  CHECK(kept_area(surface) == Approx(6).epsilon(1e-12));
  CHECK(volume_of(surface) == Approx(1).epsilon(1e-12));
}

TEST_CASE("A part inside another is hidden, and a cavity is kept") {
  const double large = area(sphere(1, 2).vertices, sphere(1, 2).triangles);
  const double small = area(sphere(0.5, 2).vertices, sphere(0.5, 2).triangles);
  const OuterSurface hidden = surface_of(merged(sphere(1, 2), sphere(0.5, 2)));
  CHECK(kept_area(hidden) == Approx(large));
  CHECK(hidden.hidden_area == Approx(small));
  const OuterSurface cavity = surface_of(merged(sphere(1, 2), turned_inside_out(sphere(0.5, 2))));
  CHECK(kept_area(cavity) == Approx(large + small));
  CHECK(cavity.hidden == 0);
}

TEST_CASE("Spheres in a row leave the union's surface closed") {
  Shape row = sphere(1, 2);
  for (int i = 1; i < 5; ++i) row = merged(row, moved(sphere(1, 2), {1.1 * i, 0.013 * i, 0}));
  const OuterSurface surface = surface_of(row);
  CHECK(open_length(surface) < 1e-9);
  CHECK(surface.hidden_area > 0.2 * area(row.vertices, row.triangles));
}

TEST_CASE("A sheet comes after the solids, and what of it lies inside them or on them is hidden") {
  Shape sheet;
  sheet.vertices = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (const double height : {0.1, 0.5}) {
    const OuterSurface surface = surface_of(merged(box({1, 1, 1}), moved(sheet, {0, 0, height})));
    double felt = 0;
    for (std::size_t t = surface.solid_count; t < surface.triangles.size(); ++t) {
      const auto& [a, b, c] = surface.triangles[t];
      felt += (surface.vertices[b] - surface.vertices[a])
                  .cross(surface.vertices[c] - surface.vertices[a])
                  .norm() /
              2;
    }
    CHECK(kept_area(surface) == Approx(6));
    CHECK(felt == Approx(15));
    CHECK(surface.hidden_area == Approx(1));
    CHECK(volume_of(solids_of(surface)) == Approx(1));
  }
}

TEST_CASE("A sheet is cut along the outline of what is felt of it alone") {
  Shape shape;
  shape.vertices = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
  shape.triangles = {{0, 1, 2}, {0, 2, 3}};
  // A dozen blocks side by side on it cover one rectangle.
  for (int i = 0; i < 12; ++i) {
    shape = merged(shape, moved(box({0.125, 1, 1}), {0.125 * (i - 5.5), 0, 0.5}));
  }
  const OuterSurface surface = surface_of(shape);
  double area = 0;
  for (std::size_t i = surface.solid_count; i < surface.triangles.size(); ++i) {
    const auto& [a, b, c] = surface.triangles[i];
    area += baker::triangle_area(surface.vertices[a], surface.vertices[b], surface.vertices[c]);
  }
  CHECK(area == Approx(16 - 1.5));
  // Four corners and two places on the diagonal are all that it is cut at.
  CHECK(surface.triangles.size() - surface.solid_count <= 16);
}

TEST_CASE("Sheets that cross one another stay as they are") {
  Shape sheet;
  sheet.vertices = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  Shape other = sheet;
  for (Vector3& vertex : other.vertices) vertex = {vertex.z(), vertex.x(), vertex.y()};
  const OuterSurface surface = surface_of(merged(sheet, other));
  CHECK(surface.solid_count == 0);
  CHECK(surface.triangles.size() == 4);
}

TEST_CASE("Parts that touch or nearly touch are one, and a gap that can be felt stays") {
  const Shape below = box({3, 3, 3});
  const Shape above = moved(box({1.2, 1.2, 1}), {0.03, -0.02, 2});
  for (const double gap : {-2e-5, -1e-7, 0.0, 1e-7, 2e-5, 9e-5}) {
    for (const double turn : {0.0, 0.3}) {
      INFO(gap << ", turned by " << turn);
      const Eigen::AngleAxisd rotation(turn, Vector3(1, 2, 3).normalized());
      Shape both = merged(below, moved(above, {0, 0, gap}));
      for (Vector3& vertex : both.vertices) vertex = rotation * vertex;
      const baker::Mesh mesh = load_shape(both);
      const OuterSurface one = baker::outer_surface(mesh, 1e-4);
      CHECK(kept_area(one) == Approx(6 * 9 + 4 * 1.2 * 1).epsilon(1e-4));
      const OuterSurface apart = baker::outer_surface(mesh, 1e-5);
      const bool two = gap > 1e-5;
      CHECK(kept_area(apart) == Approx(6 * 9 + 4 * 1.2 + (two ? 2 * 1.44 : 0)).epsilon(1e-4));
    }
  }
}

TEST_CASE("What bounds parts that cross at next to no angle closes") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    RandomTwister random(seed);
    const double angle = std::pow(10, -1 - 0.75 * static_cast<double>(seed));
    Shape shape = box({2, 2, 2});
    for (int i = 0; i < 5; ++i) {
      const Shape part = turned(box({2, 2, 2}), angle, random.direction());
      shape = merged(shape, moved(part, (i % 3) * random.direction().cwiseAbs()));
    }
    const baker::Mesh mesh = load_shape(shape);
    const OuterSurface surface = outer_surface(mesh);
    INFO("turned by " << angle);
    CHECK(open_length(surface) == 0);
    const WindingNumber before(mesh.vertices, mesh.triangles);
    const WindingNumber after(surface.vertices, surface.triangles);
    for (int i = 0; i < 300; ++i) {
      const Vector3 point = random.in_box(mesh.box_min, mesh.box_max);
      CHECK(after.at(point) == Approx(before.at(point) >= 0.5 ? 1 : 0).margin(2e-3));
    }
  }
}

TEST_CASE("Parts whose largest faces lie on each other to within rounding are one solid") {
  RandomTwister random(5);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(random.between(0, 6), random.direction()).toRotationMatrix();
    Shape both = merged(plate({3, 2, 0.1}), moved(plate({2.9, 1.9, 0.1}), {0.02, 0.01, 0.1}));
    for (Vector3& vertex : both.vertices) vertex = turn * vertex;
    const OuterSurface surface = surface_of(both);
    CHECK(open_length(surface) == 0);
    CHECK(volume_of(surface) == Approx(0.6 + 0.551));
  }
}

TEST_CASE("A triangle on a line is not cut along segments over it") {
  const std::vector<Vector3> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  const std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
  const std::array<Vector3, 2> over{Vector3(0.2, -1, 0.1), Vector3(1, 1, 0.1)};
  const auto split =
      baker::cut_as_seen(points, triangles, std::vector<baker::SeenCut>{{0, over}, {1, over}});
  CHECK(split.pieces.size() > 1);
  CHECK(std::count(split.parents.begin(), split.parents.end(), 0U) == 0);
  CHECK(area(split.points, split.pieces) == Approx(2));
}

TEST_CASE("Of a closed gap its ends go as well") {
  const double gap = 5e-5;
  const Shape slit = turned_inside_out(moved(box({0.6, 0.4, gap}), {0.1, 0, 0}));
  const baker::Mesh mesh = load_shape(merged(box({1, 1, 1}), slit));
  CHECK(kept_area(baker::outer_surface(mesh, gap / 2)) > 6.4);
  const OuterSurface surface = baker::outer_surface(mesh, 2 * gap);
  CHECK(surface.triangles.size() == 12);
  CHECK(surface.hidden_area == Approx(2 * 0.24 + 2 * gap).epsilon(1e-3));
}

TEST_CASE("The floor of a closed gap between two parts on a third is gone, and to verify too") {
  const double gap = 3e-6;
  const Shape left = moved(box({1, 1.5, 1}), {-0.5 - gap / 2, 0, 1.5});
  const Shape right = moved(box({1, 1.5, 1}), {0.5 + gap / 2, 0, 1.5});
  const baker::Mesh mesh = load_shape(merged(merged(box({3, 3, 2}), left), right));
  const OuterSurface surface = baker::outer_surface(mesh, 4e-6);
  const baker::ExactSurface exact(mesh, 0, 4e-6 / baker::narrow_share);
  const Vector3 floor(0, 0, 1);
  CHECK(distance_to(surface.vertices, surface.triangles, floor) > 0.7);
  CHECK((exact.closest(floor).position - floor).norm() > 0.7);
}

TEST_CASE("A sliver that lies half in a closed gap is gone in all of it, and to verify too") {
  const Shape on_half = moved(box({1.2, 1.2, 1}), {-0.7, 0, 0.5 + 1.5e-6});
  const baker::Mesh mesh = load_shape(merged(cube_with_sliver(), on_half));
  const OuterSurface surface = baker::outer_surface(mesh, 4e-6);
  const baker::ExactSurface exact(mesh, 0, 4e-6 / baker::narrow_share);
  const Vector3 in_gap(-0.6, 1e-6, 0), beside(0.6, 1e-6, 0);
  CHECK(distance_to(surface.vertices, surface.triangles, in_gap) > 0.39);
  CHECK(distance_to(surface.vertices, surface.triangles, beside) < 4e-6);
  CHECK((exact.closest(in_gap).position - in_gap).norm() > 0.39);
  CHECK((exact.closest(beside).position - beside).norm() < 4e-6);
}

TEST_CASE("A wall stays a wall, however thin it is") {
  for (const double thickness : {5e-6, 5e-5}) {
    const baker::Mesh mesh = load_shape(box({1, 1, thickness}));
    CHECK(kept_area(baker::outer_surface(mesh, 1e-4)) == Approx(2).epsilon(1e-3));
    // Also where it is not flat, and what faces it comes near to its edges.
    const Shape shell = merged(sphere(1, 2), turned_inside_out(sphere(1 - thickness, 2)));
    CHECK(kept_area(baker::outer_surface(load_shape(shell), 1e-4)) ==
          Approx(2 * area(shell.vertices, {shell.triangles.begin(), shell.triangles.begin() + 320}))
              .epsilon(1e-3));
  }
}

TEST_CASE("The outer surface is the same every time") {
  const Shape shape = merged(sphere(1, 2), moved(sphere(1, 2), {0.7, 0.1, 0.2}));
  const OuterSurface first = surface_of(shape);
  const OuterSurface second = surface_of(shape);
  CHECK(first.vertices == second.vertices);
  CHECK(first.triangles == second.triangles);
}

TEST_CASE("The winding number of an open mesh lies between that of its sides") {
  Shape bowl = sphere(1, 3);
  std::erase_if(bowl.triangles, [&](const auto& t) {
    return bowl.vertices[t[0]].z() + bowl.vertices[t[1]].z() + bowl.vertices[t[2]].z() > 0;
  });
  const WindingNumber winding(bowl.vertices, bowl.triangles);
  CHECK(winding.at({0, 0, -0.9}) > 0.5);
  CHECK(winding.at({0, 0, 0}) == Approx(0.5).margin(0.05));
  CHECK(winding.at({0, 0, 0.9}) < 0.5);
  CHECK(winding.at({0, 0, -3}) == Approx(0).margin(0.05));
}

TEST_CASE("A sheet that solids only touch is left whole") {
  Shape sheet;
  sheet.vertices = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  // A ridge lies in its plane, and of the other solid a corner.
  Shape ridge = box({1, 1, 1}), tip = box({0.5, 0.5, 0.5});
  for (Vector3& vertex : ridge.vertices) {
    vertex = {vertex.x() + vertex.z(), vertex.y(), vertex.z() - vertex.x() - 1};
  }
  for (Vector3& vertex : tip.vertices) {
    vertex = {vertex.x() + vertex.z(), vertex.y() + vertex.z() - 1.5,
              vertex.z() - vertex.x() - vertex.y() - 0.75};
  }
  const OuterSurface surface = surface_of(merged(merged(ridge, tip), sheet));
  CHECK(surface.solid_count == 24);
  CHECK(surface.triangles.size() == 26);
  CHECK(area(surface.vertices, {surface.triangles.begin() + 24, surface.triangles.end()}) ==
        Approx(16));
  CHECK(surface.hidden == 0);
}

TEST_CASE("A wall on faces that lie on each other is cut where their outlines pass it alone") {
  // The foot of the box passes the spokes of the cylinder's top and no outline of it.
  const Shape below = moved(cylinder(2, 1, 48), {0, 0, -0.5});
  const Shape above = moved(box({1, 0.75, 1}), {0.25, 0, 0.5});
  const OuterSurface surface = surface_of(merged(below, above));
  const auto walls = std::count_if(
      surface.triangles.begin(), surface.triangles.end(), [&](const Triangle& triangle) {
        const double rise = surface.vertices[triangle[0]].z() + surface.vertices[triangle[1]].z() +
                            surface.vertices[triangle[2]].z();
        return rise > 0.5;
      });
  CHECK(walls == 10);
  CHECK(volume_of(surface) ==
        Approx(signed_volume(below.vertices, {below.triangles.begin(), below.triangles.end()}) +
               0.75));
  CHECK(open_length(surface) == Approx(0).margin(1e-9));
}

}  // namespace spm::test::outer_surface_test
