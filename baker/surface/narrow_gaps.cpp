// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/narrow_gaps.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "baker/base/cube_bins.hpp"
#include "baker/mesh/triangle_height.hpp"
#include "baker/surface/triangle_split.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {
namespace {

/// From a sheet to the places on its sides that are asked, at least, as a share of the diagonal.
constexpr double least_step = 1e-9;

class Gaps {
 public:
  Gaps(const Mesh& mesh, std::span<const TrianglePair> facing, double narrow,
       const WindingNumber& winding)
      : mesh_(mesh), narrow_(narrow), winding_(winding) {
    // Both ways round; sheets face nobody.
    std::vector<CubeBins::Member> members;
    for (const auto& [one, other] : facing) {
      members.emplace_back(other, one);
      if (other < mesh.solid_triangles()) members.emplace_back(one, other);
    }
    facing_ = CubeBins(mesh.triangles.size(), members);
  }

  /// Those that face a triangle of the mesh.
  [[nodiscard]] std::span<const std::uint32_t> facing(std::uint32_t triangle) const {
    return facing_.of(triangle, triangle);
  }
  [[nodiscard]] std::array<Vector3, 3> corners(std::uint32_t triangle) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    return {mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]};
  }

  /// Whether a piece of a triangle of the mesh is felt.
  [[nodiscard]] bool is_felt(const std::array<Vector3, 3>& piece,
                             const LooseTriangle& whole) const {
    const auto& [a, b, c] = piece;
    const Vector3 middle = (a + b + c) / 3;
    const Vector3 normal = (b - a).cross(c - a).stableNormalized();
    if (!whole.sheet) return !bounds_gap(piece, whole.parent, middle, normal);
    const Vector3 step = std::max(narrow_, least_step * mesh_.diagonal) * normal;
    return !inside(middle + step) && !inside(middle - step);
  }

 private:
  /// Whether another faces the piece and beyond that is a solid, or the piece is no higher than a
  /// gap and lies across one.
  [[nodiscard]] bool bounds_gap(const std::array<Vector3, 3>& piece, std::uint32_t parent,
                                const Vector3& middle, const Vector3& normal) const {
    const auto others = facing(parent);
    const bool faced = std::any_of(others.begin(), others.end(), [&](std::uint32_t other) {
      const auto [a, b, c] = corners(other);
      return (closest_on_triangle(middle, a, b, c) - middle).norm() <= 2 * narrow_;
    });
    const bool sliver = triangle_height(piece[0], piece[1], piece[2]) <= narrow_;
    if (!faced && !sliver) return false;
    // Also where there is another such gap behind the next wall.
    constexpr std::array<double, 3> shares{1, 0.25, 0.0625};
    if (std::any_of(shares.begin(), shares.end(),
                    [&](double share) { return inside(middle + share * narrow_ * normal); })) {
      return true;
    }
    const Vector3 across = narrow_ * normal.cross(longest_way(piece)).stableNormalized();
    return sliver && inside(middle + narrow_ * normal + across) &&
           inside(middle + narrow_ * normal - across);
  }

  [[nodiscard]] bool inside(const Vector3& place) const { return winding_.at(place) >= 0.5; }

  [[nodiscard]] static Vector3 longest_way(const std::array<Vector3, 3>& t) {
    const std::array<Vector3, 3> ways{t[1] - t[0], t[2] - t[1], t[0] - t[2]};
    return *std::max_element(ways.begin(), ways.end(),
                             [](const Vector3& one, const Vector3& other) {
                               return one.squaredNorm() < other.squaredNorm();
                             });
  }

  const Mesh& mesh_;
  double narrow_;  ///< m
  const WindingNumber& winding_;
  CubeBins facing_;
};

[[nodiscard]] Eigen::AlignedBox3d box_around(const std::array<Vector3, 3>& corners, double margin) {
  Eigen::AlignedBox3d box;
  for (const Vector3& corner : corners) box.extend(corner);
  return {box.min().array() - margin, box.max().array() + margin};
}

}  // namespace

Felt without_narrow_gaps(const Mesh& mesh, std::span<const TrianglePair> facing, double narrow,
                         const WindingNumber& winding, std::vector<Vector3>& points,
                         const std::vector<LooseTriangle>& triangles) {
  const Gaps gaps(mesh, facing, narrow, winding);
  std::vector<Triangle> whole;
  std::vector<OutlineCut> outlines;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    whole.push_back(triangles[t].corners);
    const auto& [a, b, c] = triangles[t].corners;
    const Eigen::AlignedBox3d box = box_around({points[a], points[b], points[c]}, narrow);
    for (const std::uint32_t other : gaps.facing(triangles[t].parent)) {
      const std::array<Vector3, 3> corners = gaps.corners(other);
      if (box.intersects(box_around(corners, narrow))) outlines.emplace_back(t, corners);
    }
  }
  const SplitMesh split = cut_along_outlines(points, whole, outlines);
  std::vector<char> felt(split.pieces.size(), 0);
  tbb::parallel_for(std::size_t{0}, felt.size(), [&](std::size_t piece) {
    const auto& [a, b, c] = split.pieces[piece];
    const LooseTriangle& parent = triangles[split.parents[piece]];
    felt[piece] = gaps.is_felt({split.points[a], split.points[b], split.points[c]}, parent) ? 1 : 0;
  });
  Felt left;
  for (std::size_t begin = 0; begin < felt.size();) {
    const LooseTriangle& parent = triangles[split.parents[begin]];
    std::size_t end = begin;
    while (end < felt.size() && split.parents[end] == split.parents[begin]) ++end;
    const auto from = felt.begin() + static_cast<std::ptrdiff_t>(begin);
    if (std::all_of(from, felt.begin() + static_cast<std::ptrdiff_t>(end),
                    [](char kept) { return kept != 0; })) {
      left.triangles.push_back(parent);
      begin = end;
    }
    for (; begin < end; ++begin) {
      const auto& [a, b, c] = split.pieces[begin];
      if (felt[begin] != 0) {
        left.triangles.push_back(parent);
        left.triangles.back().corners = split.pieces[begin];
      } else {
        ++left.hidden;
        left.hidden_area += triangle_area(split.points[a], split.points[b], split.points[c]);
      }
    }
  }
  points = split.points;
  return left;
}

}  // namespace spm::baker
