// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/exact_surface.hpp"

#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cgal/trees.hpp>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>
#include <vector>

#include "baker/verify/exact_pieces.hpp"
#include "baker/verify/exact_winding.hpp"

namespace spm::baker {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Triangles = std::vector<Kernel::Triangle_3>;
using Segments = std::vector<Kernel::Segment_3>;
using TriangleBvh = CgalTree<Kernel, TrianglePrimitive<Kernel, Triangles::const_iterator>>;
using SegmentTree = CgalTree<Kernel, SegmentPrimitive<Kernel, Segments::const_iterator>>;

Point to_cgal(const Vector3& p) { return {p.x(), p.y(), p.z()}; }
Vector3 from_cgal(const Point& p) { return {p.x(), p.y(), p.z()}; }

Vector3 corner(const Kernel::Triangle_3& triangle, int index) { return from_cgal(triangle[index]); }

/// Twice the triangle's area, along its normal.
Vector3 area_vector(const Kernel::Triangle_3& t) {
  return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
}

Vector3 closest_on(const Kernel::Triangle_3& triangle, const Vector3& point) {
  return from_cgal(Kernel().construct_projected_point_3_object()(triangle, to_cgal(point)));
}

bool in_box(const Kernel::Triangle_3& triangle, const Vector3& point, double slack) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
    if (point[axis] < low - slack || point[axis] > high + slack) return false;
  }
  return true;
}

/// A triangle near a point, and its own closest point.
struct Candidate {
  const Kernel::Triangle_3* triangle;
  Vector3 closest;
  double distance;
};

/// True where no triangle that touches the candidate's closest point comes nearer. Then the
/// candidate is a feature of its own and not the flank of another. `candidates` are sorted by
/// distance.
bool is_local_minimum(const std::vector<Candidate>& candidates, const Candidate& candidate,
                      double touching) {
  for (const Candidate& other : candidates) {
    if (other.distance >= candidate.distance - touching) return true;
    if (!in_box(*other.triangle, candidate.closest, touching)) continue;
    const double gap = (closest_on(*other.triangle, candidate.closest) - candidate.closest).norm();
    if (gap <= touching) return false;
  }
  return true;
}

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// True where a candidate lies in another direction from the point than the closest point does.
bool differs(const Candidate& candidate, const Vector3& point, const Vector3& toward) {
  static const double aligned = std::cos(5 * std::numbers::pi / 180);
  const double cosine = (candidate.closest - point).dot(toward);
  return cosine < aligned * candidate.distance * toward.norm();
}

}  // namespace

struct ExactSurface::Implementation {
  explicit Implementation(const Mesh& mesh) : winding(mesh) {
    const SurfacePieces pieces = outer_pieces(mesh, winding);
    area = pieces.area;
    hidden_area = pieces.hidden_area;
    touching = 1e-7 * mesh.diagonal;
    triangles.reserve(pieces.triangles.size());
    cumulative.reserve(pieces.triangles.size());
    double sum = 0;
    for (const auto& t : pieces.triangles) {
      const Kernel::Triangle_3 triangle(to_cgal(t[0]), to_cgal(t[1]), to_cgal(t[2]));
      // A triangle that rounding left without an area has no normal and gets no samples.
      const double doubled = area_vector(triangle).norm();
      if (!(doubled > 0)) continue;
      triangles.push_back(triangle);
      cumulative.push_back(sum += doubled / 2);
    }
    for (const auto& edge : mesh.border) {
      segments.emplace_back(to_cgal(mesh.vertices[edge[0]]), to_cgal(mesh.vertices[edge[1]]));
    }
    tree.insert(triangles.cbegin(), triangles.cend());
    tree.build();
    tree.accelerate_distance_queries();
    border.insert(segments.cbegin(), segments.cend());
    border.build();
    border.accelerate_distance_queries();
  }

  [[nodiscard]] SurfacePoint surface_point(const TriangleBvh::Point_and_primitive_id& found) const {
    return {from_cgal(found.first), area_vector(*found.second).normalized(),
            static_cast<std::size_t>(found.second - triangles.begin())};
  }

