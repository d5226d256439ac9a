// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "bake_support.hpp"
#include "common/base/random.hpp"
#include "common/query/query.hpp"

namespace spm::baker::bake_accuracy_test {
namespace {

/// Closed form of a shape: signed distance and outward direction at a point.
struct Exact {
  double distance;
  Vector3 direction;
  double to_edge = 1;  ///< how far the closest point is from the nearest sharp edge, m
};
using ClosedForm = std::function<Exact(const Vector3&)>;

Exact exact_sphere(double radius, const Vector3& p) { return {p.norm() - radius, p.normalized()}; }

Exact exact_torus(double major, double minor, const Vector3& p) {
  const Vector3 ring = Vector3(p.x(), p.y(), 0).normalized() * major;
  return {(p - ring).norm() - minor, (p - ring).normalized()};
}

Exact exact_box(const Vector3& size, const Vector3& p) {
  const Vector3 beyond = p.cwiseAbs() - size / 2;
  const Vector3 side = p.cwiseSign();
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return beyond[a] > beyond[b]; });
  if (beyond.maxCoeff() > 0) {
    const Vector3 outside = beyond.cwiseMax(0.0);
    return {outside.norm(), outside.cwiseProduct(side).normalized(), std::abs(beyond[order[1]])};
  }
  return {beyond[order[0]], side[order[0]] * Vector3::Unit(order[0]),
          beyond[order[0]] - beyond[order[1]]};
}

struct Errors {
  double distance_p99 = 0, direction_p99 = 0;
  std::size_t wrong = 0, unanswered = 0;
};

/// Points 0.1 to 2 mm inside, and up to 0.5 mm outside, spread over the shape by its own vertices.
Errors measure(const AssetView& view, const test::Shape& shape, const ClosedForm& exact) {
  std::vector<double> distances, directions;
  Errors errors;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const auto& t = shape.triangles[random_bits(31, 4 * i) % shape.triangles.size()];
    double x = random_unit(31, 4 * i + 1), y = random_unit(31, 4 * i + 2);
    if (x + y > 1) x = 1 - x, y = 1 - y;
    const Vector3 &a = shape.vertices[t[0]], &b = shape.vertices[t[1]], &c = shape.vertices[t[2]];
    const double wanted = -0.002 + 0.0025 * random_unit(31, 4 * i + 3);
    const Vector3 point =
        a + x * (b - a) + y * (c - a) + wanted * (b - a).cross(c - a).normalized();
    const Exact truth = exact(point);
    if (truth.distance < -0.002 || truth.distance > 0.0005 || std::abs(truth.distance) < 1e-4)
      continue;
    const Answer answer = query_point(view, point);
    if (answer.status != Status::exact && answer.status != Status::deep) {
      ++errors.unanswered;
      continue;
    }
    errors.wrong += (answer.distance < 0) != (truth.distance < 0) ? 1 : 0;
    distances.push_back(std::abs(answer.distance - truth.distance));
    if (truth.to_edge > 0.0005) {
      directions.push_back(std::acos(std::clamp(answer.normal.dot(truth.direction), -1.0, 1.0)));
    }
  }
  const auto p99 = [](std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    return values[values.size() * 99 / 100];
  };
  errors.distance_p99 = p99(distances);
  errors.direction_p99 = p99(directions);
  return errors;
}

void check_both_forms(const test::Shape& shape, const ClosedForm& exact) {
  for (const AssetForm form : {AssetForm::sparse, AssetForm::full}) {
    BakeOptions options;
    options.form = form;
    if (form == AssetForm::full) {
      options.planes = std::min<std::size_t>(200, shape.triangles.size() / 2);
      options.kind = PlaneKind::automatic;
    }
    const BakeResult result = bake(test::mesh_of(shape), options);
    const AssetTables tables = tables_of(result.asset);
    const Errors errors = measure(tables.view(), shape, exact);
    INFO((form == AssetForm::full ? "full" : "sparse"));
    CHECK(errors.wrong == 0);
    CHECK(errors.unanswered == 0);
    CHECK(errors.distance_p99 < 50e-6);
    // Tiles are as coarse as their promised distance and a mean angle of 4 degrees allow.
    const double degrees = form == AssetForm::sparse ? 12 : 3;
    CHECK(errors.direction_p99 < degrees * 3.14159265 / 180);
  }
}

TEST_CASE("On a sphere both forms meet the closed form: side, depth and direction") {
  check_both_forms(test::sphere(0.029, 5), [](const Vector3& p) { return exact_sphere(0.029, p); });
}

TEST_CASE("On a box both forms meet the closed form: side, depth and direction") {
  const Vector3 size(0.048, 0.06, 0.064);
  check_both_forms(test::box(size), [=](const Vector3& p) { return exact_box(size, p); });
}

TEST_CASE("On a torus, concave in its hole, both forms meet the closed form") {
  check_both_forms(test::torus(0.025, 0.0095, 200, 100),
                   [](const Vector3& p) { return exact_torus(0.025, 0.0095, p); });
}

}  // namespace
}  // namespace spm::baker::bake_accuracy_test
