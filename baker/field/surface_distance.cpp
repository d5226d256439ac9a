// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/surface_distance.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "baker/mesh/triangle_height.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {
namespace {

using Corners = std::array<Vector3, 3>;

/// Into so many parts a triangle is cut at most, and no more where its bound is that near to a
/// distance.
constexpr int most_parts = 20000;
constexpr double near_enough = 1.5;

/// A part of a triangle, and how far it is at most.
struct Part {
  Corners corners;
  double bound = 0;
  std::uint32_t nearest = 0;  ///< triangle to the middle
  bool operator<(const Part& other) const { return bound < other.bound; }
};

class Bound {
 public:
  Bound(const Caster& to, double enough) : to_(to), enough_(enough) {}

  /// Of a triangle. The part that may be farthest is cut until that is near enough to how far a
  /// place of the triangle is.
  [[nodiscard]] double of(const Corners& triangle, bool sheet) const {
    double farthest = 0;
    std::priority_queue<Part> parts;
    parts.push(part_of(triangle, sheet, farthest));
    for (int cuts = 0; cuts < most_parts; ++cuts) {
      const Part part = parts.top();
      if (part.bound <= std::max(enough_, near_enough * farthest)) break;
      parts.pop();
      for (const Corners& smaller : beside(part.corners, part.nearest)) {
        Part next = part_of(smaller, sheet, farthest);
        next.bound = std::min(next.bound, part.bound);
        parts.push(next);
      }
    }
    return parts.top().bound;
  }

 private:
  /// A part with its bound. The distance to one triangle is convex, so that it is largest in a
  /// corner; no distance changes by more than the way from the middle.
  [[nodiscard]] Part part_of(const Corners& corners, bool sheet, double& farthest) const {
    const Vector3 middle = (corners[0] + corners[1] + corners[2]) / 3;
    std::vector<std::pair<double, std::uint32_t>> near;
    for (const std::uint32_t triangle : around(middle, sheet)) {
      near.emplace_back(distance(middle, triangle), triangle);
    }
    std::sort(near.begin(), near.end());
    if (near.empty()) return {corners, std::numeric_limits<double>::infinity()};
    const auto [least, nearest] = near.front();
    farthest = std::max(farthest, least);
    double radius = 0;
    for (const Vector3& corner : corners) radius = std::max(radius, (corner - middle).norm());
    double best = least + radius;
    for (const auto& [away, triangle] : near) {
      // No triangle has a smaller bound than its distance in the middle.
      if (best <= std::max(enough_, away)) break;
      best =
          std::min(best, std::max({distance(corners[0], triangle), distance(corners[1], triangle),
                                   distance(corners[2], triangle)}));
    }
    return {corners, best, nearest};
  }

  /// A part, cut along the side of a triangle that it is on both sides of, or where it is so of
  /// none in two.
  [[nodiscard]] std::vector<Corners> beside(const Corners& part, std::uint32_t triangle) const {
    for (int k = 0; k < 3; ++k) {
      const Vector3& from = to_.corner(triangle, k);
      const Vector3 inwards =
          to_.normal(triangle).cross(to_.corner(triangle, (k + 1) % 3) - from).normalized();
      std::array<double, 3> in{};
      for (std::size_t i = 0; i < 3; ++i) in[i] = inwards.dot(part[i] - from);
      const auto [low, high] = std::minmax_element(in.begin(), in.end());
      if (*low < -enough_ / 2 && *high > enough_ / 2) return cut(part, in);
    }
    std::array<double, 3> along{};
    const std::size_t longest = which_longest_side(part);
    along[longest] = -1;
    along[(longest + 1) % 3] = 1;
    return cut(part, along);
  }
  /// The pieces on both sides of where a value, which the corners have, is 0.
  [[nodiscard]] static std::vector<Corners> cut(const Corners& part,
                                                const std::array<double, 3>& values) {
    std::vector<Corners> pieces;
    for (const double side : {-1.0, 1.0}) {
      std::vector<Vector3> polygon;
      for (std::size_t i = 0; i < 3; ++i) {
        const double here = side * values[i], next = side * values[(i + 1) % 3];
        if (here >= 0) polygon.push_back(part[i]);
        if (here * next < 0) {
          polygon.emplace_back(part[i] + here / (here - next) * (part[(i + 1) % 3] - part[i]));
        }
      }
      for (std::size_t i = 2; i < polygon.size(); ++i) {
        pieces.push_back({polygon[0], polygon[i - 1], polygon[i]});
      }
    }
    return pieces;
  }
  [[nodiscard]] double distance(const Vector3& place, std::uint32_t triangle) const {
    return (closest_on_triangle(place, to_.corner(triangle, 0), to_.corner(triangle, 1),
                                to_.corner(triangle, 2)) -
            place)
        .norm();
  }
  /// Those of the kind that are near a place, the nearest among them.
  [[nodiscard]] std::vector<std::uint32_t> around(const Vector3& place, bool sheet) const {
    std::vector<std::uint32_t> near;
    for (double radius = 2 * enough_; near.empty() && radius < 4 * to_.diagonal(); radius *= 4) {
      to_.within(place, radius, near);
      std::erase_if(near, [&](std::uint32_t t) { return to_.is_sheet(t) != sheet; });
    }
    return near;
  }

  const Caster& to_;
  double enough_;  ///< m
};

}  // namespace

double largest_distance(const OuterSurface& from, const Caster& to, double enough) {
  const Bound bound(to, enough);
  std::vector<double> bounds(from.triangles.size());
  tbb::parallel_for(std::size_t{0}, bounds.size(), [&](std::size_t t) {
    const auto& [a, b, c] = from.triangles[t];
    bounds[t] =
        bound.of({from.vertices[a], from.vertices[b], from.vertices[c]}, t >= from.solid_count);
  });
  return bounds.empty() ? 0 : *std::max_element(bounds.begin(), bounds.end());
}

}  // namespace spm::baker
