// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "common/base/random.hpp"
#include "common/surface/closest_on_triangle.hpp"
#include "tests/baker/verify/verify_shapes.hpp"
#include "tests/bench/geometry/sided_mesh.hpp"
#include "tests/bench/geometry/triangle_packets.hpp"
#include "tests/bench/methods/methods.hpp"
#include "tests/bench/model/bumpy_sphere.hpp"
#include "tests/support/every_target.hpp"
#include "tests/support/shapes.hpp"

namespace opponents_test {

namespace {

using namespace spm;
using namespace spm::bench;

Model model_of(const test::Shape& shape) {
  return {{"shape", "shape", 50e-6}, test::as_mesh(shape)};
}

/// A place in the box around the shape, grown by the margin.
Vector3 place_around(const Model& model, std::uint64_t index) {
  return test::point_around(model.mesh, model.band.margin, random_unit(5, 3 * index),
                            random_unit(5, 3 * index + 1), random_unit(5, 3 * index + 2));
}

/// The triangle found by asking one after the other.
std::uint32_t nearest_of(const SidedMesh& mesh, const Vector3& point) {
  std::uint32_t nearest = 0;
  for (std::uint32_t k = 1; k < mesh.mesh().triangles.size(); ++k) {
    if (mesh.distance(point, k) < mesh.distance(point, nearest)) nearest = k;
  }
  return nearest;
}

/// Bumps, and a triangle without area.
FloatMesh bumps() {
  const baker::Mesh bumpy = bumpy_sphere(2);
  baker::OuterSurface surface;
  surface.vertices = bumpy.vertices;
  surface.triangles = bumpy.triangles;
  surface.triangles.push_back({0, 1, 1});
  surface.solid_count = surface.triangles.size();
  return FloatMesh(surface);
}

/// Up to 30 triangles of a mesh, and the last.
std::vector<std::uint32_t> drawn_triangles(const FloatMesh& mesh, std::uint64_t seed) {
  std::vector<std::uint32_t> list;
  for (std::uint64_t i = 0; i <= seed % 29; ++i) {
    const double drawn = random_unit(seed, i) * static_cast<double>(mesh.triangles.size());
    list.push_back(static_cast<std::uint32_t>(drawn));
  }
  list.push_back(static_cast<std::uint32_t>(mesh.triangles.size() - 1));
  return list;
}

}  // namespace

TEST_CASE("Lanes name the nearest triangle with every instruction set") {
  const FloatMesh mesh = bumps();
  const auto distance = [&](const Vector3& point, std::uint32_t triangle) {
    const auto [a, b, c] = mesh.corners(triangle);
    return (closest_on_triangle(point, a, b, c) - point).norm();
  };
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const std::vector<std::uint32_t> list = drawn_triangles(mesh, seed);
    std::vector<TriangleLanes> packets;
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i < list.size(); i += packet_triangles) {
      numbers.push_back(static_cast<std::uint32_t>(packets.size()));
      const std::size_t count = std::min(packet_triangles, list.size() - i);
      packets.push_back(make_packet(mesh, std::span(list).subspan(i, count)));
    }
    const Vector3 point =
        0.05 * Vector3(random_unit(seed, 40), random_unit(seed, 41), random_unit(seed, 42));
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t triangle : list) least = std::min(least, distance(point, triangle));
    const std::array<float, 3> place{static_cast<float>(point.x()), static_cast<float>(point.y()),
                                     static_cast<float>(point.z())};
    test::on_every_target([&] {
      CHECK(distance(point, nearest_in_packets(packets, place)) < least + 1e-8);
      CHECK(distance(point, nearest_in_packets(packets.data(), numbers, place)) < least + 1e-8);
    });
  }
}

TEST_CASE("A grid of triangles answers as a search through all of them, sides and all") {
  // So narrow that its medial axis lies in the band.
  const Model model = model_of(test::box({0.003, 0.012, 0.02}));
  const SidedMesh mesh(model);
  const CellTriangles cells = find_cell_triangles(model, 0.6e-3);
  for (const GridLists lists : {GridLists::own, GridLists::shared}) {
    const auto grid = make_triangle_grid(model, cells, lists);
    std::size_t asked = 0;
    for (std::uint64_t i = 0; i < 3000; ++i) {
      const Vector3 point = place_around(model, i);
      const double truth = mesh.answer(point, nearest_of(mesh, point)).distance;
      if (!(truth > -model.band.max_depth && truth < model.band.margin)) continue;
      ++asked;
      CHECK(grid->query(point).distance == Approx(truth).margin(1e-8));
    }
    CHECK(asked > 1000);
  }
}

