// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/methods.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "baker/random.hpp"
#include "tests/baker/verify_shapes.hpp"
#include "tests/bench/float_mesh.hpp"
#include "tests/support/shapes.hpp"

namespace {

using namespace spm;
using namespace spm::bench;

constexpr double tolerance = 50e-6;  // m
constexpr double ball_radius = 0.012;
const Vector3 box_size(0.02, 0.016, 0.012);

Model model_of(const test::Shape& shape) {
  return {{"shape", "shape", tolerance}, test::as_mesh(shape)};
}

/// Signed distance to the box.
double box_distance(const Vector3& point) {
  const Vector3 beyond = point.cwiseAbs() - box_size / 2;
  return beyond.cwiseMax(0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

/// A place in the box around the shape, grown by the margin.
Vector3 place_around(const Model& model, std::uint64_t index) {
  return test::point_around(model.mesh, model.band.margin, baker::random_unit(5, 3 * index),
                            baker::random_unit(5, 3 * index + 1),
                            baker::random_unit(5, 3 * index + 2));
}

bool in_band(double distance) {
  return distance > -bench_band.max_depth && distance < bench_band.margin;
}

/// The largest error of a method against a closed form, over places of the band.
template <class Truth>
double largest_error(const Method& method, const Model& model, const Truth& truth) {
  double largest = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    const Vector3 point = place_around(model, i);
    const double distance = truth(point);
    if (!in_band(distance)) continue;
    const double error = std::abs(method.query(point).distance - distance);
    // Not a number is the largest error of all.
    if (!(error <= largest)) largest = error;
  }
  return largest;
}

}  // namespace

TEST_CASE("Methods that keep the triangles answer exactly in the band") {
  const Model model = model_of(test::box(box_size));
  std::vector<std::unique_ptr<Method>> methods;
  methods.push_back(make_triangle_grid(model, 1e-3));
  methods.push_back(make_triangle_grid(model, 2e-3));
  methods.push_back(make_embree(model, false));
  methods.push_back(make_embree(model, true));
  for (const auto& method : methods) {
    INFO(method->facts().name << " " << method->facts().settings);
    CHECK(largest_error(*method, model, box_distance) < 1e-8);
    const Answer above = method->query({0.001, 0.002, box_size.z() / 2 + 0.0003});
    CHECK((above.normal - Vector3::UnitZ()).norm() < 1e-6);
    const Answer below = method->query({0.001, 0.002, -box_size.z() / 2 + 0.0003});
    CHECK((below.normal + Vector3::UnitZ()).norm() < 1e-6);
    // Beside a corner, where three faces are equally near.
    const Vector3 diagonal = Vector3::Ones().normalized();
    const Answer beside = method->query(box_size / 2 + 0.0004 * diagonal);
    CHECK(beside.distance == Approx(0.0004).epsilon(1e-4));
    CHECK((beside.normal - diagonal).norm() < 1e-4);
  }
}

TEST_CASE("Distance fields are exact where the distance is linear") {
  const Model model = model_of(test::box(box_size));
  std::vector<std::unique_ptr<Method>> methods;
  methods.push_back(make_openvdb(sample_band(model, 1e-3)));
  methods.push_back(make_dense_sdf(sample_band(model, 1e-3)));
  methods.push_back(make_adaptive_sdf(model, tolerance));
  for (const auto& method : methods) {
    INFO(method->facts().name);
    for (std::uint64_t i = 0; i < 200; ++i) {
      const double height = -0.002 + 0.0025 * baker::random_unit(7, 3 * i);
      const Vector3 point(0.004 * (baker::random_unit(7, 3 * i + 1) - 0.5),
                          0.004 * (baker::random_unit(7, 3 * i + 2) - 0.5),
                          box_size.z() / 2 + height);
      const Answer answer = method->query(point);
      CHECK(answer.distance == Approx(height).margin(1e-8));
      CHECK((answer.normal - Vector3::UnitZ()).norm() < 1e-4);
    }
  }
}

TEST_CASE("Distance fields of a ball err as little as their cells allow") {
  const Model model = model_of(test::sphere(ball_radius, 5));
  const auto truth = [](const Vector3& point) { return point.norm() - ball_radius; };
  // An eighth of the squared cell times the sum of the second derivatives, 2 / radius, where that
  // is least; and the flat triangles under the ball.
  const double flat = ball_radius - std::abs(model.caster.closest(Vector3::Zero()).distance);
  const auto bound = [flat](double cell) {
    return cell * cell / 4 / (ball_radius - bench_band.max_depth - cell) + flat;
  };
  for (const double cell : {1e-3, 0.5e-3}) {
    const DistanceLattice lattice = sample_band(model, cell);
    const auto sparse = make_openvdb(lattice);
    const auto dense = make_dense_sdf(lattice);
    CHECK(largest_error(*dense, model, truth) < bound(cell));
    CHECK(largest_error(*sparse, model, truth) < bound(cell));
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const Vector3 point = place_around(model, i);
      if (!in_band(truth(point))) continue;
      CHECK(sparse->query(point).distance == dense->query(point).distance);
    }
  }
  // Between the places that it tries an adaptive field may err a little more.
  CHECK(largest_error(*make_adaptive_sdf(model, tolerance), model, truth) < 1.1 * tolerance + flat);
}

