// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/reachability/sealed_voids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "baker/base/groups.hpp"
#include "common/surface/support_plane_mapping.hpp"

namespace spm::baker {
namespace {

using Numbers = std::vector<std::uint32_t>;

/// The triangles of a caster that are of solids. Corners that coincide are merged.
struct Triangles {
  std::vector<Triangle> corners;
  std::uint32_t points = 0;
};

Triangles number_corners(const Caster& caster, std::uint32_t count) {
  struct Corner {
    std::array<double, 3> place;
    std::uint32_t slot;
  };
  std::vector<Corner> corners;
  corners.reserve(3 * std::size_t{count});
  for (std::uint32_t t = 0; t < count; ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vector3& at = caster.corner(t, static_cast<int>(k));
      corners.push_back({{at.x(), at.y(), at.z()}, 3 * t + k});
    }
  }
  std::sort(corners.begin(), corners.end(),
            [](const Corner& a, const Corner& b) { return a.place < b.place; });
  Triangles numbered;
  numbered.corners.resize(count);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i > 0 && corners[i].place != corners[i - 1].place) ++numbered.points;
    numbered.corners[corners[i].slot / 3][corners[i].slot % 3] = numbered.points;
  }
  ++numbered.points;
  return numbered;
}

/// One of a triangle's edges, given as the edge from its lower to its higher corner.
struct Edge {
  std::uint32_t low, high, triangle;
  bool forward;      ///< the triangle runs along it from low to high
  double angle = 0;  ///< of the triangle about the edge, where more than two meet
  [[nodiscard]] auto corners() const { return std::array{low, high}; }
};

/// The boundary of free space in parts: triangles are joined where free space continues between
/// them.
struct Parts {
  Numbers of;  ///< a part's number for each triangle
  std::vector<char> closed;
};

/// Sorts triangles by angle about the edge that they share, so that neighbours in angle bound one
/// wedge.
void sort_about_edge(const Caster& caster, const Triangles& triangles, std::span<Edge> edges) {
  const auto place = [&](const Edge& edge, std::uint32_t point) {
    const Triangle& corners = triangles.corners[edge.triangle];
    const auto which = std::find(corners.begin(), corners.end(), point) - corners.begin();
    return caster.corner(edge.triangle, static_cast<int>(which));
  };
  const Vector3 from = place(edges[0], edges[0].low);
  const SupportPlane across =
      plane_with_normal(from, (place(edges[0], edges[0].high) - from).normalized());
  for (Edge& edge : edges) {
    const Triangle& corners = triangles.corners[edge.triangle];
    const std::uint32_t apex = *std::find_if(corners.begin(), corners.end(), [&](std::uint32_t c) {
      return c != edge.low && c != edge.high;
    });
    const Vector3 arm = place(edge, apex) - from;
    edge.angle = std::atan2(arm.dot(across.v), arm.dot(across.u));
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return a.angle != b.angle ? a.angle < b.angle : a.triangle < b.triangle;
  });
}

class PartFinder {
 public:
  PartFinder(const Caster& caster, const Triangles& triangles)
      : caster_(caster), triangles_(triangles), groups_(triangles.corners.size()) {}

  Parts find() {
    std::vector<Edge> edges = all_edges();
    std::vector<char> open(triangles_.corners.size(), 0);
    for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
      while (end < edges.size() && edges[end].corners() == edges[i].corners()) ++end;
      const std::span<Edge> shared(&edges[i], end - i);
      if (shared.size() > 2) sort_about_edge(caster_, triangles_, shared);
      if (join_about_edge(shared)) continue;
      for (const Edge& edge : shared) open[edge.triangle] = 1;
    }
    return number(open);
  }

 private:
  const Caster& caster_;
  const Triangles& triangles_;
  Groups groups_;

  [[nodiscard]] std::vector<Edge> all_edges() const {
    std::vector<Edge> edges;
    edges.reserve(3 * triangles_.corners.size());
    for (std::uint32_t t = 0; t < triangles_.corners.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = triangles_.corners[t][k];
        const std::uint32_t to = triangles_.corners[t][(k + 1) % 3];
        if (from != to) edges.push_back({std::min(from, to), std::max(from, to), t, from < to});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return a.corners() != b.corners() ? a.corners() < b.corners() : a.triangle < b.triangle;
    });
    return edges;
  }

  /// A triangle that runs along the edge has free space in the direction of growing angles, and the
  /// next triangle bounds it. False where some triangle has no such partner.
  bool join_about_edge(std::span<const Edge> edges) {
    if (edges.size() % 2 != 0) return false;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Edge& next = edges[(i + 1) % edges.size()];
      if (edges[i].forward == next.forward) return false;
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (!edges[i].forward) continue;
      groups_.join(edges[i].triangle, edges[(i + 1) % edges.size()].triangle);
    }
    return true;
  }

  Parts number(const std::vector<char>& open) {
    Parts parts;
    parts.of.resize(triangles_.corners.size());
    for (std::uint32_t t = 0; t < parts.of.size(); ++t) {
      const std::uint32_t first = groups_.of(t);
      if (first == t) {
        parts.of[t] = static_cast<std::uint32_t>(parts.closed.size());
        parts.closed.push_back(1);
      }
      parts.of[t] = parts.of[first];
      if (open[t] != 0) parts.closed[parts.of[t]] = 0;
    }
    return parts;
  }
};

