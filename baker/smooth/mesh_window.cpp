// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/smooth/mesh_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "common/paper/smoothing.hpp"

namespace spm::baker {
namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();

/// Turns the counts of each vertex's entries, which are shifted by one, into the indices where its
/// entries begin.
void accumulate(std::vector<std::uint32_t>& first) {
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
}

}  // namespace

MeshNeighbours::MeshNeighbours(const SurfaceMesh& surface_mesh, const MeshEdges& edges,
                               std::vector<char> fixed, std::vector<char> bent)
    : surface_mesh_(surface_mesh),
      fixed_(std::move(fixed)),
      bent_(std::move(bent)),
      first_corner_(surface_mesh.vertices.size() + 1, 0),
      first_neighbour_(surface_mesh.vertices.size() + 1, 0),
      corners_(3 * surface_mesh.triangles.size()),
      neighbours_(2 * edges.edges.size()) {
  add_corners();
  add_neighbours(edges);
}

void MeshNeighbours::add_corners() {
  for (const Triangle& triangle : surface_mesh_.triangles) {
    for (const std::uint32_t corner : triangle) ++first_corner_[corner + 1];
  }
  accumulate(first_corner_);
  std::vector<std::uint32_t> free = first_corner_;
  for (const Triangle& t : surface_mesh_.triangles) {
    const std::array<Vector3, 3> sides{surface_mesh_.vertices[t[1]] - surface_mesh_.vertices[t[0]],
                                       surface_mesh_.vertices[t[2]] - surface_mesh_.vertices[t[1]],
                                       surface_mesh_.vertices[t[0]] - surface_mesh_.vertices[t[2]]};
    const double twice_area = sides[0].cross(sides[1]).norm();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
      corners_[free[t[k]]++] = {
          t[next], t[last], sides[k].norm(), sides[last].norm(), sides[next].norm(), twice_area};
    }
  }
}

void MeshNeighbours::add_neighbours(const MeshEdges& edges) {
  for (const MeshEdge& edge : edges.edges) {
    for (const std::uint32_t end : edge.ends) ++first_neighbour_[end + 1];
  }
  accumulate(first_neighbour_);
  std::vector<std::uint32_t> free = first_neighbour_;
  for (const MeshEdge& edge : edges.edges) {
    const auto& [a, b] = edge.ends;
    const double length2 = (surface_mesh_.vertices[b] - surface_mesh_.vertices[a]).squaredNorm();
    neighbours_[free[a]++] = {b, length2, edge.area};
    neighbours_[free[b]++] = {a, length2, edge.area};
  }
}

MeshWindow::MeshWindow(const MeshNeighbours& neighbours)
    : neighbours_(neighbours),
      distance_(neighbours.surface_mesh().vertices.size(), unknown),
      settled_(neighbours.surface_mesh().vertices.size(), 0) {}

std::optional<Vector3> MeshWindow::smoothed(std::uint32_t vertex, double sigma) {
  if (neighbours_.fixed(vertex)) return std::nullopt;
  offer(vertex, 0);
  const double limit = explore(gaussian_cutoff * sigma, true);
  const bool flat = std::none_of(window_.begin(), window_.end(),
                                 [&](std::uint32_t v) { return neighbours_.bent(v); });
  const std::vector<Vector3>& points = neighbours_.surface_mesh().vertices;
  const Vector3& centre = points[vertex];
  GaussianWindow<Vector3> filter(limit / gaussian_cutoff, Vector3::Zero());
  for (const std::uint32_t from : window_) {
    if (flat) break;
    for (const MeshNeighbours::Neighbour& neighbour : neighbours_.neighbours(from)) {
      const std::uint32_t to = neighbour.vertex;
      if (settled_[to] != 0 && to < from) continue;
      // The middles of the sides integrate a quadratic function exactly. Their distance is the
      // length of a median.
      const double squares = distance_[from] * distance_[from] + distance_[to] * distance_[to];
      const double distance2 = std::max(0.0, (squares - neighbour.length2 / 2) / 2);
      if (distance2 > limit * limit) continue;
      filter.add(std::sqrt(distance2), 0, neighbour.area, (points[from] + points[to]) / 2 - centre);
    }
  }
  forget();
  if (!(filter.weight() > 0)) return std::nullopt;
  return centre + filter.value();
}

std::vector<char> MeshWindow::near_bends(double distance) {
  const auto count = static_cast<std::uint32_t>(neighbours_.surface_mesh().vertices.size());
  for (std::uint32_t vertex = 0; vertex < count; ++vertex) {
    if (neighbours_.bent(vertex)) offer(vertex, 0);
  }
  (void)explore(distance, false);
  std::vector<char> near = settled_;
  forget();
  return near;
}

void MeshWindow::forget() {
  for (const std::uint32_t vertex : known_) {
    distance_[vertex] = unknown;
    settled_[vertex] = 0;
  }
  known_.clear();
  window_.clear();
  heap_.clear();
}

double MeshWindow::explore(double limit, bool fixed_end) {
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
    const auto [distance, vertex] = heap_.back();
    heap_.pop_back();
    if (settled_[vertex] != 0) continue;
    if (distance > limit) break;
    if (fixed_end && neighbours_.fixed(vertex)) {
      limit = distance;
      break;
    }
    settled_[vertex] = 1;
    window_.push_back(vertex);
    pass_on(vertex);
  }
  return limit;
}

/// Passes a vertex's final distance on to its neighbours: along edges, and straight across the
/// triangles of which a second corner is final too.
void MeshWindow::pass_on(std::uint32_t vertex) {
  const double distance = distance_[vertex];
  for (const MeshNeighbours::Corner& corner : neighbours_.corners(vertex)) {
    const bool next = settled_[corner.next] != 0;
    const bool last = settled_[corner.last] != 0;
    if (!next) offer(corner.next, distance + corner.to_next);
    if (!last) offer(corner.last, distance + corner.to_last);
    if (next && !last) {
      pass_across(distance, distance_[corner.next], corner, corner.to_last, corner.to_next,
                  corner.last);
    } else if (last && !next) {
      pass_across(distance, distance_[corner.last], corner, corner.to_next, corner.to_last,
                  corner.next);
    }
  }
}

/// Distance of a triangle's third corner from a start that is unrolled into the triangle's plane.
/// It applies where the straight line there crosses the side between the two corners with known
/// distances.
void MeshWindow::pass_across(double near, double far, const MeshNeighbours::Corner& corner,
                             double arm, double side, std::uint32_t to) {
  if (!(side > 0)) return;
  const double x = (arm * arm + side * side - corner.across * corner.across) / (2 * side);
  const double y = corner.twice_area / side;
  const double start_x = (near * near - far * far + side * side) / (2 * side);
  const double start_y = std::sqrt(std::max(0.0, near * near - start_x * start_x));
  const double height = start_y + y;
  if (!(height > 0)) return;
  const double crossing = start_x + (x - start_x) * start_y / height;
  if (crossing < 0 || crossing > side) return;
  offer(to, std::sqrt((x - start_x) * (x - start_x) + height * height));
}

void MeshWindow::offer(std::uint32_t vertex, double distance) {
  if (distance >= distance_[vertex]) return;
  if (distance_[vertex] == unknown) known_.push_back(vertex);
  distance_[vertex] = distance;
  heap_.emplace_back(distance, vertex);
  std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
}

}  // namespace spm::baker
