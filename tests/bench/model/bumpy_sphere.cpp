// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/model/bumpy_sphere.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/baker/verify/verify_shapes.hpp"

namespace spm::bench {
namespace {

constexpr double mean_radius = 0.028;  // m
constexpr double bump_height = 0.04;   // of the radius
constexpr double bump_count = 7;
constexpr double slide_step = 40e-6;  // m
constexpr double descent = 0.5e-3;    // m above the surface at the start

double radius_along(const Vector3& direction) {
  const Vector3 waves = (bump_count * direction).array().sin();
  return mean_radius * (1 + bump_height * waves.prod());
}

}  // namespace

baker::Mesh bumpy_sphere(int subdivisions) {
  test::Shape shape = test::sphere(1, subdivisions);
  for (Vector3& vertex : shape.vertices) vertex *= radius_along(vertex);
  baker::Mesh mesh = test::as_mesh(shape);
  mesh.path = "bumpy sphere";
  // There is no file, but a bake needs a source name.
  mesh.sha256 = std::string(64, '0');
  return mesh;
}

std::vector<Vector3> bumpy_slide(std::size_t steps, double depth) {
  std::vector<Vector3> path;
  path.reserve(steps);
  const double turn = slide_step / mean_radius;
  for (std::size_t i = 0; i < steps; ++i) {
    const double angle = turn * static_cast<double>(i);
    // A slow drift towards the poles, so that the path visits no place twice.
    const double height = 0.8 * std::sin(0.13 * angle + 0.3);
    const double flat = std::sqrt(1 - height * height);
    const Vector3 direction(flat * std::cos(angle), flat * std::sin(angle), height);
    const double down = std::min(1.0, slide_step * static_cast<double>(i) / (depth + descent));
    path.push_back((radius_along(direction) + descent - down * (depth + descent)) * direction);
  }
  return path;
}

}  // namespace spm::bench
