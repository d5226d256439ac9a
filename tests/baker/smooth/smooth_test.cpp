// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/smooth/smooth.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "baker/base/bake_error.hpp"
#include "baker/cast/cast.hpp"
#include "baker/smooth/mesh_refine.hpp"
#include "baker/surface/outer_surface.hpp"
#include "common/base/random.hpp"
#include "common/paper/smoothing.hpp"
#include "tests/baker/pipeline/bake_support.hpp"
#include "tests/baker/verify/verify_shapes.hpp"

namespace smooth_test {

using namespace spm;
using namespace spm::baker;

namespace {

constexpr double degree = std::numbers::pi / 180;
/// The share of its variance that a Gaussian keeps when it is cut off at three sigmas.
const double kept_variance = (1 - 5.5 * std::exp(-4.5)) / (1 - std::exp(-4.5));

SmoothOptions gaussian(double sigma) { return {Smoothing::gaussian, sigma, 0}; }
SmoothOptions crease(double angle, double sigma = 0) { return {Smoothing::crease, sigma, angle}; }

Mesh smoothed(const test::Shape& shape, const SmoothOptions& options, SmoothReport& report) {
  return smoothed_mesh(test::as_mesh(shape), options, {}, report);
}

Mesh smoothed(const test::Shape& shape, const SmoothOptions& options) {
  SmoothReport report;
  return smoothed(shape, options, report);
}

Caster caster_of(const Mesh& mesh) {
  OuterSurface surface;
  surface.vertices = mesh.vertices;
  surface.triangles = mesh.triangles;
  surface.solid_count = mesh.triangles.size();
  return Caster(surface);
}

/// Farthest vertex of a mesh from a surface, m.
double farthest(const Mesh& mesh, const Caster& from) {
  double distance = 0;
  for (const Vector3& vertex : mesh.vertices) {
    distance = std::max(distance, std::abs(from.closest(vertex).distance));
  }
  return distance;
}

/// Block whose top, `cells` by `cells`, is `height` above z = 0; 40 mm wide about the z axis.
test::Shape block(int cells, const std::function<double(double, double)>& height) {
  constexpr double width = 0.04;
  test::Shape shape;
  const auto index = [&](int i, int j, int layer) {
    return static_cast<std::uint32_t>((layer * (cells + 1) + j) * (cells + 1) + i);
  };
  for (int layer = 0; layer < 2; ++layer) {
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells; ++i) {
        const double x = width * i / cells - width / 2;
        const double y = width * j / cells - width / 2;
        shape.vertices.emplace_back(x, y, layer == 0 ? -0.01 : height(x, y));
      }
    }
  }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    shape.triangles.push_back({a, b, c});
    shape.triangles.push_back({a, c, d});
  };
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      quad(index(i, j, 1), index(i + 1, j, 1), index(i + 1, j + 1, 1), index(i, j + 1, 1));
      quad(index(i, j, 0), index(i, j + 1, 0), index(i + 1, j + 1, 0), index(i + 1, j, 0));
    }
  }
  for (int k = 0; k < cells; ++k) {
    quad(index(k, 0, 0), index(k + 1, 0, 0), index(k + 1, 0, 1), index(k, 0, 1));
    quad(index(k + 1, cells, 0), index(k, cells, 0), index(k, cells, 1), index(k + 1, cells, 1));
    quad(index(0, k + 1, 0), index(0, k, 0), index(0, k, 1), index(0, k + 1, 1));
    quad(index(cells, k, 0), index(cells, k + 1, 0), index(cells, k + 1, 1), index(cells, k, 1));
  }
  return shape;
}

/// The top's vertices at least `border` from its rim.
std::vector<Vector3> top_of(const Mesh& mesh, double border) {
  std::vector<Vector3> top;
  for (const Vector3& v : mesh.vertices) {
    const double from_rim = 0.02 - std::max(std::abs(v.x()), std::abs(v.y()));
    if (v.z() > -0.003 && from_rim >= border) top.push_back(v);
  }
  return top;
}

double rms_height(const std::vector<Vector3>& points) {
  double squares = 0;
  for (const Vector3& point : points) squares += point.z() * point.z();
  return std::sqrt(squares / static_cast<double>(points.size()));
}

ExitCode refusal(const test::Shape& shape, const SmoothOptions& options) {
  try {
    (void)smoothed(shape, options);
  } catch (const BakeError& error) {
    return error.code();
  }
  return ExitCode::done;
}

