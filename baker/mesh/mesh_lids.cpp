// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_lids.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "baker/base/groups.hpp"
#include "baker/mesh/loop_span.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/triangle_height.hpp"

namespace spm::baker {
namespace {

/// A surface is a solid's where lids close it with no more than this share of its area.
constexpr double most_lids = 0.05;

[[nodiscard]] double area_of(std::span<const Vector3> points, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return triangle_area(points[a], points[b], points[c]);
}

/// How far vertices lie from a plane through them at most, nearly.
[[nodiscard]] double flatness(std::span<const Vector3> points, const std::vector<Triangle>& part) {
  Vector3 middle = Vector3::Zero();
  for (const Triangle& triangle : part) {
    for (const std::uint32_t corner : triangle) {
      middle += points[corner] / (3 * static_cast<double>(part.size()));
    }
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Triangle& triangle : part) {
    for (const std::uint32_t corner : triangle) {
      const Vector3 from = points[corner] - middle;
      spread += from * from.transpose();
    }
  }
  const Vector3 normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  double most = 0;
  for (const Triangle& triangle : part) {
    for (const std::uint32_t corner : triangle) {
      most = std::max(most, std::abs(normal.dot(points[corner] - middle)));
    }
  }
  return most;
}

/// By triangle, whether its part lies in a plane, within a distance, m.
[[nodiscard]] std::vector<char> flat_parts(std::span<const Vector3> points, double within,
                                           const std::vector<Triangle>& triangles,
                                           const std::vector<HalfEdge>& edges) {
  Groups parts = parts_over(edges, triangles.size());
  std::map<std::uint32_t, std::vector<Triangle>> members;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    members[parts.of(t)].push_back(triangles[t]);
  }
  std::vector<char> flat(triangles.size(), 0);
  for (const auto& [part, own] : members) flat[part] = flatness(points, own) <= within ? 1 : 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) flat[t] = flat[parts.of(t)];
  return flat;
}

/// The open surfaces of a mesh: patches of neighbours that are open, or flat, joined where they
/// meet.
class OpenSurfaces {
 public:
  OpenSurfaces(const std::vector<Triangle>& triangles, std::vector<HalfEdge> edges,
               const std::vector<char>& flat)
      : edges_(std::move(edges)), patches_(triangles.size()), surfaces_(triangles.size()) {
    for_each_edge(edges_, [&](std::span<const HalfEdge> users) {
      if (users.size() == 2) patches_.join(users[0].triangle, users[1].triangle);
    });
    std::vector<char> open(triangles.size(), 0);
    for_each_edge(edges_, [&](std::span<const HalfEdge> users) {
      std::map<std::uint32_t, int> balances;
      for (const HalfEdge& user : users) {
        balances[patches_.of(user.triangle)] += user.forward ? 1 : -1;
      }
      for (const auto& [patch, balance] : balances) {
        if (balance != 0) open[patch] = 1;
      }
    });
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      if (flat[t] != 0) open[patches_.of(t)] = 1;
      if (open[patches_.of(t)] != 0) surfaces_.join(patches_.of(t), t);
    }
    for_each_edge(edges_, [&](std::span<const HalfEdge> users) {
      std::optional<std::uint32_t> first;
      for (const HalfEdge& user : users) {
        if (open[patches_.of(user.triangle)] == 0) continue;
        if (first) surfaces_.join(*first, user.triangle);
        first = user.triangle;
      }
    });
    open_ = std::move(open);
  }

  /// Edges as a lid runs through them: the other way.
  using Border = std::vector<std::array<std::uint32_t, 2>>;

  /// The border of each surface; none where it ends in more than single edges.
  [[nodiscard]] std::map<std::uint32_t, std::optional<Border>> borders() {
    std::map<std::uint32_t, std::optional<Border>> borders;
    for_each_edge(edges_, [&](std::span<const HalfEdge> users) {
      std::map<std::uint32_t, int> balances;
      for (const HalfEdge& user : users) {
        if (open_[patches_.of(user.triangle)] == 0) continue;
        balances[surfaces_.of(user.triangle)] += user.forward ? 1 : -1;
      }
      for (const auto& [surface, balance] : balances) {
        if (balance == 0) continue;
        std::optional<Border>& border = borders.try_emplace(surface, Border()).first->second;
        if (std::abs(balance) > 1) border.reset();
        if (!border) continue;
        border->push_back(balance > 0 ? std::array{users[0].high, users[0].low}
                                      : std::array{users[0].low, users[0].high});
      }
    });
    return borders;
  }

  [[nodiscard]] std::uint32_t of(std::uint32_t triangle) { return surfaces_.of(triangle); }
  /// The same of what is open, and the patch of what is not.
  [[nodiscard]] std::uint32_t part_of(std::uint32_t triangle) {
    const std::uint32_t patch = patches_.of(triangle);
    return open_[patch] != 0 ? of(triangle) : patch;
  }

 private:
  std::vector<HalfEdge> edges_;
  Groups patches_, surfaces_;
  std::vector<char> open_;  ///< by patch
};

