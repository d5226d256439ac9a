// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/narrow_gaps.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "baker/base/cube_bins.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/triangle_height.hpp"
#include "baker/surface/triangle_split.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {
namespace {

/// Of the pieces that a triangle of a sheet was cut into, those that are felt.
struct PiecesOfSheet {
  std::vector<Triangle> felt;
  bool any_hidden = false;  ///< there are others
};

/// Whether a piece of a triangle of the mesh is felt, by its corners.
using IsFelt = std::function<bool(const std::array<Vector3, 3>&, const LooseTriangle&)>;

/// Lengths that count as nothing, as a share of the diagonal: far above rounding.
constexpr double nothing = 1e-9;

using Ends = std::array<std::uint32_t, 2>;

/// Sides, of which those that go straight on where no other side meets them are one.
class StraightSides {
 public:
  StraightSides(const std::vector<Vector3>& points, double touching)
      : points_(points), touching_(touching) {}

  void add(std::uint32_t from, std::uint32_t to) {
    at_[from].push_back(static_cast<std::uint32_t>(sides_.size()));
    at_[to].push_back(static_cast<std::uint32_t>(sides_.size()));
    sides_.push_back({{from, to}});
  }

  [[nodiscard]] std::vector<Ends> joined() {
    for (const auto& [point, sides] : at_) {
      if (sides.size() == 2) join_at(point, sides[0], sides[1]);
    }
    std::vector<Ends> left;
    for (const std::optional<Ends>& side : sides_) {
      if (side) left.push_back(*side);
    }
    return left;
  }

 private:
  void join_at(std::uint32_t point, std::uint32_t one, std::uint32_t other) {
    const std::uint32_t from = other_end(one, point), to = other_end(other, point);
    if (from == to || !is_between(points_[from], points_[point], points_[to])) return;
    std::replace(at_[to].begin(), at_[to].end(), other, one);
    sides_[one] = {{from, to}};
    sides_[other].reset();
  }

  [[nodiscard]] std::uint32_t other_end(std::uint32_t side, std::uint32_t point) const {
    const Ends& ends = *sides_[side];
    return ends[0] == point ? ends[1] : ends[0];
  }

  [[nodiscard]] bool is_between(const Vector3& from, const Vector3& point,
                                const Vector3& to) const {
    const Vector3 along = to - from, there = point - from;
    return along.cross(there).norm() <= touching_ * along.norm() && along.dot(there) > 0 &&
           along.dot(point - to) < 0;
  }