/// Largest turn between two triangles whose shared edge's middle is in a region, rad.
double largest_turn(const Mesh& mesh, const std::function<bool(const Vector3&)>& region) {
  const SurfaceMesh surface_mesh{mesh.vertices, mesh.triangles};
  double turn = 0;
  for (const MeshEdge& edge : edges_of(surface_mesh).edges) {
    const Vector3 middle =
        (surface_mesh.vertices[edge.ends[0]] + surface_mesh.vertices[edge.ends[1]]) / 2;
    if (region(middle)) turn = std::max(turn, edge.turn);
  }
  return turn;
}

}  // namespace

TEST_CASE("A sphere stays one and shrinks by the variance over its radius") {
  const double radius = 0.02;
  for (const double sigma : {0.001, 0.002}) {
    const Mesh mesh = smoothed(test::sphere(radius, 5), gaussian(sigma));
    const double expected = radius - kept_variance * sigma * sigma / radius;
    double low = 1, high = 0;
    for (const Vector3& vertex : mesh.vertices) {
      low = std::min(low, vertex.norm());
      high = std::max(high, vertex.norm());
    }
    CHECK(low > expected - 0.1 * (radius - expected));
    CHECK(high < expected + 0.1 * (radius - expected));
  }
}

TEST_CASE("A wave is damped as the filter of a distance map damps it") {
  const double sigma = 0.0012, amplitude = 20e-6, turns = 2 * std::numbers::pi / 0.006;
  const Mesh mesh =
      smoothed(block(100, [&](double x, double) { return amplitude * std::cos(turns * x); }),
               gaussian(sigma));
  GaussianWindow<double> window(sigma, 0);
  const double step = sigma / 10;
  for (int i = -30; i <= 30; ++i) {
    for (int j = -30; j <= 30; ++j) {
      if (i * i + j * j > 900) continue;
      window.add(i * step, j * step, step * step, amplitude * std::cos(turns * i * step));
    }
  }
  double worst = 0;
  for (const Vector3& v : top_of(mesh, 0.005)) {
    worst = std::max(worst, std::abs(v.z() - window.value() * std::cos(turns * v.x())));
  }
  CHECK(window.value() < 0.6 * amplitude);
  CHECK(worst < 0.05 * amplitude);
}

TEST_CASE("A noisy face gets quieter, and its neighbours stay flat") {
  std::uint64_t drawn = 0;
  const test::Shape noisy =
      block(60, [&](double, double) { return 60e-6 * (random_unit(3, drawn++) - 0.5); });
  const Mesh before = test::as_mesh(noisy);
  const Mesh after = smoothed(noisy, gaussian(0.001));
  CHECK(rms_height(top_of(after, 0.004)) < 0.3 * rms_height(top_of(before, 0.004)));
  for (const Vector3& v : after.vertices) {
    if (std::abs(v.x()) < 0.015 && std::abs(v.y()) < 0.015 && v.z() < -0.005) {
      CHECK(v.z() == -0.01);
    }
  }
}

TEST_CASE("A Gaussian rounds the edges of a box and leaves its faces where they are") {
  const double sigma = 0.002;
  SmoothReport report;
  const Mesh mesh = smoothed(test::box({0.03, 0.03, 0.03}), gaussian(sigma), report);
  const Caster caster = caster_of(mesh);
  // Along either face, what lies beyond the edge adds the mean of a Gaussian's positive part.
  const double inward = sigma / std::sqrt(2 * std::numbers::pi);
  for (const Vector3& edge : {Vector3(0.015, 0.015, 0), Vector3(-0.015, 0, 0.015)}) {
    CHECK(caster.closest(edge).distance == Approx(std::numbers::sqrt2 * inward).epsilon(0.03));
  }
  CHECK(std::abs(caster.closest({0.015, 0.003, -0.004}).distance) < 1e-12);
  CHECK(report.max > 1.5 * inward);  // the corners
  CHECK(report.max < 3 * inward);
  CHECK(report.rms < report.p99);
  CHECK(report.p99 < report.max);
  CHECK(largest_turn(mesh, [](const Vector3&) { return true; }) < 30 * degree);
}

TEST_CASE("A crease angle keeps the edges of a box where a Gaussian rounds them") {
  const test::Shape box = test::box({0.03, 0.03, 0.03});
  SmoothReport report;
  const Mesh mesh = smoothed(box, crease(30 * degree), report);
  CHECK(report.max == 0);
  CHECK(farthest(test::as_mesh(box), caster_of(mesh)) == 0);
  (void)smoothed(box, crease(100 * degree, 0.002), report);
  CHECK(report.max > 0.001);
}