/// Loops that meet no vertex twice, of edges that lead in and out of each vertex equally often.
[[nodiscard]] std::vector<Loop> loops_of(std::span<const std::array<std::uint32_t, 2>> edges) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> next;
  for (const auto& [from, to] : edges) next[from].push_back(to);
  std::vector<Loop> loops;
  for (auto& [start, unused] : next) {
    while (!unused.empty()) {
      Loop way{start};
      std::map<std::uint32_t, std::size_t> place{{start, 0}};
      while (!way.empty()) {
        auto& ways = next[way.back()];
        if (ways.empty()) break;
        const std::uint32_t to = ways.back();
        ways.pop_back();
        const auto [met, fresh] = place.try_emplace(to, way.size());
        if (fresh) {
          way.push_back(to);
          continue;
        }
        const auto first = way.begin() + static_cast<std::ptrdiff_t>(met->second);
        Loop loop(first, way.end());
        for (const std::uint32_t vertex : loop) {
          if (vertex != to) place.erase(vertex);
        }
        way.erase(first + 1, way.end());
        loops.push_back(std::move(loop));
        if (way.size() == 1) break;
      }
    }
  }
  return loops;
}

[[nodiscard]] Hole hole_of(std::span<const Vector3> points, const Loop& loop,
                           std::span<const Triangle> lid) {
  Hole hole;
  hole.edges = loop.size();
  for (const std::uint32_t vertex : loop) {
    hole.middle += points[vertex] / static_cast<double>(loop.size());
  }
  for (const Triangle& triangle : lid) hole.area += area_of(points, triangle);
  return hole;
}

}  // namespace

Lids add_lids(std::span<const Vector3> points, OpenAs open_as, double flat_within,
              std::vector<Triangle>& triangles) {
  std::vector<HalfEdge> edges = sorted_edges(triangles);
  const std::vector<char> flat = flat_parts(points, flat_within, triangles, edges);
  OpenSurfaces surfaces(triangles, std::move(edges), flat);
  std::map<std::uint32_t, double> areas;
  std::set<std::uint32_t> sheets;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    areas[surfaces.of(t)] += area_of(points, triangles[t]);
    if (flat[t] != 0) sheets.insert(surfaces.of(t));
  }
  Lids found;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) found.parts.push_back(surfaces.part_of(t));
  std::vector<Triangle> all;
  for (const auto& [surface, border] : surfaces.borders()) {
    if (sheets.contains(surface)) continue;
    std::vector<Triangle> lids;
    std::vector<Hole> closed;
    double area = 0;
    for (const Loop& loop : border ? loops_of(*border) : std::vector<Loop>()) {
      const std::size_t before = lids.size();
      span_loop(points, loop, lids);
      closed.push_back(hole_of(points, loop, std::span(lids).subspan(before)));
      area += closed.back().area;
    }
    const bool small = open_as == OpenAs::solid || area <= most_lids * areas[surface];
    if (!border || open_as == OpenAs::sheet || !small) {
      sheets.insert(surface);
      continue;
    }
    all.insert(all.end(), lids.begin(), lids.end());
    found.parts.insert(found.parts.end(), lids.size(), surface);
    found.holes.insert(found.holes.end(), closed.begin(), closed.end());
  }
  found.sheets = static_cast<std::uint32_t>(sheets.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    found.sheet.push_back(sheets.contains(surfaces.of(t)) ? 1 : 0);
  }
  triangles.insert(triangles.end(), all.begin(), all.end());
  found.added = all.size();
  found.sheet.resize(triangles.size(), 0);
  std::stable_sort(found.holes.begin(), found.holes.end(),
                   [](const Hole& a, const Hole& b) { return a.area > b.area; });
  return found;
}

}  // namespace spm::baker
