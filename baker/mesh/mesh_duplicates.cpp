// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_duplicates.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

namespace spm::baker {
namespace {

struct Corners {
  Triangle sorted;
  int sense;  ///< 1 where the triangle runs through them in ascending order, else -1
};

[[nodiscard]] Corners sorted_corners(const Triangle& triangle) {
  Corners corners{triangle, -1};
  std::sort(corners.sorted.begin(), corners.sorted.end());
  const auto at = static_cast<std::size_t>(
      std::find(triangle.begin(), triangle.end(), corners.sorted[0]) - triangle.begin());
  if (triangle[(at + 1) % 3] == corners.sorted[1]) corners.sense = 1;
  return corners;
}

/// Triangles to keep, and those in doubt.
struct Choice {
  std::vector<char> keep;
  std::vector<std::uint32_t> walls;   ///< the first of each pair of triangles that face each other
  std::vector<std::uint32_t> extras;  ///< one that faces the same way for each that is kept
};

[[nodiscard]] Choice choose(const std::vector<Triangle>& triangles) {
  std::vector<Corners> corners;
  corners.reserve(triangles.size());
  for (const Triangle& triangle : triangles) corners.push_back(sorted_corners(triangle));
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0U);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(corners[a].sorted, a) < std::tie(corners[b].sorted, b);
  });
  Choice choice;
  choice.keep.assign(triangles.size(), 0);
  for (std::size_t begin = 0; begin < order.size();) {
    int balance = 0;
    std::size_t end = begin;
    for (; end < order.size() && corners[order[end]].sorted == corners[order[begin]].sorted;
         ++end) {
      balance += corners[order[end]].sense;
    }
    if (balance == 0) choice.walls.push_back(order[begin]);
    bool kept = false;
    for (std::size_t i = begin; i < end && balance != 0; ++i) {
      if ((corners[order[i]].sense > 0) != (balance > 0)) continue;
      if (kept) {
        if (std::abs(balance) > 1) choice.extras.push_back(order[i]);
        break;
      }
      choice.keep[order[i]] = 1;
      kept = true;
    }
    begin = end;
  }
  return choice;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

template <class Visit>
void for_each_edge(const Triangle& triangle, Visit visit) {
  for (std::size_t k = 0; k < 3; ++k) visit(Edge(std::minmax(triangle[k], triangle[(k + 1) % 3])));
}

/// How many triangles use each edge of some of them.
using EdgeUses = std::map<Edge, std::uint32_t>;

/// The edges that are open without a group of triangles, less those that it opens. Where nothing
/// but the group and so many copies of it meet, nothing opens.
[[nodiscard]] std::int64_t closed_by(const EdgeUses& group, const EdgeUses& kept,
                                     std::uint32_t copies) {
  std::int64_t closed = 0;
  for (const auto& [edge, uses] : group) {
    const std::uint32_t others = kept.at(edge);
    if (others == copies * uses) continue;
    closed += static_cast<std::int64_t>(others % 2) - (others + uses) % 2;
  }
  return closed;
}

/// Whether a group of triangles ends where nothing else is.
[[nodiscard]] bool ends_freely(const EdgeUses& group, const EdgeUses& kept) {
  return std::any_of(group.begin(), group.end(), [&](const auto& side) {
    return side.second % 2 != 0 && kept.at(side.first) == 0;
  });
}

/// Keeps the connected groups of triangles in doubt without which more edges would be open, and
/// those that end freely. Of each so many copies are kept already.
void keep_closing(const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& doubted,
                  std::uint32_t copies, std::vector<char>& keep) {
  EdgeUses kept;
  std::map<Edge, std::vector<std::size_t>> users;
  for (std::size_t i = 0; i < doubted.size(); ++i) {
    for_each_edge(triangles[doubted[i]], [&](const Edge& edge) {
      kept[edge] = 0;
      users[edge].push_back(i);
    });
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (keep[i] == 0) continue;
    for_each_edge(triangles[i], [&](const Edge& edge) {
      if (const auto found = kept.find(edge); found != kept.end()) ++found->second;
    });
  }
  std::vector<char> seen(doubted.size(), 0);
  for (std::size_t seed = 0; seed < seen.size(); ++seed) {
    if (seen[seed] != 0) continue;
    seen[seed] = 1;
    std::vector<std::size_t> group{seed};
    EdgeUses uses;
    for (std::size_t next = 0; next < group.size(); ++next) {
      for_each_edge(triangles[doubted[group[next]]], [&](const Edge& edge) {
        ++uses[edge];
        for (const std::size_t other : users[edge]) {
          if (seen[other] == 0) group.push_back(other);
          seen[other] = 1;
        }
      });
    }
    const char stays = closed_by(uses, kept, copies) > 0 || ends_freely(uses, kept) ? 1 : 0;
    for (const std::size_t member : group) keep[doubted[member]] = stays;
  }
}

}  // namespace

Counted drop_duplicates(std::vector<Triangle>& triangles) {
  Choice choice = choose(triangles);
  const bool two_sided = 4 * choice.walls.size() > triangles.size();
  if (two_sided) {
    for (const std::uint32_t wall : choice.walls) choice.keep[wall] = 1;
  } else {
    keep_closing(triangles, choice.walls, 0, choice.keep);
  }
  keep_closing(triangles, choice.extras, 1, choice.keep);
  Counted dropped;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (choice.keep[i] != 0) {
      triangles[kept++] = triangles[i];
    } else {
      dropped.add(1, triangles[i][0]);
    }
  }
  triangles.resize(kept);
  return dropped;
}

}  // namespace spm::baker