  /// The triangles that come within a distance of a point, nearest first.
  [[nodiscard]] std::vector<Candidate> within(const Vector3& point, double radius) const {
    std::vector<Triangles::const_iterator> near;
    tree.all_intersected_primitives(Kernel::Sphere_3(to_cgal(point), radius * radius),
                                    std::back_inserter(near));
    std::vector<Candidate> candidates;
    candidates.reserve(near.size());
    for (const auto& triangle : near) {
      const Vector3 position = closest_on(*triangle, point);
      candidates.push_back({&*triangle, position, (position - point).norm()});
    }
    std::sort(candidates.begin(), candidates.end(),
              [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
    return candidates;
  }

  ExactWinding winding;
  Triangles triangles;
  Segments segments;
  std::vector<double> cumulative;  ///< area up to and including each triangle
  TriangleBvh tree;
  SegmentTree border;
  double area = 0;
  double hidden_area = 0;
  double touching = 0;
};

ExactSurface::ExactSurface(const Mesh& mesh)
    : implementation_(std::make_unique<Implementation>(mesh)) {}

ExactSurface::~ExactSurface() = default;

bool ExactSurface::empty() const noexcept { return implementation_->triangles.empty(); }

double ExactSurface::area() const noexcept { return implementation_->area; }

double ExactSurface::hidden_area() const noexcept { return implementation_->hidden_area; }

bool ExactSurface::inside(const Vector3& point) const noexcept {
  return implementation_->winding.at(point) > 0.5;
}

SurfacePoint ExactSurface::closest(const Vector3& point) const {
  return implementation_->surface_point(
      implementation_->tree.closest_point_and_primitive(to_cgal(point)));
}

SurfacePoint ExactSurface::closest(const Vector3& point, const SurfacePoint& from) const {
  const auto triangle =
      implementation_->triangles.begin() + static_cast<std::ptrdiff_t>(from.triangle);
  return implementation_->surface_point(implementation_->tree.closest_point_and_primitive(
      to_cgal(point), {to_cgal(from.position), triangle}));
}

SurfacePoint ExactSurface::at(double choice, double a, double b) const {
  const std::vector<double>& cumulative = implementation_->cumulative;
  const auto found =
      std::upper_bound(cumulative.begin(), cumulative.end(), choice * cumulative.back());
  const auto index = std::min<std::ptrdiff_t>(found - cumulative.begin(),
                                              static_cast<std::ptrdiff_t>(cumulative.size()) - 1);
  const Kernel::Triangle_3& triangle = implementation_->triangles[static_cast<std::size_t>(index)];
  // Uniform in a triangle: Turk, Graphics Gems I, 1990.
  const double root = std::sqrt(a);
  const Vector3 position = (1 - root) * corner(triangle, 0) + root * (1 - b) * corner(triangle, 1) +
                           root * b * corner(triangle, 2);
  return {position, area_vector(triangle).normalized(), static_cast<std::size_t>(index)};
}

bool ExactSurface::contested(const Vector3& point, const Vector3& closest, double window) const {
  const Vector3 toward = closest - point;
  const double distance = toward.norm();
  if (distance == 0) return false;
  const std::vector<Candidate> candidates = implementation_->within(point, distance + window);
  return std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& candidate) {
    return differs(candidate, point, toward) &&
           is_local_minimum(candidates, candidate, implementation_->touching);
  });
}

Rivals ExactSurface::rivals(const Vector3& point, const Vector3& closest, double window,
                            const Vector3& direction) const {
  const Vector3 toward = closest - point;
  Rivals rivals{false, angle_between(direction, toward)};
  const double distance = toward.norm();
  if (distance == 0) return rivals;
  const std::vector<Candidate> candidates = implementation_->within(point, distance + window);
  for (const Candidate& candidate : candidates) {
    const double angle = angle_between(direction, candidate.closest - point);
    const bool contests = !rivals.contested && differs(candidate, point, toward);
    // Whether it is a feature of its own takes longest to find out.
    if (!contests && angle >= rivals.angle) continue;
    if (!is_local_minimum(candidates, candidate, implementation_->touching)) continue;
    rivals.contested = rivals.contested || contests;
    rivals.angle = std::min(rivals.angle, angle);
  }
  return rivals;
}

bool ExactSurface::closed() const noexcept { return implementation_->segments.empty(); }

double ExactSurface::border_distance(const Vector3& point) const {
  if (implementation_->segments.empty()) return std::numeric_limits<double>::infinity();
  return std::sqrt(implementation_->border.squared_distance(to_cgal(point)));
}

}  // namespace spm::baker