  const std::vector<Vector3>& points_;
  double touching_;  ///< m
  std::vector<std::optional<Ends>> sides_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> at_;  ///< sides, by their ends
};

/// What is felt of sheets, by triangle of the mesh, whose vertices are the first of `points`: each
/// triangle is cut anew, along the outline of its felt pieces alone, since nothing has to meet the
/// cuts of a sheet. Cuts add points.
[[nodiscard]] std::vector<LooseTriangle> felt_of_sheets(
    const Mesh& mesh, const std::map<std::uint32_t, PiecesOfSheet>& sheets,
    std::vector<Vector3>& points, const IsFelt& is_felt) {
  const double touching = nothing * mesh.diagonal;
  std::vector<std::uint32_t> cut;
  std::vector<LooseTriangle> felt;
  std::vector<Triangle> triangles;
  std::vector<SeenCut> cuts;
  for (const auto& [sheet, pieces] : sheets) {
    if (pieces.felt.empty()) continue;
    if (!pieces.any_hidden) {
      felt.push_back({mesh.triangles[sheet], true, sheet});
      continue;
    }
    StraightSides sides(points, touching);
    for (const HalfEdge& side : outline(points, pieces.felt)) sides.add(side.low, side.high);
    for (const auto& [from, to] : sides.joined()) {
      cuts.push_back({static_cast<std::uint32_t>(triangles.size()), {points[from], points[to]}});
    }
    triangles.push_back(mesh.triangles[sheet]);
    cut.push_back(sheet);
  }
  SplitMesh split = cut_as_seen(points, triangles, cuts);
  for (std::size_t piece = 0; piece < split.pieces.size(); ++piece) {
    const auto& [a, b, c] = split.pieces[piece];
    const std::array<Vector3, 3> corners{split.points[a], split.points[b], split.points[c]};
    const LooseTriangle one{split.pieces[piece], true, cut[split.parents[piece]]};
    // Hairs between a cut and a side that it ends at are part of neither.
    if (triangle_height(corners[0], corners[1], corners[2]) > touching && is_felt(corners, one)) {
      felt.push_back(one);
    }
  }
  points = std::move(split.points);
  return felt;
}

/// From a sheet to the places on its sides that are asked, at least, as a share of the diagonal.
constexpr double least_step = 1e-9;
/// From place to place along a sliver, in widths of a gap, and how many there are at most.
constexpr double sliver_spacing = 25, most_of_sliver = 64;

[[nodiscard]] Eigen::AlignedBox3d box_around(std::span<const Vector3> places, double margin) {
  Eigen::AlignedBox3d box;
  for (const Vector3& place : places) box.extend(place);
  return {box.min().array() - margin, box.max().array() + margin};
}

class Gaps {
 public:
  Gaps(const Mesh& mesh, std::span<const TrianglePair> facing,
       std::span<const std::uint32_t> planes, double narrow, const SolidSide& solids)
      : mesh_(mesh), narrow_(narrow), solids_(solids) {
    // Both ways round; sheets face nobody.
    std::vector<CubeBins::Member> members;
    for (const auto& [one, other] : facing) {
      members.emplace_back(planes[other], one);
      if (other < mesh.solid_triangles()) members.emplace_back(planes[one], other);
    }
    std::sort(members.begin(), members.end());
    members.erase(std::unique(members.begin(), members.end()), members.end());
    facing_ = CubeBins(mesh.triangles.size(), members);
    for (const auto& [one, other] : facing) {
      Eigen::AlignedBox3d between = box_around(corners(one), 2 * narrow);
      between.clamp(box_around(corners(other), 2 * narrow));
      gaps_.push_back(between);
    }
  }

  /// Those that face a triangle of the mesh, or others that it was cut with.
  [[nodiscard]] std::span<const std::uint32_t> facing(std::uint32_t triangle) const {
    return facing_.of(triangle, triangle);
  }
  /// The sides of those that face a triangle of the mesh, but for sides between two of them.
  [[nodiscard]] std::vector<std::array<Vector3, 2>> outline_over(std::uint32_t triangle) const {
    std::vector<Triangle> others;
    for (const std::uint32_t other : facing(triangle)) others.push_back(mesh_.triangles[other]);
    std::vector<std::array<Vector3, 2>> sides;
    for (const HalfEdge& side : outline(mesh_.vertices, others)) {
      sides.push_back({mesh_.vertices[side.low], mesh_.vertices[side.high]});
    }
    return sides;
  }

  /// Whether a piece of a triangle of the mesh is felt. One that is no higher than a gap is so only
  /// where all of its length is: what lies beside it stays, and is no farther than a gap is wide.
  [[nodiscard]] bool is_felt(const std::array<Vector3, 3>& piece,
                             const LooseTriangle& whole) const {
    const auto& [a, b, c] = piece;
    const Vector3 middle = (a + b + c) / 3;
    const Vector3 normal = (b - a).cross(c - a).stableNormalized();
    if (whole.sheet) {
      const Vector3 step = std::max(narrow_, least_step * mesh_.diagonal) * normal;
      return !inside(middle + step) && !inside(middle - step);
    }
    if (triangle_height(a, b, c) > narrow_) {
      return !is_faced(middle, whole.parent) || !is_covered(middle, normal);
    }
    if (!is_sliver_beside(piece)) return true;
    const std::array<Vector3, 3> long_first = from_longest_side(piece);
    const Vector3 along = long_first[1] - long_first[0];
    const Vector3 step = narrow_ * along.stableNormalized(), across = normal.cross(step);
    const auto count = static_cast<int>(
        std::clamp(along.norm() / (sliver_spacing * narrow_), 1.0, most_of_sliver));
    for (int i = 0; i < count; ++i) {
      const Vector3 place = middle_at(long_first, (i + 0.5) / count);
      const Vector3 over = place + narrow_ * normal;
      if (i == count / 2 ? is_covered(place, normal) : inside(over)) return false;
      if (inside(over + across) && inside(over - across)) return false;
      if (along.norm() <= 2 * narrow_ && inside(over + step) && inside(over - step)) return false;
    }
    return true;
  }

