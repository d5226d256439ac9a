// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/methods/methods.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "common/base/random.hpp"
#include "tests/baker/verify/verify_shapes.hpp"
#include "tests/bench/base/temporary_folder.hpp"
#include "tests/bench/methods/probe_method.hpp"
#include "tests/bench/methods/score.hpp"
#include "tests/bench/model/float_mesh.hpp"
#include "tests/support/shapes.hpp"

namespace methods_test {

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
  return test::point_around(model.mesh, model.band.margin, random_unit(5, 3 * index),
                            random_unit(5, 3 * index + 1), random_unit(5, 3 * index + 2));
}

bool in_band(double distance) {
  return distance > -bench_band.max_depth && distance < bench_band.margin;
}

std::unique_ptr<Method> make_grid(const Model& model, double cell, GridLists lists) {
  return make_triangle_grid(model, find_cell_triangles(model, cell), lists);
}

/// The largest error of a method against a closed form, over places in the band.
template <class Truth>
double largest_error(const Method& method, const Model& model, const Truth& truth) {
  double largest = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    const Vector3 point = place_around(model, i);
    const double distance = truth(point);
    if (!in_band(distance)) continue;
    const double error = std::abs(method.query(point).distance - distance);
    // NaN counts as the largest error of all.
    if (!(error <= largest)) largest = error;
  }
  return largest;
}

}  // namespace

TEST_CASE("Methods that keep the triangles answer exactly in the band") {
  const Model model = model_of(test::box(box_size));
  std::vector<std::unique_ptr<Method>> methods;
  for (const GridLists lists : {GridLists::own, GridLists::shared}) {
    methods.push_back(make_grid(model, 1e-3, lists));
    methods.push_back(make_grid(model, 2e-3, lists));
  }
  for (const EmbreeTree kind :
       {EmbreeTree::compact, EmbreeTree::standard, EmbreeTree::high_quality}) {
    methods.push_back(make_embree(model, kind));
  }
  methods.push_back(make_cgal_tree(model));
  methods.push_back(make_fcl(model));
  methods.push_back(make_bullet(model));
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

TEST_CASE("Methods that name one nearest triangle agree with the truth on a ball, sides and all") {
  const Model model = model_of(test::sphere(ball_radius, 3));
  const Places places = draw_places(model, 3000, 1);
  std::vector<std::unique_ptr<Method>> methods;
  methods.push_back(make_grid(model, 1e-3, GridLists::own));
  methods.push_back(make_embree(model, EmbreeTree::standard));
  methods.push_back(make_cgal_tree(model));
  methods.push_back(make_fcl(model));
  methods.push_back(make_bullet(model));
  for (const auto& method : methods) {
    INFO(method->facts().name);
    const Score result = score(*method, model, places);
    // Corners are floats.
    CHECK(result.max < 1e-8);
    CHECK(result.direction_p99 < 1e-3);
    CHECK(result.misclassified == 0);
    CHECK(result.unanswered == 0);
  }
}

TEST_CASE("The paper's rule is exact inside a box, whose facets are its planes") {
  const Model model = model_of(test::box(box_size));
  const auto method = make_paper(model, 6, 33);
  CHECK(method->facts().settings == "6 planes, 33x33");
  CHECK(method->facts().resident_bytes > sizeof(float) * 6 * 33 * 33);
  double asked = 0, answered = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Vector3 point = place_around(model, i);
    const double distance = box_distance(point);
    if (!in_band(distance) || distance > 0) continue;
    const Answer answer = method->query(point);
    ++asked;
    // At a map's border the nearest sample may miss the box.
    if (answer.status == Status::far) continue;
    ++answered;
    CHECK(answer.distance == Approx(distance).margin(1e-8));
    CHECK(answer.normal.norm() == Approx(1));
  }
  CHECK(answered > 0.95 * asked);
}

