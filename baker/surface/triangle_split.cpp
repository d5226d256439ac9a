// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/triangle_split.hpp"

// Cuts of one triangle seldom cross: the triangulation that CGAL recommends instead costs more.
#define CGAL_NO_CDT_2_WARNING
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <utility>

#include "baker/base/cube_bins.hpp"
#include "baker/mesh/triangle_height.hpp"
#include "baker/surface/stacked_triangles.hpp"
#include "baker/surface/triangle_cuts.hpp"

namespace spm::baker {
namespace {

using Exact = ExactKernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Exact>;
using Face = CGAL::Constrained_triangulation_face_base_2<
    Exact, CGAL::Triangulation_face_base_with_info_2<int, Exact>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Exact, CGAL::Triangulation_data_structure_2<Vertex, Face>, CGAL::Exact_intersections_tag>;

/// The nearest double, however the number was computed: the exact value is evaluated first.
[[nodiscard]] double rounded(const Exact::FT& value) {
  (void)value.exact();
  return CGAL::to_double(value);
}

/// Makes the pieces of triangles that are cut.
class Splitter {
 public:
  Splitter(std::span<const Vector3> points, std::span<const Triangle> triangles, TriangleCuts& cuts)
      : points_(points), triangles_(triangles), cuts_(cuts) {
    mesh_.points.assign(points.begin(), points.end());
  }

  [[nodiscard]] SplitMesh finish() {
    // Only where something is cut are places looked up.
    for (std::uint32_t i = 0; i < points_.size() && !cuts_.empty(); ++i) {
      numbers_[key(points_[i])].push_back(i);
    }
    std::vector<CubeBins::Member> members;
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      mesh_.planes.push_back(cuts_.plane_of(i));
      members.emplace_back(mesh_.planes.back(), i);
    }
    const CubeBins cut_as_one(triangles_.size(), members);
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      if (const Cuts* cuts = cuts_.of(i)) {
        split(i, cut_as_one.of(i, i), *cuts);
      } else if (mesh_.planes[i] == i) {
        add_piece(triangles_[i], i, 1);
      }
    }
    return std::move(mesh_);
  }

 private:
  using Key = std::array<double, 3>;
  [[nodiscard]] static Key key(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

  /// Cuts a triangle, or some as one, of which it is the first.
  void split(std::uint32_t first, std::span<const std::uint32_t> triangles, const Cuts& cuts) {
    Triangulation triangulation;
    std::vector<std::pair<Triangulation::Vertex_handle, std::uint32_t>> ends;
    for (const std::uint32_t triangle : triangles) {
      const std::array<Exact::Point_2, 3> flat = seen(triangle, cuts);
      for (std::size_t k = 0; k < 3; ++k) {
        ends.emplace_back(triangulation.insert(flat[k]), triangles_[triangle][k]);
      }
    }
    for (const Exact::Point_2& point : cuts.points) triangulation.insert(point);
    for (const auto& [from, to] : cuts.segments) triangulation.insert_constraint(from, to);
    for (const std::uint32_t corner : cuts.touching) {
      triangulation.insert(cuts.down(exact_point(points_[corner])));
    }
    for (const auto& [from, to] : cuts.edges) {
      triangulation.insert_constraint(cuts.down(exact_point(points_[from])),
                                      cuts.down(exact_point(points_[to])));
    }
    if (triangles.size() > 1) add_outlines(triangulation, ends);
    for (const auto vertex : triangulation.finite_vertex_handles()) {
      vertex->info() = number(cuts.projection.up(vertex->point()));
    }
    // The corners keep their numbers, even where another vertex lies in the same place.
    for (const auto& [vertex, corner] : ends) vertex->info() = corner;
    if (triangles.size() > 1) {
      for (const std::uint32_t triangle : triangles) mesh_.split.add(1, triangles_[triangle][0]);
      std::vector<std::array<Exact::Point_2, 3>> stacked;
      for (const std::uint32_t triangle : triangles) stacked.push_back(seen(triangle, cuts));
      add_stacked(triangulation, first, Stack(stacked));
      return;
    }
    if (triangulation.number_of_faces() > 1) mesh_.split.add(1, triangles_[first][0]);
    for (const auto face : triangulation.finite_face_handles()) {
      add_piece(numbers_at(face), first, 1);
    }
  }

  /// The sides of triangles that are cut as one, but for those between two of them. `ends` are
  /// their corners, three by three.
  void add_outlines(
      Triangulation& triangulation,
      const std::vector<std::pair<Triangulation::Vertex_handle, std::uint32_t>>& ends) {
    Sides sides;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const auto& [from, low] = ends[i];
      const auto& [to, high] = ends[i % 3 == 2 ? i - 2 : i + 1];
      const auto side = std::minmax(low, high);
      if (cuts_.is_inner(low, high) || !sides.insert(side).second) continue;
      if (from != to) triangulation.insert_constraint(from, to);
    }
  }

