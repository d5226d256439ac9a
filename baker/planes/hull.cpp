// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/planes/hull.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>

#include "baker/base/bake_error.hpp"

namespace spm::baker {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using HullMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Relative to the diagonal.
constexpr double kFlat = 1e-9;   ///< below it a solid is flat, and a triangle has no normal
constexpr double kThin = 1e-6;   ///< triangles this thin tilt by the rounding of floats
constexpr double kNoise = 3e-7;  ///< that rounding, as files of floats bring it

struct HullTriangle {
  std::array<Vector3, 3> corners;
  std::array<int, 3> neighbours;
  Vector3 normal;  ///< unit
  double area;
  bool thin;    ///< tilted by rounding: judged by distance instead of by its normal
  bool sliver;  ///< too thin for its normal to mean anything
};

[[nodiscard]] Vector3 vector(const Kernel::Point_3& point) {
  return {point.x(), point.y(), point.z()};
}

[[nodiscard]] bool lexicographic(const Vector3& a, const Vector3& b) {
  return std::tuple(a.x(), a.y(), a.z()) < std::tuple(b.x(), b.y(), b.z());
}

/// Rotates a triangle's corners so that it begins with the least one. CGAL's choice depends on
/// addresses in memory, and rounding would depend on that choice.
void begin_with_least(HullTriangle& triangle) {
  const auto least =
      std::min_element(triangle.corners.begin(), triangle.corners.end(), lexicographic);
  const auto steps = least - triangle.corners.begin();
  std::rotate(triangle.corners.begin(), least, triangle.corners.end());
  std::rotate(triangle.neighbours.begin(), triangle.neighbours.begin() + steps,
              triangle.neighbours.end());
}

[[nodiscard]] bool before(const HullTriangle& a, const HullTriangle& b) {
  return std::lexicographical_compare(a.corners.begin(), a.corners.end(), b.corners.begin(),
                                      b.corners.end(), lexicographic);
}

[[nodiscard]] std::vector<HullTriangle> triangles_of(const HullMesh& mesh, double diagonal) {
  std::vector<HullTriangle> triangles;
  triangles.reserve(mesh.number_of_faces());
  for (const auto face : mesh.faces()) {
    HullTriangle triangle{};
    std::size_t corner = 0;
    double longest = 0;
    for (const auto halfedge : mesh.halfedges_around_face(mesh.halfedge(face))) {
      triangle.corners[corner] = vector(mesh.point(mesh.source(halfedge)));
      const auto other = mesh.face(mesh.opposite(halfedge));
      triangle.neighbours[corner] = other.is_valid() ? static_cast<int>(std::size_t(other)) : -1;
      longest = std::max(
          longest, (vector(mesh.point(mesh.target(halfedge))) - triangle.corners[corner]).norm());
      ++corner;
    }
    begin_with_least(triangle);
    const Vector3 twice = (triangle.corners[1] - triangle.corners[0])
                              .cross(triangle.corners[2] - triangle.corners[0]);
    triangle.area = twice.norm() / 2;
    triangle.thin = !(2 * triangle.area > kThin * diagonal * longest);
    triangle.sliver = !(2 * triangle.area > kFlat * diagonal * longest);
    triangle.normal = triangle.area > 0 ? Vector3(twice / twice.norm()) : Vector3(Vector3::Zero());
    triangles.push_back(triangle);
  }
  return triangles;
}

/// The largest triangle first, so that each facet grows from its best-known normal.
[[nodiscard]] std::vector<std::size_t> growing_order(const std::vector<HullTriangle>& triangles) {
  std::vector<std::size_t> order(triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (triangles[a].area != triangles[b].area) return triangles[a].area > triangles[b].area;
    return before(triangles[a], triangles[b]);
  });
  return order;
}

class Grower {
 public:
  Grower(const std::vector<HullTriangle>& triangles, double coplanar_angle, double diagonal)
      : triangles_(triangles),
        cosine_(std::cos(coplanar_angle)),
        noise_(kNoise * diagonal),
        taken_(triangles.size()) {}

  [[nodiscard]] bool taken(std::size_t triangle) const { return taken_[triangle]; }

  /// Triangles that are connected to `seed` and lie in its plane.
  [[nodiscard]] std::vector<std::size_t> grow(std::size_t seed) {
    std::vector<std::size_t> group{seed};
    taken_[seed] = true;
    for (std::size_t next = 0; next < group.size(); ++next) {
      for (const int neighbour : triangles_[group[next]].neighbours) {
        if (neighbour < 0 || taken_[static_cast<std::size_t>(neighbour)]) continue;
        const HullTriangle& to = triangles_[static_cast<std::size_t>(neighbour)];
        if (!joins(triangles_[seed], triangles_[group[next]], to)) continue;
        taken_[static_cast<std::size_t>(neighbour)] = true;
        group.push_back(static_cast<std::size_t>(neighbour));
      }
    }
    return group;
  }

 private:
  [[nodiscard]] bool joins(const HullTriangle& seed, const HullTriangle& from,
                           const HullTriangle& to) const {
    if (to.sliver) return true;
    if (to.normal.dot(seed.normal) >= cosine_ &&
        (from.thin || to.normal.dot(from.normal) >= cosine_)) {
      return true;
    }
    return to.thin && std::all_of(to.corners.begin(), to.corners.end(), [&](const Vector3& corner) {
             return std::abs(seed.normal.dot(corner - seed.corners[0])) <= noise_;
           });
  }

