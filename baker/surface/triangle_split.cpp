// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/triangle_split.hpp"

// Cuts of one triangle seldom cross: the triangulation that CGAL recommends instead costs more.
#define CGAL_NO_CDT_2_WARNING
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "baker/base/cube_bins.hpp"
#include "baker/base/groups.hpp"
#include "baker/base/seen_along.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/triangle_height.hpp"

namespace spm::baker {
namespace {

/// Of places as they are given, where nothing is constructed.
using PlainKernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// The plane of a triangle, seen along the axis that is closest to its normal. It keeps the
/// triangle's orientation.
class Projection {
 public:
  explicit Projection(const std::array<ExactKernel::Point_3, 3>& corners) : origin_(corners[0]) {
    const ExactKernel::Vector_3 normal =
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

  [[nodiscard]] ExactKernel::Point_2 down(const ExactKernel::Point_3& p) const {
    return {p[first_], p[second_]};
  }

  /// The same of a place as it is given.
  [[nodiscard]] PlainKernel::Point_2 down(const Vector3& p) const {
    return {p[first_], p[second_]};
  }

  /// The point of the plane over q.
  [[nodiscard]] ExactKernel::Point_3 up(const ExactKernel::Point_2& q) const {
    std::array<ExactKernel::FT, 3> p;
    p[static_cast<std::size_t>(first_)] = q.x();
    p[static_cast<std::size_t>(second_)] = q.y();
    p[static_cast<std::size_t>(drop_)] = height(q);
    return {p[0], p[1], p[2]};
  }

 private:
  [[nodiscard]] ExactKernel::FT height(const ExactKernel::Point_2& q) const {
    return origin_[drop_] + slope_first_ * (q.x() - origin_[first_]) +
           slope_second_ * (q.y() - origin_[second_]);
  }

  ExactKernel::Point_3 origin_;
  int drop_ = 0, first_ = 0, second_ = 0;
  ExactKernel::FT slope_first_, slope_second_;
};

/// Sides by their ends, the lower first.
using Sides = std::set<std::pair<std::uint32_t, std::uint32_t>>;

/// The traces of other triangles on one, or on some of one plane, as they are seen along the
/// projection of the first.
struct Cuts {
  explicit Cuts(const std::array<ExactKernel::Point_3, 3>& corners)
      : projection(corners), flat({down(corners[0]), down(corners[1]), down(corners[2])}) {}

  [[nodiscard]] ExactKernel::Point_2 down(const ExactKernel::Point_3& point) const {
    return projection.down(point);
  }

  Projection projection;
  std::array<ExactKernel::Point_2, 3> flat;  ///< the first one's corners
  std::vector<ExactKernel::Point_2> points;
  std::vector<std::pair<ExactKernel::Point_2, ExactKernel::Point_2>> segments;
  Sides sides;                       ///< of others in its plane, for sheets
  std::set<std::uint32_t> touching;  ///< corners of others that touch them
  Sides edges;                       ///< the same, as a whole
};

/// Whether a segment passes the inside of a triangle: neither a side nor the segment has both
/// apart.
[[nodiscard]] bool passes_within(const std::array<PlainKernel::Point_2, 3>& triangle,
                                 const PlainKernel::Point_2& from, const PlainKernel::Point_2& to) {
  const CGAL::Orientation turn = CGAL::orientation(triangle[0], triangle[1], triangle[2]);
  bool is_left = false, is_right = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const PlainKernel::Point_2 &corner = triangle[k], &next = triangle[(k + 1) % 3];
    if (CGAL::orientation(corner, next, from) != turn &&
        CGAL::orientation(corner, next, to) != turn) {
      return false;
    }
    const CGAL::Orientation beside = CGAL::orientation(from, to, corner);
    is_left = is_left || beside == CGAL::LEFT_TURN;
    is_right = is_right || beside == CGAL::RIGHT_TURN;
  }
  return is_left && is_right;
}

/// Along what each of some triangles is cut, by exact constructions. The first `solids` are those
/// of solids; of these, such as lie on each other in one plane are cut as one. Sheets cut no
/// others.
class TriangleCuts {
 public:
  TriangleCuts(std::span<const Vector3> points, std::span<const Triangle> triangles,
               std::size_t solids)
      : points_(points), triangles_(triangles), solids_(solids), planes_(triangles.size()) {}

