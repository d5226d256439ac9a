// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/report_surface.hpp"

#include <tbb/parallel_for.h>

#include <string_view>
#include <vector>

#include "baker/report/report_page.hpp"
#include "baker/verify/exact_surface.hpp"
#include "baker/verify/render.hpp"

namespace spm::baker {

namespace {

constexpr double micro = 1e6;

template <class Number>
std::string packed(const std::vector<Number>& numbers) {
  return base64({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)});
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
  OuterSurface surface = outer_surface(mesh);
  surface.triangles.resize(surface.surface_count);  // without caps
  if (surface.triangles.size() > most_drawn_triangles) {
    return {{"left_out", "The surface of " + std::to_string(surface.triangles.size()) +
                             " triangles is too large to be drawn here."}};
  }
  const ExactSurface exact(mesh);
  const ErrorScale scale{exact, view, report.band,
                         metadata.tolerance.value_or(metadata.diagonal / 1000)};
  std::vector<float> positions;
  positions.reserve(3 * surface.vertices.size());
  for (const Vector3& vertex : surface.vertices) {
    for (const double part : vertex) positions.push_back(static_cast<float>(part));
  }
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * surface.triangles.size());
  for (const Triangle& triangle : surface.triangles) {
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  }
  return {{"positions", packed(positions)},
          {"triangles", packed(corners)},
          {"errors", packed(errors_at(surface, scale))},
          {"scale_um", scale.tolerance * micro}};
}

}  // namespace spm::baker
