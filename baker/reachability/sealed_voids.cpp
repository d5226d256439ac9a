// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/reachability/sealed_voids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "baker/base/groups.hpp"
#include "baker/mesh/mesh_edges.hpp"
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

/// The boundary of free space in parts: triangles are joined where free space continues between
/// them.
struct Parts {
  Numbers of;  ///< a part's number for each triangle
  std::vector<char> closed;
};

/// The users of an edge by angle about it, so that neighbours in angle bound one wedge.
std::vector<HalfEdge> sorted_about(const Caster& caster, const Triangles& triangles,
                                   std::span<const HalfEdge> edges) {
  const auto place = [&](const HalfEdge& edge, std::uint32_t point) {
    const Triangle& corners = triangles.corners[edge.triangle];
    const auto which = std::find(corners.begin(), corners.end(), point) - corners.begin();
    return caster.corner(edge.triangle, static_cast<int>(which));
  };
  const Vector3 from = place(edges[0], edges[0].low);
  const SupportPlane across =
      plane_with_normal(from, (place(edges[0], edges[0].high) - from).normalized());
  std::vector<std::pair<double, HalfEdge>> angles;
  for (const HalfEdge& edge : edges) {
    const Vector3 arm = place(edge, tip_of(triangles.corners[edge.triangle], edge)) - from;
    angles.emplace_back(std::atan2(arm.dot(across.v), arm.dot(across.u)), edge);
  }
  std::sort(angles.begin(), angles.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second.triangle < b.second.triangle;
  });
  std::vector<HalfEdge> sorted;
  for (const auto& [angle, edge] : angles) sorted.push_back(edge);
  return sorted;
}

class PartFinder {
 public:
  PartFinder(const Caster& caster, const Triangles& triangles)
      : caster_(caster), triangles_(triangles), groups_(triangles.corners.size()) {}

  Parts find() {
    std::vector<char> open(triangles_.corners.size(), 0);
    for_each_edge(sorted_edges(triangles_.corners), [&](std::span<const HalfEdge> users) {
      if (users[0].low == users[0].high) return;
      const bool joined = users.size() > 2
                              ? join_about_edge(sorted_about(caster_, triangles_, users))
                              : join_about_edge(users);
      for (const HalfEdge& user : users) open[user.triangle] |= joined ? 0 : 1;
    });
    return number(open);
  }

 private:
  const Caster& caster_;
  const Triangles& triangles_;
  Groups groups_;

  /// A triangle that runs along the edge has free space in the direction of growing angles, and the
  /// next triangle bounds it. False where some triangle has no such partner.
  bool join_about_edge(std::span<const HalfEdge> edges) {
    if (edges.size() % 2 != 0) return false;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const HalfEdge& next = edges[(i + 1) % edges.size()];
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