TEST_CASE("The product answers a batch, and without lanes, as it answers point by point") {
  Model model = model_of(test::sphere(ball_radius, 3));
  model.mesh.sha256 = std::string(64, '0');
  const TemporaryFolder folder;
  const BakedFile file = bake_sparse(model.mesh, {model.band, 200e-6}, folder.path());
  const QueryAsset asset = open_query_asset(file.path);
  const auto one = make_spm(file, asset);
  const auto many = GENERATE(make_spm_batch, make_spm_scalar)(file, asset);
  std::vector<Vector3> points;
  for (std::uint64_t i = 0; i < 200; ++i) points.push_back(place_around(model, i));
  std::vector<Answer> answers(points.size());
  many->query_all(points, answers);
  std::size_t exact = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Answer answer = one->query(points[i]);
    CHECK(answer.status == answers[i].status);
    CHECK(answer.normal == answers[i].normal);
    if (answer.status != Status::exact) continue;
    ++exact;
    CHECK(answer.distance == answers[i].distance);
  }
  CHECK(exact > 10);

  const double radius = 0.5e-3;
  std::vector<std::unique_ptr<ProbeMethod>> probes;
  probes.push_back(make_spm_probe(file, radius));
  probes.push_back(make_fcl_probe(model, radius));
  probes.push_back(make_bullet_probe(model, radius));
  for (const auto& probe : probes) {
    INFO(probe->name());
    const double error = probe->name() == "spm" ? 250e-6 : 1e-6;
    const double flat = ball_radius - std::abs(model.caster.closest(Vector3::Zero()).distance);
    const Vector3 touching(0, 0, ball_radius + 0.2e-3);
    CHECK(probe->depth(touching) == Approx(0.3e-3).margin(error + flat));
    CHECK(probe->depth({0, 0, ball_radius + 0.9e-3}) == 0);
  }
}

TEST_CASE("Distance fields are exact where the distance is linear") {
  const Model model = model_of(test::box(box_size));
  std::vector<std::unique_ptr<Method>> methods;
  methods.push_back(make_openvdb(sample_band(model, 1e-3)));
  methods.push_back(make_dense_sdf(sample_band(model, 1e-3)));
  methods.push_back(make_nanovdb(sample_band(model, 1e-3), NanoVoxel::float32));
  methods.push_back(make_adaptive_sdf(model, tolerance));
  for (const auto& method : methods) {
    INFO(method->facts().name);
    for (std::uint64_t i = 0; i < 200; ++i) {
      const double height = -0.002 + 0.0025 * random_unit(7, 3 * i);
      const Vector3 point(0.004 * (random_unit(7, 3 * i + 1) - 0.5),
                          0.004 * (random_unit(7, 3 * i + 2) - 0.5), box_size.z() / 2 + height);
      const Answer answer = method->query(point);
      CHECK(answer.distance == Approx(height).margin(1e-8));
      CHECK((answer.normal - Vector3::UnitZ()).norm() < 1e-4);
    }
  }
}

TEST_CASE("An hp-adaptive field comes near a plane beside edges as its cells shrink") {
  const Model model = model_of(test::box(box_size));
  const auto truth = [](const Vector3& point) { return box_distance(point); };
  const double rough = largest_error(*make_hp_sdf(model, 20e-6), model, truth);
  const double fine = largest_error(*make_hp_sdf(model, 1e-6), model, truth);
  CHECK(rough < 0.2e-3);
  CHECK(fine < rough / 2);
}

TEST_CASE("Distance fields of a ball err as little as their cells allow") {
  const Model model = model_of(test::sphere(ball_radius, 5));
  const auto truth = [](const Vector3& point) { return point.norm() - ball_radius; };
  // An eighth of the squared cell size times the sum of the second derivatives, 2 / radius, at the
  // least radius; plus the error of the flat triangles under the ball.
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
  // Between the tried places an adaptive field may have a slightly larger error.
  CHECK(largest_error(*make_adaptive_sdf(model, tolerance), model, truth) < 1.1 * tolerance + flat);
  // The estimate is a root mean square; a ball has no place that is much worse than others.
  CHECK(largest_error(*make_hp_sdf(model, hp_share * tolerance), model, truth) < tolerance + flat);
}