  /// Adds the pieces of triangles that are cut as one. Between cuts as many lie on each other
  /// everywhere.
  void add_stacked(Triangulation& triangulation, std::uint32_t first, const Stack& stack) {
    for (const auto face : triangulation.finite_face_handles()) face->info() = 0;
    for (const auto start : triangulation.finite_face_handles()) {
      if (start->info() != 0) continue;
      std::vector<Triangulation::Face_handle> between{start};
      start->info() = 1;
      for (std::size_t next = 0; next < between.size(); ++next) {
        for (int k = 0; k < 3; ++k) {
          const Triangulation::Face_handle other = between[next]->neighbor(k);
          if (between[next]->is_constrained(k) || triangulation.is_infinite(other)) continue;
          if (std::exchange(other->info(), 1) == 0) between.push_back(other);
        }
      }
      const auto largest = *std::max_element(
          between.begin(), between.end(),
          [](const auto& one, const auto& other) { return seen_area(one) < seen_area(other); });
      const int sum = stack.over(places_at(largest));
      // Where as many face one way as the other there is no surface.
      if (sum == 0) continue;
      for (const auto face : between) {
        Triangle piece = numbers_at(face);
        if (sum < 0) std::swap(piece[1], piece[2]);
        add_piece(piece, first, static_cast<std::uint32_t>(std::abs(sum)));
      }
    }
  }

  [[nodiscard]] static Triangle numbers_at(Triangulation::Face_handle face) {
    return {face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()};
  }

  [[nodiscard]] static std::array<Exact::Point_2, 3> places_at(Triangulation::Face_handle face) {
    return {face->vertex(0)->point(), face->vertex(1)->point(), face->vertex(2)->point()};
  }

  /// About twice the area of a face.
  [[nodiscard]] static double seen_area(Triangulation::Face_handle face) {
    std::array<Eigen::Vector2d, 3> at;
    for (int k = 0; k < 3; ++k) {
      const Exact::Point_2& point = face->vertex(k)->point();
      at[static_cast<std::size_t>(k)] = {CGAL::to_double(point.x()), CGAL::to_double(point.y())};
    }
    const Eigen::Vector2d one = at[1] - at[0], other = at[2] - at[0];
    return one.x() * other.y() - one.y() * other.x();
  }

  /// The corners of a triangle along the projection of some cuts.
  [[nodiscard]] std::array<Exact::Point_2, 3> seen(std::uint32_t index, const Cuts& cuts) const {
    const auto& [a, b, c] = triangles_[index];
    return {cuts.down(exact_point(points_[a])), cuts.down(exact_point(points_[b])),
            cuts.down(exact_point(points_[c]))};
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

  void add_piece(const Triangle& piece, std::uint32_t parent, std::uint32_t jump) {
    mesh_.pieces.push_back(piece);
    mesh_.parents.push_back(parent);
    mesh_.jumps.push_back(jump);
  }

  std::span<const Vector3> points_;
  std::span<const Triangle> triangles_;
  TriangleCuts& cuts_;
  SplitMesh mesh_;
  std::map<Key, std::vector<std::uint32_t>> numbers_;
};

}  // namespace

ExactKernel::Point_3 SplitMesh::exact_place(std::uint32_t point) const {
  const std::size_t own = points.size() - added.size();
  return point < own ? exact_point(points[point]) : added[point - own];
}

SplitMesh split_triangles(std::span<const Vector3> points, std::span<const Triangle> triangles,
                          std::span<const TrianglePair> crossing, std::size_t solids) {
  TriangleCuts cuts(points, triangles, solids);
  cuts.intersect(crossing);
  return Splitter(points, triangles, cuts).finish();
}

SplitMesh cut_as_seen(std::span<const Vector3> points, std::span<const Triangle> triangles,
                      std::span<const SeenCut> cuts) {
  TriangleCuts along(points, triangles, triangles.size());
  for (const auto& [triangle, segment] : cuts) along.cut(triangle, segment);
  SplitMesh split = Splitter(points, triangles, along).finish();
  std::size_t kept = 0;
  for (std::size_t piece = 0; piece < split.pieces.size(); ++piece) {
    const auto& [a, b, c] = split.pieces[piece];
    if (!(triangle_height(split.points[a], split.points[b], split.points[c]) > 0)) continue;
    split.pieces[kept] = split.pieces[piece];
    split.parents[kept++] = split.parents[piece];
  }
  split.pieces.resize(kept);
  split.parents.resize(kept);
  split.jumps.resize(kept);
  return split;
}

}  // namespace spm::baker
