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
  std::vector<std::uint32_t> extras;  ///< triangles that face the same way as one that is kept
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
    int wanted = std::abs(balance);
    for (std::size_t i = begin; i < end && wanted > 0; ++i) {
      if ((corners[order[i]].sense > 0) != (balance > 0)) continue;
      if (wanted == std::abs(balance)) {
        choice.keep[order[i]] = 1;
      } else {
        choice.extras.push_back(order[i]);
      }
      --wanted;
    }
    begin = end;
  }
  return choice;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

template <class Visit>
void for_each_side(const Triangle& triangle, Visit visit) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t from = triangle[k];
    const std::uint32_t to = triangle[(k + 1) % 3];
    visit(Edge(std::minmax(from, to)), from < to ? 1 : -1);
  }
}

/// Keeps the connected groups of extras without which more edges would be open.
void keep_needed_extras(const std::vector<Triangle>& triangles, Choice& choice) {
  std::map<Edge, int> without;  // balance of directions at the extras' edges
  std::map<Edge, std::vector<std::size_t>> users;
  for (std::size_t i = 0; i < choice.extras.size(); ++i) {
    for_each_side(triangles[choice.extras[i]], [&](const Edge& edge, int) {
      without[edge] = 0;
      users[edge].push_back(i);
    });
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (choice.keep[i] == 0) continue;
    for_each_side(triangles[i], [&](const Edge& edge, int direction) {
      if (const auto found = without.find(edge); found != without.end()) found->second += direction;
    });
  }
  std::vector<char> seen(choice.extras.size(), 0);
  for (std::size_t seed = 0; seed < seen.size(); ++seed) {
    if (seen[seed] != 0) continue;
    seen[seed] = 1;
    std::vector<std::size_t> group{seed};
    std::map<Edge, int> change;
    for (std::size_t next = 0; next < group.size(); ++next) {
      for_each_side(triangles[choice.extras[group[next]]], [&](const Edge& edge, int direction) {
        change[edge] += direction;
        for (const std::size_t other : users[edge]) {
          if (seen[other] == 0) group.push_back(other);
          seen[other] = 1;
        }
      });
    }
    int opened = 0;
    for (const auto& [edge, direction] : change) {
      opened += std::abs(without[edge]) - std::abs(without[edge] + direction);
    }
    for (const std::size_t member : group) {
      choice.keep[choice.extras[member]] = opened > 0 ? 1 : 0;
    }
  }
}

}  // namespace

std::size_t drop_duplicates(std::vector<Triangle>& triangles) {
  Choice choice = choose(triangles);
  const bool two_sided = 4 * choice.walls.size() > triangles.size();
  for (const std::uint32_t wall : choice.walls) choice.keep[wall] = two_sided ? 1 : 0;
  keep_needed_extras(triangles, choice);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (choice.keep[i] != 0) triangles[kept++] = triangles[i];
  }
  const std::size_t dropped = triangles.size() - kept;
  triangles.resize(kept);
  return dropped;
}

}  // namespace spm::baker