/// Marks the parts that enclose a hollow: closed, with the solid outside.
std::vector<char> hollow_parts(const Caster& caster, const Parts& parts) {
  const Vector3& middle = caster.corner(0, 0);
  std::vector<double> volume(parts.closed.size(), 0);
  for (std::uint32_t t = 0; t < parts.of.size(); ++t) {
    volume[parts.of[t]] += (caster.corner(t, 0) - middle)
                               .cross(caster.corner(t, 1) - middle)
                               .dot(caster.corner(t, 2) - middle);
  }
  std::vector<char> hollow(volume.size(), 0);
  for (std::size_t part = 0; part < hollow.size(); ++part) {
    hollow[part] = parts.closed[part] != 0 && volume[part] < 0 ? 1 : 0;
  }
  return hollow;
}

/// Marks what lies in a hollow too: a ray from there meets the hollow's wall an odd number of
/// times.
void add_enclosed(const Caster& caster, const Parts& parts, std::vector<char>& left_out) {
  const std::vector<char> hollow = left_out;
  std::vector<char> seen(left_out.size(), 0);
  const Vector3 direction = Vector3(0.3717, -0.5311, 0.7613).normalized();
  Column column;
  for (std::uint32_t t = 0; t < parts.of.size(); ++t) {
    if (seen[parts.of[t]] != 0) continue;
    seen[parts.of[t]] = 1;
    if (hollow[parts.of[t]] != 0) continue;
    const Vector3 at = (caster.corner(t, 0) + caster.corner(t, 1) + caster.corner(t, 2)) / 3;
    const SupportPlane plane = plane_with_normal(at, direction);
    const PlaneCoordinates place = project_on_plane(plane, at);
    caster.cast(plane, place.eta, place.omega, column);
    Numbers met;
    for (const Crossing& crossing : column.crossings) {
      const std::uint32_t part = parts.of[crossing.triangle];
      if (crossing.depth > 0 && hollow[part] != 0) met.push_back(part);
    }
    std::sort(met.begin(), met.end());
    for (std::size_t i = 0, end = 0; i < met.size(); i = end) {
      while (end < met.size() && met[end] == met[i]) ++end;
      if ((end - i) % 2 == 1) left_out[parts.of[t]] = 1;
    }
  }
}

}  // namespace

std::optional<OuterSurface> without_sealed_voids(const Caster& caster) {
  const auto count = static_cast<std::uint32_t>(caster.solid_count());
  if (count == 0) return std::nullopt;
  const Triangles triangles = number_corners(caster, count);
  const Parts parts = PartFinder(caster, triangles).find();
  std::vector<char> left_out = hollow_parts(caster, parts);
  if (std::find(left_out.begin(), left_out.end(), 1) == left_out.end()) return std::nullopt;
  add_enclosed(caster, parts, left_out);

  OuterSurface filled;
  filled.vertices.resize(triangles.points);
  for (std::uint32_t t = 0; t < count; ++t) {
    if (left_out[parts.of[t]] != 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      filled.vertices[triangles.corners[t][k]] = caster.corner(t, static_cast<int>(k));
    }
    filled.triangles.push_back(triangles.corners[t]);
  }
  filled.solid_count = filled.triangles.size();
  // A solid cannot bound nothing but hollows. If rounding says so, nothing is left out.
  if (filled.solid_count == 0) return std::nullopt;
  return filled;
}

}  // namespace spm::baker
