// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/triangle_split.hpp"

// Cuts of one triangle seldom cross: the triangulation that CGAL recommends instead costs more.
#define CGAL_NO_CDT_2_WARNING
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "baker/mesh/triangle_height.hpp"

namespace spm::baker {
namespace {

using Exact = ExactKernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Exact>;
using Face = CGAL::Constrained_triangulation_face_base_2<Exact>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Exact, CGAL::Triangulation_data_structure_2<Vertex, Face>, CGAL::Exact_intersections_tag>;

/// The nearest double, however the number was computed: the exact value is evaluated first.
[[nodiscard]] double rounded(const Exact::FT& value) {
  (void)value.exact();
  return CGAL::to_double(value);
}

/// The plane of a triangle, seen along the axis that is closest to its normal. It keeps the
/// triangle's orientation.
class Projection {
 public:
  explicit Projection(const std::array<Exact::Point_3, 3>& corners) : origin_(corners[0]) {
    const Exact::Vector_3 normal =
        CGAL::cross_product(corners[1] - corners[0], corners[2] - corners[0]);
    drop_ = 0;
    for (int axis = 1; axis < 3; ++axis) {
      if (CGAL::abs(normal[axis]) > CGAL::abs(normal[drop_])) drop_ = axis;
    }
    first_ = (drop_ + 1) % 3;
    second_ = (drop_ + 2) % 3;
    if (normal[drop_] < 0) std::swap(first_, second_);
    slope_first_ = -normal[first_] / normal[drop_];
    slope_second_ = -normal[second_] / normal[drop_];
  }

  [[nodiscard]] Exact::Point_2 down(const Exact::Point_3& p) const {
    return {p[first_], p[second_]};
  }

  /// The point of the plane over q.
  [[nodiscard]] Exact::Point_3 up(const Exact::Point_2& q) const {
    std::array<Exact::FT, 3> p;
    p[static_cast<std::size_t>(first_)] = q.x();
    p[static_cast<std::size_t>(second_)] = q.y();
    p[static_cast<std::size_t>(drop_)] = height(q);
    return {p[0], p[1], p[2]};
  }

 private:
  [[nodiscard]] Exact::FT height(const Exact::Point_2& q) const {
    return origin_[drop_] + slope_first_ * (q.x() - origin_[first_]) +
           slope_second_ * (q.y() - origin_[second_]);
  }

  Exact::Point_3 origin_;
  int drop_ = 0, first_ = 0, second_ = 0;
  Exact::FT slope_first_, slope_second_;
};

/// The traces of other triangles on one, as they are seen along its projection.
struct Cuts {
  explicit Cuts(const std::array<Exact::Point_3, 3>& corners)
      : projection(corners), flat({down(corners[0]), down(corners[1]), down(corners[2])}) {}

  [[nodiscard]] Exact::Point_2 down(const Exact::Point_3& point) const {
    return projection.down(point);
  }

  Projection projection;
  std::array<Exact::Point_2, 3> flat;  ///< the corners
  std::vector<Exact::Point_2> points;
  std::vector<std::pair<Exact::Point_2, Exact::Point_2>> segments;
  std::set<std::pair<std::uint32_t, std::uint32_t>> sides;  ///< of others in its plane
};

class Splitter {
 public:
  Splitter(std::span<const Vector3> points, std::span<const Triangle> triangles)
      : points_(points), triangles_(triangles) {
    mesh_.points.assign(points.begin(), points.end());
  }

  /// Cuts the triangles of a pair along what they share, or the second alone. Those of one plane
  /// are cut along each other's sides, of which neighbours have one in common.
  void intersect(const TrianglePair& pair, bool second_alone) {
    const auto [first, second] = pair;
    if (in_one_plane(first, second)) {
      if (!second_alone) cut_along_sides(first, second);
      cut_along_sides(second, first);
      return;
    }
    // An Object, since CGAL 5 and 6 return variants of different libraries.
    const CGAL::Object common = CGAL::intersection(triangle(first), triangle(second));
    for (const std::uint32_t side : {first, second}) {
      if (second_alone && side == first) continue;
      if (const auto* point = CGAL::object_cast<Exact::Point_3>(&common)) {
        Cuts& own = cuts_of(side);
        own.points.push_back(own.down(*point));
      } else if (const auto* segment = CGAL::object_cast<Exact::Segment_3>(&common)) {
        Cuts& own = cuts_of(side);
        own.segments.emplace_back(own.down(segment->source()), own.down(segment->target()));
      }
    }
  }

  /// Cuts a triangle along a segment, as seen along the axis that is closest to its normal, and
  /// where `touching` also at the one point that they share. A triangle that rounding left on a
  /// line is not cut.
  void cut(std::uint32_t index, const std::array<Vector3, 2>& segment, bool touching) {
    if (!cuts_.contains(index)) {
      const std::array<Exact::Point_3, 3> own = corners(index);
      if (CGAL::collinear(own[0], own[1], own[2])) return;
    }
    Cuts& own = cuts_of(index);
    const Exact::Segment_2 seen(own.down(exact_point(segment[0])),
                                own.down(exact_point(segment[1])));
    if (seen.is_degenerate()) return;
    const CGAL::Object common =
        CGAL::intersection(Exact::Triangle_2(own.flat[0], own.flat[1], own.flat[2]), seen);
    if (const auto* part = CGAL::object_cast<Exact::Segment_2>(&common)) {
      own.segments.emplace_back(part->source(), part->target());
    } else if (const auto* point = CGAL::object_cast<Exact::Point_2>(&common); touching && point) {
      own.points.push_back(*point);
    }
  }