TEST_CASE("Beyond the band no method claims a distance") {
  const Model model = model_of(test::box(box_size));
  const Vector3 outside(box_size.x() / 2 + 0.004, 0, 0);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto& method :
       {make_triangle_grid(model, 1e-3), make_adaptive_sdf(model, tolerance)}) {
    CHECK(method->query(outside).status == Status::far);
    CHECK(method->query(Vector3::Zero()).status == Status::deep);
    CHECK(method->query(Vector3::Zero()).distance == -bench_band.max_depth);
  }
  for (const auto& method :
       {make_triangle_grid(model, 1e-3), make_dense_sdf(sample_band(model, 1e-3)),
        make_openvdb(sample_band(model, 1e-3)), make_adaptive_sdf(model, tolerance)}) {
    CHECK(method->query(Vector3::Constant(std::nan(""))).status == Status::far);
    CHECK(method->query(Vector3::Constant(infinity)).status == Status::far);
  }
}

TEST_CASE("Bytes count all that a method keeps") {
  const Model model = model_of(test::box(box_size));
  const std::uint64_t mesh = FloatMesh::bytes_of(8, 12);
  CHECK(mesh == 8 * 3 * sizeof(float) + 12 * 3 * sizeof(std::uint32_t));
  CHECK(FloatMesh(model.surface).bytes() == mesh);

  // 21 x 17 x 13 mm with the margin: so many cells, and nodes one more and one to spare.
  const std::uint64_t nodes = 23 * 19 * 15;
  CHECK(make_dense_sdf(sample_band(model, 1e-3))->facts().bytes == nodes * sizeof(float));

  const std::uint64_t cells = 22 * 18 * 14;
  const std::uint64_t grid = make_triangle_grid(model, 1e-3)->facts().bytes;
  // The twelve triangles make few different lists, each of which is kept once.
  CHECK(grid > mesh + 4 * cells);
  CHECK(grid < mesh + 4 * cells + 4 * 13 * 200);

  const std::uint64_t compact = make_embree(model, true)->facts().bytes;
  CHECK(compact > mesh);
  CHECK(compact <= make_embree(model, false)->facts().bytes);

  // At the least the floats of a leaf of 8 voxels a side for every 8 mm.
  CHECK(make_openvdb(sample_band(model, 1e-3))->facts().bytes > 3 * 2 * 2 * 512 * sizeof(float));

  const auto coarse = make_adaptive_sdf(model, 1e-3);
  const auto fine = make_adaptive_sdf(model, tolerance);
  CHECK(coarse->facts().bytes < fine->facts().bytes);
  CHECK(coarse->facts().bytes % 4 == 0);
}