  /// Cuts the triangles of pairs along what they share.
  void intersect(std::span<const TrianglePair> pairs) {
    std::vector<char> flat(pairs.size(), 0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto [first, second] = pairs[i];
      if (!in_one_plane(first, second)) continue;
      flat[i] = 1;
      if (second < solids_) planes_.join(first, second);
    }
    if (std::any_of(flat.begin(), flat.end(), [](char is_flat) { return is_flat != 0; })) {
      find_inner_sides();
    }
    std::map<std::uint32_t, std::vector<Triangle>> on_sheets;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto [first, second] = pairs[i];
      const bool is_sheet = second >= solids_;
      if (is_sheet && flat[i] != 0) {
        on_sheets[second].push_back(triangles_[first]);
      } else if (is_sheet) {
        cut_sheet(second, first);
      } else if (flat[i] == 0) {
        cut_solids(first, second);
      } else {
        (void)cuts_of(first);
      }
    }
    for (const auto& [sheet, solids] : on_sheets) {
      for (const HalfEdge& side : outline(points_, solids)) cut_once(sheet, side.low, side.high);
    }
  }

  /// Cuts a triangle along a segment, as seen along the axis that is closest to its normal. A
  /// triangle that rounding left on a line is not cut.
  void cut(std::uint32_t index, const std::array<Vector3, 2>& segment) {
    if (!cuts_.contains(index)) {
      const std::array<ExactKernel::Point_3, 3> own = corners(index);
      if (CGAL::collinear(own[0], own[1], own[2])) return;
    }
    Cuts& own = cuts_of(index);
    const auto& [a, b, c] = triangles_[index];
    const auto plain = [&](const Vector3& place) { return own.projection.down(place); };
    if (!passes_within({plain(points_[a]), plain(points_[b]), plain(points_[c])}, plain(segment[0]),
                       plain(segment[1]))) {
      return;
    }
    const ExactKernel::Segment_2 seen(own.down(exact_point(segment[0])),
                                      own.down(exact_point(segment[1])));
    const CGAL::Object common =
        CGAL::intersection(ExactKernel::Triangle_2(own.flat[0], own.flat[1], own.flat[2]), seen);
    if (const auto* part = CGAL::object_cast<ExactKernel::Segment_2>(&common)) {
      own.segments.emplace_back(part->source(), part->target());
    }
  }

  [[nodiscard]] bool empty() const { return cuts_.empty(); }
  /// Nothing where it is not cut, or with another before it.
  [[nodiscard]] const Cuts* of(std::uint32_t index) const {
    const auto found = cuts_.find(index);
    return found != cuts_.end() ? &found->second : nullptr;
  }
  /// The first of those that a triangle is cut with.
  [[nodiscard]] std::uint32_t plane_of(std::uint32_t index) { return planes_.of(index); }
  /// Whether a side lies between two that are cut as one, and nothing else has it.
  [[nodiscard]] bool is_inner(std::uint32_t from, std::uint32_t to) const {
    return inner_.contains(std::minmax(from, to));
  }

 private:
  Cuts& cuts_of(std::uint32_t index) {
    const std::uint32_t first = planes_.of(index);
    const auto found = cuts_.find(first);
    return found != cuts_.end() ? found->second
                                : cuts_.emplace(first, Cuts(corners(first))).first->second;
  }

  [[nodiscard]] std::array<ExactKernel::Point_3, 3> corners(std::uint32_t index) const {
    const auto& [a, b, c] = triangles_[index];
    return {exact_point(points_[a]), exact_point(points_[b]), exact_point(points_[c])};
  }

  [[nodiscard]] ExactKernel::Triangle_3 triangle(std::uint32_t index) const {
    const auto [a, b, c] = corners(index);
    return {a, b, c};
  }

  [[nodiscard]] ExactKernel::Segment_3 segment(const std::array<std::uint32_t, 2>& ends) const {
    return {exact_point(points_[ends[0]]), exact_point(points_[ends[1]])};
  }

  /// On which side of a triangle's plane the corners of another lie.
  [[nodiscard]] std::array<CGAL::Orientation, 3> beside_plane(std::uint32_t plane,
                                                              std::uint32_t other) const {
    const auto plain = [&](std::uint32_t point) {
      const Vector3& p = points_[point];
      return PlainKernel::Point_3(p.x(), p.y(), p.z());
    };
    const auto& [a, b, c] = triangles_[plane];
    const PlainKernel::Point_3 p = plain(a), q = plain(b), r = plain(c);
    std::array<CGAL::Orientation, 3> sides{};
    std::transform(triangles_[other].begin(), triangles_[other].end(), sides.begin(),
                   [&](std::uint32_t corner) { return CGAL::orientation(p, q, r, plain(corner)); });
    return sides;
  }

  [[nodiscard]] bool in_one_plane(std::uint32_t first, std::uint32_t second) const {
    const std::array<CGAL::Orientation, 3> beside = beside_plane(first, second);
    return std::all_of(beside.begin(), beside.end(),
                       [](CGAL::Orientation side) { return side == CGAL::ZERO; });
  }