TEST_CASE("A crease angle smooths the facets of a cylinder and keeps its rims") {
  const double radius = 0.01, height = 0.02;
  const test::Shape shape = test::cylinder(radius, height, 36);
  const Mesh mesh = smoothed(shape, crease(30 * degree, 0.001));
  const auto on_side = [&](const Vector3& v) { return std::abs(v.z()) < 0.006; };
  CHECK(largest_turn(test::as_mesh(shape), on_side) == Approx(10 * degree));
  CHECK(largest_turn(mesh, on_side) < 6 * degree);
  const Caster caster = caster_of(mesh);
  for (const Vector3& vertex : shape.vertices) {
    CHECK(std::abs(caster.closest(vertex).distance) < 1e-12);
  }
  // The caps are flat and end at the rims.
  for (const Vector3& v : mesh.vertices) {
    CHECK(std::abs(v.z()) <= height / 2);
    CHECK(std::hypot(v.x(), v.y()) <= radius * (1 + 1e-12));
  }
}

TEST_CASE("Plates nearer to each other than the kernel do not attract each other") {
  const double gap = 0.0002, sigma = 0.001, half = 0.01, thickness = 0.002;
  const test::Shape plate = test::plate({2 * half, 2 * half, thickness});
  const Mesh both =
      smoothed(test::merged(plate, test::moved(plate, {0, 0, thickness + gap})), gaussian(sigma));
  for (const Vector3& v : both.vertices) {
    // Each stays where it was, and its faces stay flat, away from the rims that are rounded.
    const Vector3 own = v.z() < (thickness + gap) / 2 ? v : v - Vector3(0, 0, thickness + gap);
    REQUIRE(std::abs(own.z()) <= thickness / 2 * (1 + 1e-12));
    if (std::max(std::abs(v.x()), std::abs(v.y())) < half - 3.1 * sigma) {
      CHECK(std::abs(own.z()) == Approx(thickness / 2).epsilon(1e-9));
    }
  }
}

TEST_CASE("The silhouette of a layer does not bleed into the layer behind it") {
  const double sigma = 0.001;
  const test::Shape base = test::box({0.03, 0.03, 0.004});
  // Seen from above, the plate's rim is a step of half a sigma in the middle of the base's top.
  const test::Shape over = test::moved(test::plate({0.01, 0.02, 0.0003}), {0.005, 0, 0.0023});
  const Caster caster = caster_of(smoothed(test::merged(base, over), gaussian(sigma)));
  for (int i = -10; i <= 10; ++i) {
    CHECK(std::abs(caster.closest({0.0005 * i, 0.002, 0.002}).distance) < 1e-12);
  }
}

TEST_CASE("A step of a solid is smoothed about its own edges only") {
  const double sigma = 0.001;
  const Caster caster = caster_of(
      smoothed(test::merged(test::box({0.03, 0.03, 0.01}),
                            test::moved(test::box({0.015, 0.03, 0.01}), {0.0075, 0, 0.008})),
               gaussian(sigma)));
  for (const double away : {4.2, 8.0}) {
    CHECK(std::abs(caster.closest({-away * sigma, 0, 0.005}).distance) < 1e-12);
    CHECK(std::abs(caster.closest({away * sigma, 0, 0.013}).distance) < 1e-12);
  }
  CHECK(caster.closest({0, 0, 0.005}).distance <
        -0.5 * sigma);  // a fillet at the step's closest point
  CHECK(caster.closest({0, 0, 0.013}).distance > 0.5 * sigma);
}

TEST_CASE("A plate much thinner than the kernel stays a plate with a closed surface") {
  const double sigma = 0.001, width = 0.02, thickness = 0.0002;
  const Mesh mesh = smoothed(test::plate({width, width, thickness}), gaussian(sigma));
  const OuterSurface surface = outer_surface(mesh);
  double volume = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    volume += surface.vertices[a].dot(surface.vertices[b].cross(surface.vertices[c])) / 6;
  }
  CHECK(volume < width * width * thickness);
  CHECK(volume > 0.7 * width * width * thickness);
  for (const Vector3& v : mesh.vertices) CHECK(std::abs(v.z()) <= thickness / 2 * (1 + 1e-12));
}

