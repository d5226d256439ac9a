// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/report_surface.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "baker/report/report_page.hpp"
#include "baker/verify/exact_surface.hpp"
#include "baker/verify/render.hpp"

namespace spm::baker {

namespace {

constexpr double micro = 1e6;

/// Steps of a coordinate over the surface's box: finer than any screen.
constexpr double coordinate_steps = 65535;

template <class Number>
std::string packed(const std::vector<Number>& numbers) {
  return base64(
      deflated({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)}));
}

/// Numbers as what each adds to the one before: neighbours are close, so that they pack small.
std::vector<std::uint32_t> differences(const std::vector<std::uint32_t>& numbers) {
  std::vector<std::uint32_t> list;
  list.reserve(numbers.size());
  std::uint32_t before = 0;
  for (const std::uint32_t number : numbers) list.push_back(number - std::exchange(before, number));
  return list;
}

/// The bytes of numbers, all lowest ones first: those that change little stand together.
template <class Number>
std::vector<std::uint8_t> planes_of(const std::vector<Number>& numbers) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(numbers.size() * sizeof(Number));
  for (std::size_t place = 0; place < sizeof(Number); ++place) {
    for (const Number number : numbers) {
      bytes.push_back(static_cast<std::uint8_t>(number >> (8 * place)));
    }
  }
  return bytes;
}

/// Unit, at each vertex, weighted by the areas of its triangles.
std::vector<Vector3> normals_of(const OuterSurface& surface) {
  std::vector<Vector3> normals(surface.vertices.size(), Vector3::Zero());
  for (const Triangle& corners : surface.triangles) {
    const auto& [a, b, c] = corners;
    const Vector3 area = (surface.vertices[b] - surface.vertices[a])
                             .cross(surface.vertices[c] - surface.vertices[a]);
    for (const std::uint32_t corner : corners) normals[corner] += area;
  }
  for (Vector3& normal : normals) normal.normalize();
  return normals;
}

std::vector<float> errors_at(const OuterSurface& surface, const ErrorScale& scale) {
  const std::vector<Vector3> normals = normals_of(surface);
  std::vector<float> errors(surface.vertices.size(), -1);
  tbb::parallel_for(std::size_t{0}, errors.size(), [&](std::size_t i) {
    const auto error = largest_error_at(scale, surface.vertices[i], normals[i]);
    if (error) errors[i] = static_cast<float>(*error * micro);
  });
  return errors;
}

}  // namespace

nlohmann::ordered_json surface_json(const Mesh& mesh, const AssetView& view,
                                    const AssetMetadata& metadata, const VerifyReport& report) {
  const OuterSurface surface = outer_surface(mesh);
  if (surface.triangles.size() > most_drawn_triangles) {
    return {{"left_out", "The surface of " + std::to_string(surface.triangles.size()) +
                             " triangles is too large to be drawn here."}};
  }
  const double tolerance = answer_tolerance(metadata);
  const ExactSurface exact(mesh, metadata.sheet_thickness, tolerance);
  const ErrorScale scale{exact, view, report.band, tolerance};
  Vector3 low = surface.vertices.front(), high = low;
  for (const Vector3& vertex : surface.vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  const double step = std::max((high - low).maxCoeff(), 1e-12) / coordinate_steps;
  std::vector<std::uint16_t> positions;
  positions.reserve(3 * surface.vertices.size());
  for (const Vector3& vertex : surface.vertices) {
    for (const double part : Vector3((vertex - low) / step)) {
      positions.push_back(static_cast<std::uint16_t>(std::lround(part)));
    }
  }
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * surface.triangles.size());
  for (const Triangle& triangle : surface.triangles) {
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  }
  return {{"origin_m", {low.x(), low.y(), low.z()}},
          {"step_m", step},
          {"positions", packed(planes_of(positions))},
          {"triangles", packed(planes_of(differences(corners)))},
          {"errors", packed(errors_at(surface, scale))},
          {"scale_um", scale.tolerance * micro}};
}

}  // namespace spm::baker
