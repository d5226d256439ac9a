// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_lids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "baker/base/groups.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/triangle_height.hpp"

namespace spm::baker {
namespace {

/// A surface is a solid's where lids close it with no more than this share of its area.
constexpr double most_lids = 0.05;
/// Of longer loops the smallest corners are cut off first, since time grows by the third power.
constexpr std::size_t most_corners = 400;

using Loop = std::vector<std::uint32_t>;

[[nodiscard]] double area_of(std::span<const Vector3> points, std::uint32_t a, std::uint32_t b,
                             std::uint32_t c) {
  return triangle_area(points[a], points[b], points[c]);
}

/// The open surfaces of a mesh: patches of neighbours that are open, joined where they meet.
class OpenSurfaces {
 public:
  explicit OpenSurfaces(const std::vector<Triangle>& triangles)
      : edges_(sorted_edges(triangles)), patches_(triangles.size()), surfaces_(triangles.size()) {
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

/// Cuts off the corners of a loop whose triangles are smallest, until few enough are left.
void cut_corners(std::span<const Vector3> points, Loop& loop, std::vector<Triangle>& lid) {
  while (loop.size() > most_corners) {
    // Every second corner that is smaller than most.
    std::vector<double> areas(loop.size());
    for (std::size_t i = 0; i < loop.size(); ++i) {
      areas[i] = area_of(points, loop[(i + loop.size() - 1) % loop.size()], loop[i],
                         loop[(i + 1) % loop.size()]);
    }
    std::vector<double> sorted = areas;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    std::size_t left = loop.size() - most_corners;
    Loop kept;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const bool after_kept = i > 0 && kept.back() == loop[i - 1];
      if (left == 0 || !after_kept || i + 1 == loop.size() || areas[i] > *middle) {
        kept.push_back(loop[i]);
        continue;
      }
      lid.push_back({loop[i - 1], loop[i], loop[i + 1]});
      --left;
    }
    loop = std::move(kept);
  }
}

/// Spans a loop by the triangles of the least area in all.
void span_loop(std::span<const Vector3> points, const Loop& loop, std::vector<Triangle>& lid) {
  const std::size_t count = loop.size();
  const auto at = [count](std::size_t i, std::size_t k) { return i * count + k; };
  std::vector<double> least(count * count, 0);
  std::vector<std::size_t> between(count * count, 0);
  for (std::size_t way = 2; way < count; ++way) {
    for (std::size_t i = 0; i + way < count; ++i) {
      const std::size_t k = i + way;
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t m = i + 1; m < k; ++m) {
        const double area =
            least[at(i, m)] + least[at(m, k)] + area_of(points, loop[i], loop[m], loop[k]);
        if (area >= best) continue;
        best = area;
        between[at(i, k)] = m;
      }
      least[at(i, k)] = best;
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> left{{0, count - 1}};
  while (!left.empty()) {
    const auto [i, k] = left.back();
    left.pop_back();
    if (k < i + 2) continue;
    const std::size_t m = between[at(i, k)];
    lid.push_back({loop[i], loop[m], loop[k]});
    left.emplace_back(i, m);
    left.emplace_back(m, k);
  }
}

[[nodiscard]] Hole hole_of(std::span<const Vector3> points, const Loop& loop,
                           std::span<const Triangle> lid) {
  Hole hole;
  hole.edges = loop.size();
  for (const std::uint32_t vertex : loop) {
    hole.middle += points[vertex] / static_cast<double>(loop.size());
  }
  for (const auto& [a, b, c] : lid) hole.area += area_of(points, a, b, c);
  return hole;
}

}  // namespace

Lids add_lids(std::span<const Vector3> points, OpenAs open_as, std::vector<Triangle>& triangles) {
  OpenSurfaces surfaces(triangles);
  std::map<std::uint32_t, double> areas;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    areas[surfaces.of(t)] += area_of(points, a, b, c);
  }
  Lids found;
  std::vector<Triangle> all;
  std::set<std::uint32_t> sheets;
  for (const auto& [surface, border] : surfaces.borders()) {
    std::vector<Triangle> lids;
    std::vector<Hole> closed;
    double area = 0;
    for (Loop loop : border ? loops_of(*border) : std::vector<Loop>()) {
      const std::size_t before = lids.size();
      const Loop whole = loop;
      cut_corners(points, loop, lids);
      span_loop(points, loop, lids);
      closed.push_back(hole_of(points, whole, std::span(lids).subspan(before)));
      area += closed.back().area;
    }
    const bool small = open_as == OpenAs::solid || area <= most_lids * areas[surface];
    if (!border || open_as == OpenAs::sheet || !small) {
      sheets.insert(surface);
      continue;
    }
    all.insert(all.end(), lids.begin(), lids.end());
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