  [[nodiscard]] SplitMesh finish() {
    // Only where something is cut are places looked up.
    for (std::uint32_t i = 0; i < points_.size() && !cuts_.empty(); ++i) {
      numbers_[key(points_[i])].push_back(i);
    }
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      const auto cuts = cuts_.find(i);
      if (cuts == cuts_.end()) {
        add_piece(triangles_[i], i);
      } else {
        split(i, cuts->second);
      }
    }
    return std::move(mesh_);
  }

 private:
  using Key = std::array<double, 3>;
  [[nodiscard]] static Key key(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

  [[nodiscard]] std::array<Exact::Point_3, 3> corners(std::uint32_t index) const {
    const auto& [a, b, c] = triangles_[index];
    return {exact_point(points_[a]), exact_point(points_[b]), exact_point(points_[c])};
  }
  [[nodiscard]] Exact::Triangle_3 triangle(std::uint32_t index) const {
    const auto [a, b, c] = corners(index);
    return {a, b, c};
  }

  [[nodiscard]] bool in_one_plane(std::uint32_t first, std::uint32_t second) const {
    const auto [a, b, c] = corners(first);
    const std::array<Exact::Point_3, 3> other = corners(second);
    return std::all_of(other.begin(), other.end(), [&, &a = a, &b = b, &c = c](const auto& corner) {
      return CGAL::coplanar(a, b, c, corner);
    });
  }

  Cuts& cuts_of(std::uint32_t index) {
    const auto found = cuts_.find(index);
    return found != cuts_.end() ? found->second
                                : cuts_.emplace(index, Cuts(corners(index))).first->second;
  }

  void cut_along_sides(std::uint32_t index, std::uint32_t other) {
    const Triangle& there = triangles_[other];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto side = std::minmax(there[k], there[(k + 1) % 3]);
      if (!cuts_of(index).sides.insert(side).second) continue;
      cut(index, {points_[side.first], points_[side.second]}, true);
    }
  }

  void split(std::uint32_t index, const Cuts& cuts) {
    Triangulation triangulation;
    std::array<Triangulation::Vertex_handle, 3> ends;
    for (std::size_t k = 0; k < 3; ++k) ends[k] = triangulation.insert(cuts.flat[k]);
    for (const Exact::Point_2& point : cuts.points) triangulation.insert(point);
    for (const auto& [from, to] : cuts.segments) triangulation.insert_constraint(from, to);
    for (const auto vertex : triangulation.finite_vertex_handles()) {
      vertex->info() = number(cuts.projection.up(vertex->point()));
    }
    // The corners keep their numbers, even where another vertex lies in the same place.
    for (std::size_t k = 0; k < 3; ++k) ends[k]->info() = triangles_[index][k];
    if (triangulation.number_of_faces() > 1) mesh_.split.add(1, triangles_[index][0]);
    for (const auto face : triangulation.finite_face_handles()) {
      add_piece({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()}, index);
    }
  }

  /// The number of a point: one place, before rounding, has one.
  [[nodiscard]] std::uint32_t number(const Exact::Point_3& point) {
    const Vector3 near(rounded(point.x()), rounded(point.y()), rounded(point.z()));
    std::vector<std::uint32_t>& there = numbers_[key(near)];
    for (const std::uint32_t one : there) {
      if (mesh_.exact_place(one) == point) return one;
    }
    there.push_back(static_cast<std::uint32_t>(mesh_.points.size()));
    mesh_.points.push_back(near);
    mesh_.added.push_back(point);
    return there.back();
  }

  void add_piece(const Triangle& piece, std::uint32_t parent) {
    mesh_.pieces.push_back(piece);
    mesh_.parents.push_back(parent);
  }

  std::span<const Vector3> points_;
  std::span<const Triangle> triangles_;
  SplitMesh mesh_;
  std::map<std::uint32_t, Cuts> cuts_;
  std::map<Key, std::vector<std::uint32_t>> numbers_;
};

}  // namespace

ExactKernel::Point_3 SplitMesh::exact_place(std::uint32_t point) const {
  const std::size_t own = points.size() - added.size();
  return point < own ? exact_point(points[point]) : added[point - own];
}

SplitMesh split_triangles(std::span<const Vector3> points, std::span<const Triangle> triangles,
                          std::span<const TrianglePair> crossing, std::size_t solids) {
  Splitter splitter(points, triangles);
  for (const TrianglePair& pair : crossing) splitter.intersect(pair, pair.second >= solids);
  return splitter.finish();
}

SplitMesh cut_as_seen(std::span<const Vector3> points, std::span<const Triangle> triangles,
                      std::span<const SeenCut> cuts) {
  Splitter splitter(points, triangles);
  for (const auto& [triangle, segment] : cuts) splitter.cut(triangle, segment, false);
  SplitMesh split = splitter.finish();
  std::size_t kept = 0;
  for (std::size_t piece = 0; piece < split.pieces.size(); ++piece) {
    const auto& [a, b, c] = split.pieces[piece];
    if (!(triangle_height(split.points[a], split.points[b], split.points[c]) > 0)) continue;
    split.pieces[kept] = split.pieces[piece];
    split.parents[kept++] = split.parents[piece];
  }
  split.pieces.resize(kept);
  split.parents.resize(kept);
  return split;
}

}  // namespace spm::baker
