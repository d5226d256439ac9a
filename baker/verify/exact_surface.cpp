// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/exact_surface.hpp"

#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <array>
#include <cgal/trees.hpp>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <vector>

#include "baker/verify/exact_pieces.hpp"
#include "baker/verify/exact_winding.hpp"

namespace spm::baker {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Triangles = std::vector<Kernel::Triangle_3>;
using TriangleBvh = CgalTree<Kernel, TrianglePrimitive<Kernel, Triangles::const_iterator>>;

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
  double distance;  ///< m, of that
  double felt;      ///< m, the same less the half-thickness of a sheet
};

/// True where no triangle that touches the candidate's closest point comes nearer. Then the
/// candidate is a feature of its own and not the flank of another. `candidates` are sorted by
/// distance.
bool is_local_minimum(const std::vector<Candidate>& candidates, const Candidate& candidate,
                      double touching) {
  for (const Candidate& other : candidates) {
    if (other.felt >= candidate.felt - touching) return true;
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
  /// The triangles of solids or of sheets.
  struct Kind {
    Triangles triangles;
    TriangleBvh tree;

    void add(const std::vector<std::array<Vector3, 3>>& pieces) {
      triangles.reserve(pieces.size());
      for (const auto& t : pieces) {
        const Kernel::Triangle_3 triangle(to_cgal(t[0]), to_cgal(t[1]), to_cgal(t[2]));
        // A triangle that rounding left without an area has no normal and gets no samples.
        if (area_vector(triangle).norm() > 0) triangles.push_back(triangle);
      }
      tree.insert(triangles.cbegin(), triangles.cend());
      tree.build();
      tree.accelerate_distance_queries();
    }
  };

  Implementation(const Mesh& mesh, double sheet_thickness, double tolerance)
      : winding(mesh), thickness(sheet_thickness), narrow(narrow_share * tolerance) {
    const SurfacePieces pieces = outer_pieces(mesh, winding, narrow);
    gaps_closed = pieces.gaps_closed;
    hidden_area = pieces.hidden_area;
    touching = 1e-7 * mesh.diagonal;
    solids.add(pieces.solids);
    sheets.add(pieces.sheets);
    for (const Kind* kind : {&solids, &sheets}) {
      for (const Kernel::Triangle_3& triangle : kind->triangles) {
        cumulative.push_back(area += area_vector(triangle).norm() / 2);
      }
    }
  }

  [[nodiscard]] const Kernel::Triangle_3& triangle(std::size_t number) const {
    return number < solids.triangles.size() ? solids.triangles[number]
                                            : sheets.triangles[number - solids.triangles.size()];
  }

  /// The closest point of one kind, which must be there.
  [[nodiscard]] SurfacePoint closest_of(const Kind& kind, const Vector3& point,
                                        const SurfacePoint* from) const {
    const bool sheet = &kind == &sheets;
    const std::size_t first = sheet ? solids.triangles.size() : 0;
    TriangleBvh::Point_and_primitive_id found;
    if (from != nullptr && from->sheet == sheet) {
      const auto hint =
          kind.triangles.begin() + static_cast<std::ptrdiff_t>(from->triangle - first);
      found =
          kind.tree.closest_point_and_primitive(to_cgal(point), {to_cgal(from->position), hint});
    } else {
      found = kind.tree.closest_point_and_primitive(to_cgal(point));
    }
    return {from_cgal(found.first), area_vector(*found.second).normalized(),
            first + static_cast<std::size_t>(found.second - kind.triangles.begin()), sheet};
  }

  /// Also within a gap that is closed: then a solid is as near as the gap is narrow.
  [[nodiscard]] bool inside(const Vector3& point, double away) const {
    if (winding.at(point) > 0) return true;
    const double reach = 2 * narrow;
    if (!gaps_closed || away <= reach) return false;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double way : {-reach, reach}) {
        Vector3 beside = point;
        beside[axis] += way;
        if (winding.at(beside) > 0) return true;
      }
    }
    return false;
  }

  [[nodiscard]] SurfacePoint closest(const Vector3& point, const SurfacePoint* from) const {
    if (sheets.triangles.empty()) return closest_of(solids, point, from);
    SurfacePoint sheet = closest_of(sheets, point, from);
    if (solids.triangles.empty()) return sheet;
    SurfacePoint solid = closest_of(solids, point, from);
    const double beside = (sheet.position - point).norm() - thickness,
                 away = (solid.position - point).norm();
    if (beside >= away) return solid;
    return beside < -away || !inside(point, away) ? sheet : solid;
  }

  /// The triangles of which a distance of so much is felt, nearest first.
  [[nodiscard]] std::vector<Candidate> within(const Vector3& point, double radius) const {
    std::vector<Candidate> candidates;
    for (const Kind* kind : {&solids, &sheets}) {
      if (kind->triangles.empty()) continue;
      const double nearer = kind == &sheets ? thickness : 0;
      std::vector<Triangles::const_iterator> near;
      kind->tree.all_intersected_primitives(
          Kernel::Sphere_3(to_cgal(point), (radius + nearer) * (radius + nearer)),
          std::back_inserter(near));
      for (const auto& triangle : near) {
        const Vector3 position = closest_on(*triangle, point);
        const double distance = (position - point).norm();
        candidates.push_back({&*triangle, position, distance, distance - nearer});
      }
    }
    std::sort(candidates.begin(), candidates.end(),
              [](const Candidate& a, const Candidate& b) { return a.felt < b.felt; });
    return candidates;
  }

  /// Those that compete with the closest point.
  [[nodiscard]] std::vector<Candidate> rivals_of(const Vector3& point, const SurfacePoint& closest,
                                                 double window) const {
    const double away = (closest.position - point).norm();
    return within(point, std::max(0.0, away - (closest.sheet ? thickness : 0)) + window);
  }

  ExactWinding winding;
  double thickness = 0;
  double narrow = 0;         ///< m: gaps within this are closed
  bool gaps_closed = false;  ///< there are such
  Kind solids, sheets;
  std::vector<double> cumulative;  ///< area up to and including each triangle
  double area = 0;
  double hidden_area = 0;
  double touching = 0;
};

