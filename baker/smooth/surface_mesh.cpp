// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/smooth/surface_mesh.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "baker/mesh/mesh_edges.hpp"

namespace spm::baker {
namespace {

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

std::vector<Vector3> areas_of(const SurfaceMesh& surface_mesh) {
  std::vector<Vector3> areas(surface_mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, areas.size(), [&](std::size_t i) {
    const auto& [a, b, c] = surface_mesh.triangles[i];
    const Vector3& from = surface_mesh.vertices[a];
    areas[i] = (surface_mesh.vertices[b] - from).cross(surface_mesh.vertices[c] - from) / 2;
  });
  return areas;
}

/// The edge that a run of sides has in common.
MeshEdge edge_of(std::span<const Vector3> areas, std::span<const HalfEdge> run) {
  MeshEdge edge;
  edge.ends = {run.front().low, run.front().high};
  for (const HalfEdge& side : run) {
    const Vector3& area = areas[side.triangle];
    edge.area += area.norm() / 3;
    for (const HalfEdge& other : run) {
      if (&other == &side) break;
      edge.turn = std::max(edge.turn, angle_between(areas[other.triangle], area));
    }
  }
  edge.paired = is_balanced(run);
  edge.triangles = static_cast<int>(run.size());
  return edge;
}

constexpr std::uint32_t unplaced = 0xFFFFFFFF;

}  // namespace

MeshEdges edges_of(const SurfaceMesh& surface_mesh) {
  const std::vector<HalfEdge> sides = sorted_edges(surface_mesh.triangles);
  const std::vector<Vector3> areas = areas_of(surface_mesh);
  MeshEdges result;
  result.of_sides.resize(surface_mesh.triangles.size());
  std::vector<std::size_t> starts;
  starts.reserve(sides.size() / 2 + 1);
  for_each_edge(sides, [&](std::span<const HalfEdge> run) {
    for (const auto& [low, high, triangle, forward] : run) {
      const Triangle& corners = surface_mesh.triangles[triangle];
      const auto k =
          std::find(corners.begin(), corners.end(), forward ? low : high) - corners.begin();
      result.of_sides[triangle][static_cast<std::size_t>(k)] =
          static_cast<std::uint32_t>(starts.size());
    }
    starts.push_back(static_cast<std::size_t>(run.data() - sides.data()));
  });
  result.edges.resize(starts.size());
  starts.push_back(sides.size());
  tbb::parallel_for(std::size_t{0}, result.edges.size(), [&](std::size_t i) {
    result.edges[i] =
        edge_of(areas, std::span(sides).subspan(starts[i], starts[i + 1] - starts[i]));
  });
  return result;
}

SurfaceMesh in_order_of_space(const SurfaceMesh& surface_mesh) {
  if (surface_mesh.vertices.empty()) return surface_mesh;
  Eigen::AlignedBox3d box;
  for (const Vector3& vertex : surface_mesh.vertices) box.extend(vertex);
  const double step = std::max(box.sizes().maxCoeff(), 1e-300) / 1023;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order;  // code, vertex
  std::vector<std::uint32_t> place(surface_mesh.vertices.size(), unplaced);
  for (const Triangle& triangle : surface_mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (place[corner] != unplaced) continue;
      place[corner] = 0;
      const Vector3 cell = (surface_mesh.vertices[corner] - box.min()) / step;
      std::uint32_t code = 0;
      for (std::uint32_t bit = 0; bit < 10; ++bit) {
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
          const auto along = static_cast<std::uint32_t>(cell[static_cast<int>(axis)]);
          code |= ((along >> bit) & 1U) << (3 * bit + axis);
        }
      }
      order.emplace_back(code, corner);
    }
  }
  tbb::parallel_sort(order.begin(), order.end());
  SurfaceMesh ordered;
  ordered.vertices.reserve(order.size());
  for (const auto& [code, vertex] : order) {
    place[vertex] = static_cast<std::uint32_t>(ordered.vertices.size());
    ordered.vertices.push_back(surface_mesh.vertices[vertex]);
  }
  ordered.triangles.reserve(surface_mesh.triangles.size());
  for (const auto& [a, b, c] : surface_mesh.triangles) {
    ordered.triangles.push_back({place[a], place[b], place[c]});
  }
  return ordered;
}

}  // namespace spm::baker