TEST_CASE("Sheets stay as they are, and what is solid is smoothed") {
  const test::Shape solid = test::box({0.02, 0.02, 0.02});
  test::Shape sheet;
  sheet.vertices = {{0.02, -0.01, 0}, {0.04, -0.01, 0}, {0.04, 0.01, 0.01}, {0.02, 0.01, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  Mesh mesh = test::as_mesh(test::merged(solid, sheet));
  mesh.sheet_triangles = 2;
  SmoothReport report;
  const Mesh after = smoothed_mesh(mesh, gaussian(0.001), {}, report);
  CHECK(report.max > 20e-6);
  REQUIRE(after.sheet_triangles == 2);
  std::vector<Vector3> corners;
  for (std::size_t t = after.solid_triangles(); t < after.triangles.size(); ++t) {
    for (const std::uint32_t corner : after.triangles[t]) corners.push_back(after.vertices[corner]);
  }
  for (const Vector3& vertex : sheet.vertices) {
    CHECK(std::find(corners.begin(), corners.end(), vertex) != corners.end());
  }
}

TEST_CASE("Smoothing is the same for any number of threads") {
  const test::Shape shape = test::merged(test::torus(0.02, 0.006, 24, 8),
                                         test::moved(test::box({0.02, 0.02, 0.02}), {0, 0, 0.02}));
  const auto vertices = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return smoothed(shape, gaussian(0.002)).vertices;
  };
  CHECK(vertices(1) == vertices(2));
}

TEST_CASE("Words of --smooth are read with their units, and others are usage errors") {
  CHECK(parse_smoothing("none")->kind == Smoothing::none);
  CHECK(parse_smoothing("gaussian:0.5mm")->sigma == 0.0005);
  CHECK(parse_smoothing("crease:30deg")->angle == Approx(30 * degree));
  for (const char* text :
       {"", "gaussian", "gaussian:", "gaussian:1", "gaussian:0mm", "gaussian:-1mm",
        "gaussian:30deg", "gaussian:nanmm", "crease", "crease:30", "crease:0deg", "crease:180deg",
        "crease:200deg", "crease:1mm", "median:1mm", "Gaussian:1mm"}) {
    INFO(text);
    const Result<SmoothOptions> read = parse_smoothing(text);
    REQUIRE_FALSE(read.has_value());
    CHECK(read.error().code == ExitCode::usage);
  }
}

TEST_CASE("A kernel that is too large or too small for the object is a usage error") {
  const test::Shape sphere = test::sphere(0.02, 3);
  CHECK(refusal(sphere, gaussian(0.1)) == ExitCode::usage);
  CHECK(refusal(sphere, gaussian(0.008)) == ExitCode::usage);
  CHECK(refusal(sphere, gaussian(1e-6)) == ExitCode::usage);
  CHECK(refusal(sphere, gaussian(0.002)) == ExitCode::done);
}

TEST_CASE("A surface that would need too many triangles is a usage error") {
  const test::Shape box = test::box({0.03, 0.03, 0.03});
  const auto every = [](const MeshEdge&) { return true; };
  const SurfaceMesh surface_mesh{box.vertices, box.triangles};
  CHECK(refined(surface_mesh, every, 0.005, 0.01, 4000).triangles.size() < 4000);
  CHECK_THROWS_AS(refined(surface_mesh, every, 0.001, 0.01, 4000), BakeError);
}

TEST_CASE("Refining leaves no long edge near a chosen one, and no gap") {
  const test::Shape box = test::box({0.03, 0.03, 0.0003});
  const auto sharp = [](const MeshEdge& edge) { return edge.turn > 1; };
  const SurfaceMesh fine = refined({box.vertices, box.triangles}, sharp, 0.001, 0.004, 100000);
  double area = 0;
  for (const MeshEdge& edge : edges_of(fine).edges) {
    const Vector3& a = fine.vertices[edge.ends[0]];
    const Vector3& b = fine.vertices[edge.ends[1]];
    CHECK(edge.paired);
    area += edge.area;
    const bool near = std::max({std::abs(a.x()), std::abs(a.y()), std::abs(b.x()),
                                std::abs(b.y())}) > 0.015 - 0.004;
    if (near) CHECK((a - b).norm() <= 0.001);
  }
  CHECK(area == Approx(2 * 0.03 * 0.03 + 4 * 0.03 * 0.0003).epsilon(1e-9));
  // Narrow strips are cut across, and the middle of the faces stays coarse.
  CHECK(fine.triangles.size() < 8000);
  CHECK(fine.triangles.size() > 2000);
}

TEST_CASE("An asset's options give back the smoothing that they record") {
  const auto again = [](const SmoothOptions& options) {
    const nlohmann::ordered_json json = {{"smooth", smoothing_json(options)}};
    return recorded_smoothing(json.dump()).value();
  };
  CHECK(again(gaussian(0.0003)).sigma == 0.0003);
  CHECK(again(crease(0.5, 0.001)).angle == 0.5);
  CHECK(again(crease(0.5, 0.001)).sigma == 0.001);
  CHECK(recorded_smoothing("{}")->kind == Smoothing::none);
  CHECK(recorded_smoothing(R"({"smooth":{"kind":"median"}})").error().code ==
        ExitCode::invalid_input);
  CHECK_FALSE(recorded_smoothing(R"({"smooth":{"kind":"gaussian","sigma":0}})").has_value());
  CHECK_FALSE(recorded_smoothing(R"({"smooth":7})").has_value());
}

}  // namespace smooth_test