  /// Whether a piece is no higher than a gap is wide, and near one.
  [[nodiscard]] bool is_sliver_beside(const std::array<Vector3, 3>& piece) const {
    if (triangle_height(piece[0], piece[1], piece[2]) > narrow_) return false;
    const Eigen::AlignedBox3d box = box_around(piece, 0);
    return std::any_of(gaps_.begin(), gaps_.end(),
                       [&](const Eigen::AlignedBox3d& gap) { return gap.intersects(box); });
  }

 private:
  [[nodiscard]] bool is_faced(const Vector3& place, std::uint32_t parent) const {
    const auto others = facing(parent);
    return std::any_of(others.begin(), others.end(), [&](std::uint32_t other) {
      const auto [a, b, c] = corners(other);
      return (closest_on_triangle(place, a, b, c) - place).norm() <= 2 * narrow_;
    });
  }

  /// Whether a solid lies over a place, also where there is another gap behind the next wall.
  [[nodiscard]] bool is_covered(const Vector3& place, const Vector3& normal) const {
    constexpr std::array<double, 3> shares{1, 0.25, 0.0625};
    return std::any_of(shares.begin(), shares.end(),
                       [&](double share) { return inside(place + share * narrow_ * normal); });
  }

  [[nodiscard]] bool inside(const Vector3& place) const { return solids_.winding(place) > 0; }

  [[nodiscard]] std::array<Vector3, 3> corners(std::uint32_t triangle) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    return {mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]};
  }

  /// The same corners in the same order, from where the longest side begins.
  [[nodiscard]] static std::array<Vector3, 3> from_longest_side(std::array<Vector3, 3> t) {
    std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(which_longest_side(t)), t.end());
    return t;
  }

  /// The middle of a sliver at a share of the length of its longest side, the first.
  [[nodiscard]] static Vector3 middle_at(const std::array<Vector3, 3>& t, double share) {
    const Vector3 along = t[1] - t[0];
    const double top = std::clamp((t[2] - t[0]).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const Vector3 opposite = share < top ? Vector3(t[0] + share / top * (t[2] - t[0]))
                                         : Vector3(t[1] + (1 - share) / (1 - top) * (t[2] - t[1]));
    return (t[0] + share * along + opposite) / 2;
  }

  const Mesh& mesh_;
  double narrow_;  ///< m
  const SolidSide& solids_;
  CubeBins facing_;
  std::vector<Eigen::AlignedBox3d> gaps_;  ///< around the gap between each two
};

/// Leaves out pieces that may be hairs and from which no others lead to one that is none: they
/// stand alone, and nothing beside them stays where rounding lets them go.
template <class MayBeHair>
void drop_hairs(const SplitMesh& split, const MayBeHair& may_be_hair, std::vector<char>& felt) {
  std::vector<Triangle> left;
  std::vector<std::uint32_t> pieces;
  for (std::uint32_t piece = 0; piece < felt.size(); ++piece) {
    if (felt[piece] == 0) continue;
    left.push_back(split.pieces[piece]);
    pieces.push_back(piece);
  }
  Groups parts = parts_over(sorted_edges(left), left.size());
  std::vector<char> stays(left.size(), 0);
  for (std::uint32_t i = 0; i < left.size(); ++i) {
    if (!may_be_hair(pieces[i])) stays[parts.of(i)] = 1;
  }
  for (std::uint32_t i = 0; i < left.size(); ++i) felt[pieces[i]] = stays[parts.of(i)];
}

}  // namespace

