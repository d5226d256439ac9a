// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/charts/plane_charts.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <utility>

#include "common/surface/support_plane_mapping.hpp"

namespace spm::baker {

namespace {

/// Triangles that meet at a steeper edge are of two charts: cosine of 30 degrees.
constexpr double crease_cosine = 0.866;
/// A chart goes on over triangles that face its plane: cosine of 55 degrees.
constexpr double facing_cosine = 0.574;

constexpr std::uint32_t no_triangle = std::numeric_limits<std::uint32_t>::max();

/// The solids' triangles, each with its normal and with what it goes on to without a crease.
struct Pieces {
  std::vector<std::array<Vector3, 3>> corners;
  std::vector<Vector3> normals;                      ///< unit; 0 where there is no area
  std::vector<std::array<std::uint32_t, 3>> beyond;  ///< by edge, from corner k to the next
};

Pieces pieces_of(const OuterSurface& surface) {
  Pieces pieces;
  const std::size_t count = surface.solid_count;
  pieces.beyond.assign(count, {no_triangle, no_triangle, no_triangle});
  // Corners of one place are one, whatever their numbers.
  std::map<std::array<double, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> place_of;
  place_of.reserve(surface.vertices.size());
  for (const Vector3& v : surface.vertices) {
    const auto next = static_cast<std::uint32_t>(places.size());
    place_of.push_back(places.emplace(std::array{v.x(), v.y(), v.z()}, next).first->second);
  }
  struct Side {
    std::uint32_t from, to, triangle, edge;
  };
  std::vector<Side> sides;
  for (std::uint32_t t = 0; t < count; ++t) {
    const auto& numbers = surface.triangles[t];
    const std::array<Vector3, 3> corners{surface.vertices[numbers[0]], surface.vertices[numbers[1]],
                                         surface.vertices[numbers[2]]};
    const Vector3 cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const double twice = cross.norm();
    pieces.corners.push_back(corners);
    pieces.normals.push_back(twice > 0 ? Vector3(cross / twice) : Vector3(Vector3::Zero()));
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = place_of[numbers[k]], b = place_of[numbers[(k + 1) % 3]];
      sides.push_back({std::min(a, b), std::max(a, b), t, k});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.from, a.to, a.triangle, a.edge) < std::tie(b.from, b.to, b.triangle, b.edge);
  });
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    while (end < sides.size() && sides[end].from == sides[i].from && sides[end].to == sides[i].to)
      ++end;
    if (end - i == 2) {
      const Side &one = sides[i], &other = sides[i + 1];
      if (pieces.normals[one.triangle].dot(pieces.normals[other.triangle]) > crease_cosine) {
        pieces.beyond[one.triangle][one.edge] = other.triangle;
        pieces.beyond[other.triangle][other.edge] = one.triangle;
      }
    }
    i = end;
  }
  return pieces;
}

Vector3 middle_of_edge(const Pieces& pieces, std::uint32_t triangle, std::size_t edge) {
  const auto& corners = pieces.corners[triangle];
  return (corners[edge] + corners[(edge + 1) % 3]) / 2;
}

/// The triangles of a plane's charts: its own, and what follows them.
std::vector<bool> region_of(const Pieces& pieces, const std::vector<std::uint32_t>& owner,
                            std::uint32_t which, const Vector3& normal, double reach) {
  const std::size_t count = owner.size();
  std::vector<bool> within(count, false);
  /// A way to an edge of a triangle that is within.
  struct Way {
    double length;
    std::uint32_t triangle;
    std::uint32_t edge;  ///< by which it came; 3 for none
    bool operator>(const Way& other) const {
      return std::tie(length, triangle, edge) > std::tie(other.length, other.triangle, other.edge);
    }
  };
  std::priority_queue<Way, std::vector<Way>, std::greater<>> ways;
  for (std::uint32_t t = 0; t < count; ++t) {
    if (owner[t] != which || pieces.normals[t].dot(normal) < facing_cosine) continue;
    within[t] = true;
    ways.push({0, t, 3});
  }
  while (!ways.empty()) {
    const Way way = ways.top();
    ways.pop();
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const std::uint32_t next = pieces.beyond[way.triangle][edge];
      if (next == no_triangle || within[next] || pieces.normals[next].dot(normal) < facing_cosine)
        continue;
      double length = way.length;
      if (way.edge < 3) {
        length += (middle_of_edge(pieces, way.triangle, edge) -
                   middle_of_edge(pieces, way.triangle, way.edge))
                      .norm();
      }
      if (length > reach) continue;
      within[next] = true;
      std::uint32_t back = 3;
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (pieces.beyond[next][k] == way.triangle) back = k;
      }
      ways.push({length, next, back});
    }
  }
  return within;
}

/// The connected parts of a region.
std::vector<PlaneChart> parts_of(const Pieces& pieces, std::vector<bool> region,
                                 std::uint32_t which) {
  std::vector<PlaneChart> parts;
  std::vector<std::uint32_t> open;
  for (std::uint32_t t = 0; t < region.size(); ++t) {
    if (!region[t]) continue;
    PlaneChart part;
    part.plane = which;
    region[t] = false;
    open.push_back(t);
    while (!open.empty()) {
      const std::uint32_t here = open.back();
      open.pop_back();
      part.triangles.push_back(here);
      for (const std::uint32_t next : pieces.beyond[here]) {
        if (next == no_triangle || !region[next]) continue;
        region[next] = false;
        open.push_back(next);
      }
    }
    std::sort(part.triangles.begin(), part.triangles.end());
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace

PlaneCharts::PlaneCharts(const OuterSurface& surface, std::span<const SupportPlane> planes,
                         double reach) {
  const Pieces pieces = pieces_of(surface);
  const std::size_t count = pieces.corners.size();
  std::vector<std::uint32_t> owner(count, 0);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t t) {
    owner[t] = static_cast<std::uint32_t>(support_plane_mapping(planes, pieces.normals[t]));
  });
  std::vector<std::vector<PlaneChart>> by_plane(planes.size());
  tbb::parallel_for(std::size_t{0}, planes.size(), [&](std::size_t k) {
    const auto which = static_cast<std::uint32_t>(k);
    by_plane[k] = parts_of(pieces, region_of(pieces, owner, which, planes[k].n, reach), which);
  });
  for (auto& parts : by_plane) std::move(parts.begin(), parts.end(), std::back_inserter(charts_));
  first_.assign(count + 1, 0);
  for (const PlaneChart& chart : charts_) {
    for (const std::uint32_t t : chart.triangles) ++first_[t + 1];
  }
  for (std::size_t t = 0; t < count; ++t) first_[t + 1] += first_[t];
  members_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t chart = 0; chart < charts_.size(); ++chart) {
    for (const std::uint32_t t : charts_[chart].triangles) members_[next[t]++] = chart;
  }
}

}  // namespace spm::baker