TEST_CASE("Beyond the band no method claims a distance") {
  const Model model = model_of(test::box(box_size));
  const Vector3 outside(box_size.x() / 2 + 0.004, 0, 0);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto& method : {make_grid(model, 1e-3, GridLists::own),
                             make_adaptive_sdf(model, tolerance), make_hp_sdf(model, tolerance)}) {
    CHECK(method->query(outside).status == Status::far);
    CHECK(method->query(Vector3::Zero()).status == Status::deep);
    CHECK(method->query(Vector3::Zero()).distance == -bench_band.max_depth);
  }
  for (const auto& method :
       {make_grid(model, 1e-3, GridLists::own), make_dense_sdf(sample_band(model, 1e-3)),
        make_openvdb(sample_band(model, 1e-3)), make_adaptive_sdf(model, tolerance),
        make_hp_sdf(model, tolerance)}) {
    CHECK(method->query(Vector3::Constant(std::nan(""))).status == Status::far);
    CHECK(method->query(Vector3::Constant(infinity)).status == Status::far);
  }
}

TEST_CASE("Bytes count all that a method keeps") {
  const Model model = model_of(test::box(box_size));
  const std::uint64_t mesh = FloatMesh::bytes_of(8, 12);
  CHECK(mesh == sizeof(float) * 8 * 3 + sizeof(std::uint32_t) * 12 * 3);
  CHECK(FloatMesh(model.surface).bytes() == mesh);

  // 21 x 17 x 13 mm with the margin: one cell per mm; nodes are one more, and one to spare.
  const std::uint64_t nodes = std::uint64_t{23} * 19 * 15;
  CHECK(make_dense_sdf(sample_band(model, 1e-3))->facts().resident_bytes == nodes * sizeof(float));

  const std::uint64_t cells = std::uint64_t{22} * 18 * 14;
  const MethodFacts shared = make_grid(model, 1e-3, GridLists::shared)->facts();
  // The twelve triangles make few different lists, and each is stored once.
  CHECK(shared.file_bytes > mesh + 4 * cells);
  CHECK(shared.file_bytes < mesh + 4 * cells + std::uint64_t{4} * 13 * 200);
  // In memory a cell has two words, and the triangles are in two packets.
  CHECK(shared.resident_bytes > mesh + 8 * cells + std::uint64_t{2} * 16 * 32);
  const MethodFacts own = make_grid(model, 1e-3, GridLists::own)->facts();
  CHECK(own.file_bytes == shared.file_bytes);
  CHECK(own.resident_bytes > shared.resident_bytes);

  const std::uint64_t compact = make_embree(model, EmbreeTree::compact)->facts().resident_bytes;
  CHECK(compact > mesh);
  CHECK(compact <= make_embree(model, EmbreeTree::standard)->facts().resident_bytes);

  // At least the floats of one leaf, with 8 voxels per side, for every 8 mm.
  CHECK(make_openvdb(sample_band(model, 1e-3))->facts().resident_bytes >
        sizeof(float) * 3 * 2 * 2 * 512);

  const auto coarse = make_adaptive_sdf(model, 1e-3);
  const auto fine = make_adaptive_sdf(model, tolerance);
  CHECK(coarse->facts().resident_bytes < fine->facts().resident_bytes);
  CHECK(coarse->facts().resident_bytes % 4 == 0);

  const Model ball = model_of(test::sphere(ball_radius, 5));
  const auto rough = make_hp_sdf(ball, 10e-6), smooth = make_hp_sdf(ball, 1e-6);
  CHECK(rough->facts().resident_bytes < smooth->facts().resident_bytes);
  CHECK(rough->facts().file_bytes % 4 == 0);
}

}  // namespace methods_test