  /// The corners of a triangle that touches another's plane, and does not pass it, where it does.
  [[nodiscard]] std::vector<std::uint32_t> corners_in_plane(std::uint32_t plane,
                                                            std::uint32_t other) const {
    const std::array<CGAL::Orientation, 3> beside = beside_plane(plane, other);
    const auto [least, most] = std::minmax_element(beside.begin(), beside.end());
    if (*least == CGAL::NEGATIVE && *most == CGAL::POSITIVE) return {};
    std::vector<std::uint32_t> found;
    for (std::size_t k = 0; k < 3; ++k) {
      if (beside[k] == CGAL::ZERO) found.push_back(triangles_[other][k]);
    }
    return found;
  }

  /// Finds the sides between two triangles that are cut as one.
  void find_inner_sides() {
    const std::vector<Triangle> all(triangles_.begin(), triangles_.end());
    for_each_edge(sorted_edges(all), [&](std::span<const HalfEdge> users) {
      if (users.size() != 2 || users[0].forward == users[1].forward ||
          planes_.of(users[0].triangle) != planes_.of(users[1].triangle)) {
        return;
      }
      const auto tip = [&](const HalfEdge& user) {
        return exact_point(points_[tip_of(triangles_[user.triangle], user)]);
      };
      const auto low = exact_point(points_[users[0].low]);
      const auto high = exact_point(points_[users[0].high]);
      if (CGAL::coplanar_orientation(low, high, tip(users[0]), tip(users[1])) == CGAL::NEGATIVE) {
        inner_.emplace(users[0].low, users[0].high);
      }
    });
  }

  /// Cuts two triangles of solids that are not in one plane along what they share.
  void cut_solids(std::uint32_t first, std::uint32_t second) {
    if (cut_where_touched(first, second) || cut_where_touched(second, first)) return;
    // An Object, since CGAL 5 and 6 return variants of different libraries.
    const CGAL::Object common = CGAL::intersection(triangle(first), triangle(second));
    for (const std::uint32_t side : {first, second}) {
      Cuts& own = cuts_of(side);
      if (const auto* point = CGAL::object_cast<ExactKernel::Point_3>(&common)) {
        own.points.push_back(own.down(*point));
      } else if (const auto* segment = CGAL::object_cast<ExactKernel::Segment_3>(&common)) {
        own.segments.emplace_back(own.down(segment->source()), own.down(segment->target()));
      }
    }
  }

  /// Cuts a triangle, and those that are cut as one with another that it touches with a corner or
  /// a side: with a side as a whole, as long as that passes no outline of theirs but where the
  /// triangle is cut too. False where the two are to be cut along what they share.
  bool cut_where_touched(std::uint32_t index, std::uint32_t plane) {
    const std::vector<std::uint32_t> touching = corners_in_plane(plane, index);
    if (touching.size() == 1) {
      cut_at_corner(touching[0], plane);
      return true;
    }
    return touching.size() == 2 && cut_along_side(index, {touching[0], touching[1]}, plane);
  }

  void cut_at_corner(std::uint32_t corner, std::uint32_t plane) {
    Cuts& cuts = cuts_of(plane);
    const auto seen = [&](std::uint32_t point) { return cuts.projection.down(points_[point]); };
    const auto& [a, b, c] = triangles_[plane];
    const PlainKernel::Triangle_2 flat(seen(a), seen(b), seen(c));
    if (!flat.has_on_unbounded_side(seen(corner))) cuts.touching.insert(corner);
  }

  bool cut_along_side(std::uint32_t index, const std::array<std::uint32_t, 2>& side,
                      std::uint32_t plane) {
    const Triangle& in_plane = triangles_[plane];
    const auto [a, b, c] = in_plane;
    if (!is_inner(a, b) && !is_inner(b, c) && !is_inner(c, a)) return false;
    Cuts& cuts = cuts_of(plane);
    const auto seen = [&](std::uint32_t point) { return cuts.projection.down(points_[point]); };
    const PlainKernel::Point_2 from = seen(side[0]), to = seen(side[1]);
    const std::array<PlainKernel::Point_2, 3> flat{seen(a), seen(b), seen(c)};
    if (!passes_within(flat, from, to)) return false;
    if (std::any_of(flat.begin(), flat.end(), [&](const PlainKernel::Point_2& corner) {
          return CGAL::collinear(from, to, corner);
        })) {
      return false;
    }
    cuts.edges.insert(std::minmax(side[0], side[1]));
    Cuts& own = cuts_of(index);
    own.edges.insert(std::minmax(side[0], side[1]));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::array outline{in_plane[k], in_plane[(k + 1) % 3]};
      if (is_inner(outline[0], outline[1])) continue;
      const CGAL::Object common = CGAL::intersection(segment(side), segment(outline));
      if (const auto* point = CGAL::object_cast<ExactKernel::Point_3>(&common)) {
        own.points.push_back(own.down(*point));
      }
    }
    return true;
  }