TEST_CASE(
    "One nearest triangle tells the side, also past a sharp edge whose triangles do not match") {
  // One side of the ridge has a vertex in the middle of it, the other has none.
  test::Shape ridge;
  ridge.vertices = {
      {-0.01, -0.001, -0.01}, {0.01, -0.001, -0.01}, {0.01, 0.001, -0.01}, {-0.01, 0.001, -0.01},
      {-0.01, 0, 0.01},       {0.01, 0, 0.01},       {0, 0, 0.01}};
  ridge.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4}, {2, 3, 6},
                     {2, 6, 5}, {3, 4, 6}, {0, 4, 3}, {1, 2, 5}};
  const Model model = model_of(ridge);
  const SidedMesh mesh(model);
  const auto count = static_cast<std::uint32_t>(mesh.mesh().triangles.size());
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vector3 point(0.018 * (random_unit(3, 3 * i) - 0.5),
                        0.0004 * (random_unit(3, 3 * i + 1) - 0.5),
                        0.01 + 0.0005 * random_unit(3, 3 * i + 2));
    const double least = mesh.distance(point, nearest_of(mesh, point));
    for (std::uint32_t k = 0; k < count; ++k) {
      // Whichever of the equally near is named.
      if (mesh.distance(point, k) > least + 1e-9) continue;
      CHECK(mesh.answer(point, k).distance == Approx(least).margin(2e-9));
    }
  }
}

TEST_CASE("What a method keeps of the queries before changes no answer") {
  constexpr double radius = 0.012;
  const Model model = model_of(test::sphere(radius, 3));
  const DistanceLattice lattice = sample_band(model, 0.5e-3);
  std::vector<std::unique_ptr<Method>> methods;
  methods.push_back(make_embree(model, EmbreeTree::standard));
  methods.push_back(make_cgal_tree(model));
  methods.push_back(make_fcl(model));
  methods.push_back(make_bullet(model));
  methods.push_back(make_openvdb(lattice));
  methods.push_back(make_nanovdb(lattice, NanoVoxel::fixed8));
  std::vector<Vector3> points;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const double depth = 0.002 * random_unit(7, 3 * i);
    points.push_back((radius - depth) *
                     direction_of(random_unit(7, 3 * i + 1), random_unit(7, 3 * i + 2)));
  }
  for (const auto& method : methods) {
    INFO(method->facts().name);
    std::vector<double> forwards, backwards;
    for (const Vector3& point : points) forwards.push_back(method->query(point).distance);
    std::reverse(points.begin(), points.end());
    for (const Vector3& point : points) {
      // Far away in between: nothing near is known.
      static_cast<void>(method->query(Vector3(1, 1, 1)));
      backwards.push_back(method->query(point).distance);
    }
    std::reverse(points.begin(), points.end());
    std::reverse(backwards.begin(), backwards.end());
    for (std::size_t i = 0; i < points.size(); ++i) {
      CHECK(forwards[i] == Approx(backwards[i]).margin(1e-8));
    }
  }
}

TEST_CASE("Fewer bits a voxel add no more error than their step, in fewer bytes") {
  const Model model = model_of(test::sphere(0.012, 4));
  constexpr double cell = 0.5e-3;
  const DistanceLattice lattice = sample_band(model, cell);
  const auto exact = make_openvdb(lattice);
  // Over eight voxels a side the distance changes by no more than their diagonal.
  const double span = 8 * std::sqrt(3.0) * cell;
  const auto largest_difference = [&](NanoVoxel voxel) {
    const auto coarse = make_nanovdb(lattice, voxel);
    double largest = 0;
    for (std::uint64_t i = 0; i < 4000; ++i) {
      const Vector3 point = place_around(model, i);
      largest =
          std::max(largest, std::abs(coarse->query(point).distance - exact->query(point).distance));
    }
    return largest;
  };
  CHECK(largest_difference(NanoVoxel::float32) < 1e-9);
  CHECK(largest_difference(NanoVoxel::fixed16) < span / 65535);
  CHECK(largest_difference(NanoVoxel::fixed8) < span / 255);
  CHECK(largest_difference(NanoVoxel::variable) < cell / 200 + 1e-9);
  const auto bytes = [&](NanoVoxel voxel) {
    return make_nanovdb(lattice, voxel)->facts().resident_bytes;
  };
  CHECK(bytes(NanoVoxel::fixed8) < bytes(NanoVoxel::fixed16));
  CHECK(bytes(NanoVoxel::fixed16) < bytes(NanoVoxel::float32));
}

}  // namespace opponents_test