  const std::vector<HullTriangle>& triangles_;
  double cosine_;  ///< of the largest angle between normals that are merged
  double noise_;
  std::vector<bool> taken_;
};

/// The corners of a facet in order around `normal`, the least one first. So the result does not
/// depend on the diagonals that CGAL drew through a flat facet.
[[nodiscard]] std::vector<Vector3> outline(const std::vector<HullTriangle>& triangles,
                                           const std::vector<std::size_t>& group,
                                           const Vector3& normal) {
  std::vector<Vector3> corners;
  for (const std::size_t member : group) {
    if (triangles[member].sliver) continue;
    corners.insert(corners.end(), triangles[member].corners.begin(),
                   triangles[member].corners.end());
  }
  std::sort(corners.begin(), corners.end(), lexicographic);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  Vector3 middle = Vector3::Zero();
  for (const Vector3& corner : corners) middle += corner / static_cast<double>(corners.size());
  const Vector3 first = (corners[0] - middle).normalized();
  const Vector3 across = normal.cross(first);
  std::sort(corners.begin() + 1, corners.end(), [&](const Vector3& a, const Vector3& b) {
    const auto angle = [&](const Vector3& corner) {
      const double turn = std::atan2(across.dot(corner - middle), first.dot(corner - middle));
      return turn < 0 ? turn + 2 * std::numbers::pi : turn;
    };
    return angle(a) < angle(b);
  });
  return corners;
}

[[nodiscard]] HullFacet facet_of(const std::vector<HullTriangle>& triangles,
                                 const std::vector<std::size_t>& group,
                                 const std::vector<Vector3>& vertices) {
  const std::vector<Vector3> corners = outline(triangles, group, triangles[group[0]].normal);
  HullFacet facet;
  Vector3 twice = Vector3::Zero();
  Vector3 centroid = Vector3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vector3 part = (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
    twice += part;
    centroid += part.norm() / 3 * (corners[0] + corners[i] + corners[i + 1]);
    facet.area += part.norm() / 2;
  }
  facet.normal = twice.normalized();
  facet.point = centroid / (2 * facet.area);
  double farthest = -std::numeric_limits<double>::infinity();
  for (const Vector3& vertex : vertices) {
    farthest = std::max(farthest, facet.normal.dot(vertex - facet.point));
  }
  facet.point += farthest * facet.normal;
  return facet;
}

[[nodiscard]] HullMesh hull_mesh(std::span<const Vector3> points) {
  std::vector<Kernel::Point_3> input;
  input.reserve(points.size());
  for (const Vector3& point : points) input.emplace_back(point.x(), point.y(), point.z());
  HullMesh mesh;
  if (input.size() >= 4) CGAL::convex_hull_3(input.begin(), input.end(), mesh);
  return mesh;
}

/// Twice the volume over the area: the thickness of a flat hull, m.
[[nodiscard]] double thickness(const std::vector<HullTriangle>& triangles, const Vector3& inside) {
  double volume = 0;
  double area = 0;
  for (const HullTriangle& triangle : triangles) {
    volume += triangle.area * triangle.normal.dot(triangle.corners[0] - inside) / 3;
    area += triangle.area;
  }
  return area > 0 ? 2 * volume / area : 0;
}

/// The hull as CGAL has it.
struct Solid {
  std::vector<Vector3> vertices;
  std::vector<HullTriangle> triangles;
  double diagonal = 0;  ///< m
};

[[nodiscard]] Solid solid_of(std::span<const Vector3> points) {
  const HullMesh mesh = hull_mesh(points);
  Solid solid;
  for (const auto vertex : mesh.vertices()) solid.vertices.push_back(vector(mesh.point(vertex)));
  Eigen::AlignedBox3d box;
  for (const Vector3& vertex : solid.vertices) box.extend(vertex);
  solid.diagonal = solid.vertices.empty() ? 0 : box.diagonal().norm();
  solid.triangles = triangles_of(mesh, solid.diagonal);
  if (solid.triangles.size() < 4 ||
      !(thickness(solid.triangles, box.center()) > kFlat * solid.diagonal)) {
    throw BakeError(ExitCode::invalid_input,
                    "all points of the mesh lie in one plane, so that no support planes can "
                    "surround it; give it thickness");
  }
  return solid;
}

}  // namespace

Hull convex_hull_vertices(std::span<const Vector3> points) {
  Hull hull;
  hull.vertices = solid_of(points).vertices;
  std::sort(hull.vertices.begin(), hull.vertices.end(), lexicographic);
  return hull;
}

Hull convex_hull(std::span<const Vector3> points, double coplanar_angle) {
  const Solid solid = solid_of(points);
  const auto& [vertices, triangles, diagonal] = solid;
  Hull hull;
  hull.vertices = vertices;
  Grower grower(triangles, coplanar_angle, diagonal);
  for (const std::size_t seed : growing_order(triangles)) {
    if (grower.taken(seed) || triangles[seed].sliver) continue;
    hull.facets.push_back(facet_of(triangles, grower.grow(seed), hull.vertices));
  }
  std::sort(hull.vertices.begin(), hull.vertices.end(), lexicographic);
  std::sort(hull.facets.begin(), hull.facets.end(), [](const HullFacet& a, const HullFacet& b) {
    if (a.area != b.area) return a.area > b.area;
    if (a.normal != b.normal) return lexicographic(a.normal, b.normal);
    return lexicographic(a.point, b.point);
  });
  return hull;
}

}  // namespace spm::baker