  /// Cuts a sheet where a triangle of a solid that is not in its plane passes it.
  void cut_sheet(std::uint32_t sheet, std::uint32_t solid) {
    const std::vector<std::uint32_t> touching = corners_in_plane(sheet, solid);
    // So that no piece is asked for its side where a solid touches it.
    if (touching.size() == 1) cut_at_corner(touching[0], sheet);
    if (touching.size() == 2) cut_once(sheet, touching[0], touching[1]);
    if (!touching.empty()) return;
    const CGAL::Object common = CGAL::intersection(triangle(sheet), triangle(solid));
    if (const auto* segment = CGAL::object_cast<ExactKernel::Segment_3>(&common)) {
      Cuts& own = cuts_of(sheet);
      own.segments.emplace_back(own.down(segment->source()), own.down(segment->target()));
    }
  }

  /// Cuts a sheet along a side in its plane, which several triangles may have.
  void cut_once(std::uint32_t sheet, std::uint32_t from, std::uint32_t to) {
    if (cuts_of(sheet).sides.insert(std::minmax(from, to)).second) {
      cut(sheet, {points_[from], points_[to]});
    }
  }

  std::span<const Vector3> points_;
  std::span<const Triangle> triangles_;
  std::size_t solids_;
  Groups planes_;  ///< of triangles that are cut as one
  Sides inner_;
  std::map<std::uint32_t, Cuts> cuts_;  ///< by the first
};

/// A place of the projection, rounded.
[[nodiscard]] Vector3 near(const ExactKernel::Point_2& place) {
  return {CGAL::to_double(place.x()), CGAL::to_double(place.y()), 0};
}

/// A triangle of some that lie on each other, as it is seen along their projection.
class StackedTriangle {
 public:
  explicit StackedTriangle(const std::array<ExactKernel::Point_2, 3>& corners)
      : corners_(corners), turn_(CGAL::orientation(corners[0], corners[1], corners[2])) {}

  [[nodiscard]] CGAL::Orientation turn() const { return turn_; }
  /// Where a place lies: on the triangle, beyond it, or on one of its sides.
  [[nodiscard]] CGAL::Bounded_side side_of(const ExactKernel::Point_2& place) const {
    bool on_line = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const CGAL::Orientation own = CGAL::orientation(corners_[k], corners_[(k + 1) % 3], place);
      if (own == -turn_) return CGAL::ON_UNBOUNDED_SIDE;
      on_line = on_line || own == CGAL::ZERO;
    }
    return on_line ? CGAL::ON_BOUNDARY : CGAL::ON_BOUNDED_SIDE;
  }

 private:
  std::array<ExactKernel::Point_2, 3> corners_;
  CGAL::Orientation turn_;
};

/// Some that lie on each other.
class Stack {
 public:
  explicit Stack(const std::vector<std::array<ExactKernel::Point_2, 3>>& triangles) {
    std::vector<std::array<Vector3, 3>> rounded;
    for (const auto& corners : triangles) {
      triangles_.emplace_back(corners);
      rounded.push_back({near(corners[0]), near(corners[1]), near(corners[2])});
    }
    seen_ = SeenAlong(Vector3::UnitZ(), rounded);
  }

  /// How many of these turn as they are seen, less those that turn the other way, over a triangle
  /// that no side of them passes.
  [[nodiscard]] int over(const std::array<ExactKernel::Point_2, 3>& triangle) const {
    // The first place on a curve that no side passes. Any line passes the curve twice at most.
    const auto& [a, b, c] = triangle;
    using Number = ExactKernel::FT;
    for (int k = 1;; ++k) {
      const auto place =
          CGAL::barycenter(a, Number(97 + k), b, Number(101 + k * k), c, Number(103));
      if (const auto sum = at(place)) return *sum;
    }
  }

 private:
  /// The same at a place; nothing where it lies on a side of one.
  [[nodiscard]] std::optional<int> at(const ExactKernel::Point_2& place) const {
    int sum = 0;
    for (const std::uint32_t one : seen_.over(near(place))) {
      const CGAL::Bounded_side side = triangles_[one].side_of(place);
      if (side == CGAL::ON_BOUNDARY) return std::nullopt;
      if (side == CGAL::ON_BOUNDED_SIDE) sum += triangles_[one].turn();
    }
    return sum;
  }

  std::vector<StackedTriangle> triangles_;
  SeenAlong seen_;
};

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