ExactSurface::ExactSurface(const Mesh& mesh, double sheet_thickness, double tolerance)
    : implementation_(std::make_unique<Implementation>(mesh, sheet_thickness, tolerance)) {}

ExactSurface::~ExactSurface() = default;

bool ExactSurface::empty() const noexcept { return implementation_->cumulative.empty(); }

double ExactSurface::area() const noexcept { return implementation_->area; }

double ExactSurface::hidden_area() const noexcept { return implementation_->hidden_area; }

bool ExactSurface::has_gaps() const noexcept { return implementation_->gaps_closed; }

bool ExactSurface::inside(const Vector3& point) const {
  if (implementation_->solids.triangles.empty()) return false;
  // Only of closed gaps the distance matters.
  if (!implementation_->gaps_closed) return implementation_->inside(point, 0);
  const SurfacePoint solid = implementation_->closest_of(implementation_->solids, point, nullptr);
  return implementation_->inside(point, (solid.position - point).norm());
}

SurfacePoint ExactSurface::closest(const Vector3& point) const {
  return implementation_->closest(point, nullptr);
}

SurfacePoint ExactSurface::closest(const Vector3& point, const SurfacePoint& from) const {
  return implementation_->closest(point, &from);
}

double ExactSurface::size_of_distance(const Vector3& point, const SurfacePoint& closest) const {
  const double away = (point - closest.position).norm();
  return closest.sheet ? std::abs(away - implementation_->thickness) : away;
}

double ExactSurface::distance(const Vector3& point, const SurfacePoint& closest) const {
  const double away = (point - closest.position).norm();
  if (closest.sheet) return away - implementation_->thickness;
  return implementation_->inside(point, away) ? -away : away;
}

SurfacePoint ExactSurface::at(double choice, double a, double b) const {
  const std::vector<double>& cumulative = implementation_->cumulative;
  const auto found =
      std::upper_bound(cumulative.begin(), cumulative.end(), choice * cumulative.back());
  const auto index = static_cast<std::size_t>(std::min<std::ptrdiff_t>(
      found - cumulative.begin(), static_cast<std::ptrdiff_t>(cumulative.size()) - 1));
  const Kernel::Triangle_3& triangle = implementation_->triangle(index);
  // Uniform in a triangle: Turk, Graphics Gems I, 1990.
  const double root = std::sqrt(a);
  const Vector3 position = (1 - root) * corner(triangle, 0) + root * (1 - b) * corner(triangle, 1) +
                           root * b * corner(triangle, 2);
  return {position, area_vector(triangle).normalized(), index,
          index >= implementation_->solids.triangles.size()};
}

bool ExactSurface::contested(const Vector3& point, const SurfacePoint& closest,
                             double window) const {
  const Vector3 toward = closest.position - point;
  if (toward == Vector3::Zero()) return false;
  const std::vector<Candidate> candidates = implementation_->rivals_of(point, closest, window);
  return std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& candidate) {
    return differs(candidate, point, toward) &&
           is_local_minimum(candidates, candidate, implementation_->touching);
  });
}

Rivals ExactSurface::rivals(const Vector3& point, const SurfacePoint& closest, double window,
                            const Vector3& direction) const {
  const Vector3 toward = closest.position - point;
  Rivals rivals{false, angle_between(direction, toward)};
  if (toward == Vector3::Zero()) return rivals;
  const std::vector<Candidate> candidates = implementation_->rivals_of(point, closest, window);
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

}  // namespace spm::baker
