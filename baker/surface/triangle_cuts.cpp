// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/triangle_cuts.hpp"

#include <algorithm>

#include "baker/mesh/mesh_edges.hpp"

namespace spm::baker {
namespace {

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

}  // namespace

Cuts& TriangleCuts::cuts_of(std::uint32_t index) {
  const std::uint32_t first = planes_.of(index);
  const auto found = cuts_.find(first);
  return found != cuts_.end() ? found->second
                              : cuts_.emplace(first, Cuts(corners(first))).first->second;
}

std::array<ExactKernel::Point_3, 3> TriangleCuts::corners(std::uint32_t index) const {
  const auto& [a, b, c] = triangles_[index];
  return {exact_point(points_[a]), exact_point(points_[b]), exact_point(points_[c])};
}

ExactKernel::Triangle_3 TriangleCuts::triangle(std::uint32_t index) const {
  const auto [a, b, c] = corners(index);
  return {a, b, c};
}

ExactKernel::Segment_3 TriangleCuts::segment(const std::array<std::uint32_t, 2>& ends) const {
  return {exact_point(points_[ends[0]]), exact_point(points_[ends[1]])};
}

/// On which side of a triangle's plane the corners of another lie.
std::array<CGAL::Orientation, 3> TriangleCuts::beside_plane(std::uint32_t plane,
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

bool TriangleCuts::in_one_plane(std::uint32_t first, std::uint32_t second) const {
  const std::array<CGAL::Orientation, 3> beside = beside_plane(first, second);
  return std::all_of(beside.begin(), beside.end(),
                     [](CGAL::Orientation side) { return side == CGAL::ZERO; });
}

/// The corners of a triangle that touches another's plane, and does not pass it, where it does.
std::vector<std::uint32_t> TriangleCuts::corners_in_plane(std::uint32_t plane,
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
void TriangleCuts::find_inner_sides() {
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

void TriangleCuts::intersect(std::span<const TrianglePair> pairs) {
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

void TriangleCuts::cut(std::uint32_t index, const std::array<Vector3, 2>& segment) {
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

/// Cuts two triangles of solids that are not in one plane along what they share.
void TriangleCuts::cut_solids(std::uint32_t first, std::uint32_t second) {
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
bool TriangleCuts::cut_where_touched(std::uint32_t index, std::uint32_t plane) {
  const std::vector<std::uint32_t> touching = corners_in_plane(plane, index);
  if (touching.size() == 1) {
    cut_at_corner(touching[0], plane);
    return true;
  }
  return touching.size() == 2 && cut_along_side(index, {touching[0], touching[1]}, plane);
}

void TriangleCuts::cut_at_corner(std::uint32_t corner, std::uint32_t plane) {
  Cuts& cuts = cuts_of(plane);
  const auto seen = [&](std::uint32_t point) { return cuts.projection.down(points_[point]); };
  const auto& [a, b, c] = triangles_[plane];
  const PlainKernel::Triangle_2 flat(seen(a), seen(b), seen(c));
  if (!flat.has_on_unbounded_side(seen(corner))) cuts.touching.insert(corner);
}

bool TriangleCuts::cut_along_side(std::uint32_t index, const std::array<std::uint32_t, 2>& side,
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
void TriangleCuts::cut_sheet(std::uint32_t sheet, std::uint32_t solid) {
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
void TriangleCuts::cut_once(std::uint32_t sheet, std::uint32_t from, std::uint32_t to) {
  if (cuts_of(sheet).sides.insert(std::minmax(from, to)).second) {
    cut(sheet, {points_[from], points_[to]});
  }
}

}  // namespace spm::baker