Felt without_narrow_gaps(const Mesh& mesh, std::span<const TrianglePair> facing,
                         std::span<const std::uint32_t> planes, double narrow,
                         const SolidSide& solids, std::vector<Vector3>& points,
                         const std::vector<LooseTriangle>& triangles) {
  const Gaps gaps(mesh, facing, planes, narrow, solids);
  std::vector<Triangle> whole;
  std::vector<SeenCut> cuts;
  std::vector<std::array<Vector3, 2>> outline;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    whole.push_back(triangles[t].corners);
    const std::uint32_t parent = triangles[t].parent;
    if (t == 0 || parent != triangles[t - 1].parent) outline = gaps.outline_over(parent);
    const auto& [a, b, c] = triangles[t].corners;
    const std::array<Vector3, 3> corners{points[a], points[b], points[c]};
    const Eigen::AlignedBox3d box = box_around(corners, narrow);
    for (const std::array<Vector3, 2>& side : outline) {
      if (box.intersects(box_around(side, narrow))) cuts.emplace_back(t, side);
    }
  }
  const SplitMesh split = cut_as_seen(points, whole, cuts);
  std::vector<char> felt(split.pieces.size(), 0);
  tbb::parallel_for(std::size_t{0}, felt.size(), [&](std::size_t piece) {
    const auto& [a, b, c] = split.pieces[piece];
    const LooseTriangle& parent = triangles[split.parents[piece]];
    felt[piece] = gaps.is_felt({split.points[a], split.points[b], split.points[c]}, parent) ? 1 : 0;
  });
  drop_hairs(
      split,
      [&](std::uint32_t piece) {
        const auto& [a, b, c] = split.pieces[piece];
        return !triangles[split.parents[piece]].sheet &&
               gaps.is_sliver_beside({split.points[a], split.points[b], split.points[c]});
      },
      felt);
  Felt left;
  std::map<std::uint32_t, PiecesOfSheet> sheets;
  const auto hide = [&](const Triangle& piece) {
    const auto& [a, b, c] = piece;
    ++left.hidden;
    left.hidden_area += triangle_area(split.points[a], split.points[b], split.points[c]);
  };
  for (std::size_t begin = 0; begin < felt.size();) {
    const LooseTriangle& parent = triangles[split.parents[begin]];
    std::size_t end = begin;
    while (end < felt.size() && split.parents[end] == split.parents[begin]) ++end;
    const auto from = felt.begin() + static_cast<std::ptrdiff_t>(begin);
    const bool is_all = std::all_of(from, felt.begin() + static_cast<std::ptrdiff_t>(end),
                                    [](char kept) { return kept != 0; });
    if (parent.sheet) {
      PiecesOfSheet& sheet = sheets[parent.parent];
      sheet.any_hidden = sheet.any_hidden || !is_all;
      for (; begin < end; ++begin) {
        if (felt[begin] != 0) sheet.felt.push_back(split.pieces[begin]);
        if (felt[begin] == 0) hide(split.pieces[begin]);
      }
    } else if (is_all) {
      left.triangles.push_back(parent);
      begin = end;
    }
    for (; begin < end; ++begin) {
      if (felt[begin] == 0) {
        hide(split.pieces[begin]);
      } else {
        left.triangles.push_back(parent);
        left.triangles.back().corners = split.pieces[begin];
      }
    }
  }
  points = split.points;
  const std::vector<LooseTriangle> felt_sheets = felt_of_sheets(
      mesh, sheets, points, [&](const std::array<Vector3, 3>& piece, const LooseTriangle& sheet) {
        return gaps.is_felt(piece, sheet);
      });
  left.triangles.insert(left.triangles.end(), felt_sheets.begin(), felt_sheets.end());
  return left;
}

}  // namespace spm::baker
