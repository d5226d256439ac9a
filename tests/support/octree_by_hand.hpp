// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/field/distance_octree.hpp"
#include "common/field/triangle_cluster.hpp"
#include "formats/asset/asset.hpp"

namespace spm::test {

/// A triangle of a cluster.
struct TriangleByHand {
  std::array<std::array<std::int32_t, 3>, 3> corners{};  ///< steps of the lattice
  FeatureSides sides = 0;
  bool bare = false;  ///< no tile shows it
};

struct ClusterKind {
  bool caps = false;
  bool exact = false;
  std::uint32_t shift = 0;
};

/// Adds a cluster of one to eight triangles, whose corners differ by whole shifted steps. Its
/// number.
inline std::uint32_t add_cluster(OctreeData& octree, const std::vector<TriangleByHand>& triangles,
                                 const ClusterKind& kind = {}) {
  std::array<std::int32_t, 3> base;
  base.fill(std::numeric_limits<std::int32_t>::max());
  for (const TriangleByHand& triangle : triangles) {
    for (const auto& corner : triangle.corners) {
      for (std::size_t axis = 0; axis < 3; ++axis) base[axis] = std::min(base[axis], corner[axis]);
    }
  }
  std::array<std::uint32_t, cluster_words> cluster{};
  std::memcpy(cluster.data(), base.data(), sizeof base);
  cluster[3] = cluster_flags(static_cast<std::uint32_t>(triangles.size()), kind.shift, kind.caps,
                             kind.exact);
  std::array<std::uint16_t, 10 * cluster_size> numbers{};
  for (std::size_t i = 0; i < cluster_size; ++i) {
    const TriangleByHand& triangle = triangles.at(i < triangles.size() ? i : 0);
    if (i < triangles.size() && triangle.bare) cluster[3] |= 1U << (16U + i);
    for (std::size_t k = 0; k < 9; ++k) {
      const std::int32_t number = (triangle.corners[k / 3][k % 3] - base[k % 3]) >> kind.shift;
      if (number > 0xFFFF) throw std::invalid_argument("a cluster of triangles too far apart");
      numbers[k * cluster_size + i] = static_cast<std::uint16_t>(number);
    }
    numbers[9 * cluster_size + i] = triangle.sides;
  }
  std::memcpy(cluster.data() + cluster_head, numbers.data(), sizeof numbers);
  octree.clusters.insert(octree.clusters.end(), cluster.begin(), cluster.end());
  return static_cast<std::uint32_t>(octree.clusters.size() / cluster_words - 1);
}

/// The word of a root; `unit` is its first, or of a `far` one its distance.
[[nodiscard]] constexpr std::uint32_t root_word(OctreeKind kind, std::uint32_t unit) {
  return static_cast<std::uint32_t>(kind) | unit << 4U;
}

/// The kinds of octants that are all of one kind, except those named.
[[nodiscard]] inline std::uint32_t octant_kinds(
    OctreeKind rest, std::initializer_list<std::pair<std::uint32_t, OctreeKind>> named = {}) {
  std::uint32_t kinds = static_cast<std::uint32_t>(rest) * 0x11111111U;
  for (const auto& [octant, kind] : named) {
    kinds &= ~(15U << (4 * octant));
    kinds |= static_cast<std::uint32_t>(kind) << (4 * octant);
  }
  return kinds;
}

[[nodiscard]] constexpr std::uint32_t list_entry(std::uint32_t cluster, std::uint32_t bound) {
  return cluster | bound << 24U;
}

/// The second word of a list.
[[nodiscard]] constexpr std::uint32_t list_counts(std::uint32_t clusters, std::uint32_t caps,
                                                  ListSide side = ListSide::surface) {
  return clusters | caps << 12U | static_cast<std::uint32_t>(side) << 24U;
}

/// Adds a list of clusters, and gives the two words of its unit.
inline std::array<std::uint32_t, 2> add_list(OctreeData& octree,
                                             const std::vector<std::uint32_t>& clusters,
                                             const std::vector<std::uint32_t>& caps = {},
                                             ListSide side = ListSide::surface) {
  const auto first = static_cast<std::uint32_t>(octree.lists.size());
  octree.lists.insert(octree.lists.end(), clusters.begin(), clusters.end());
  octree.lists.insert(octree.lists.end(), caps.begin(), caps.end());
  return {first, list_counts(static_cast<std::uint32_t>(clusters.size() + caps.size()),
                             static_cast<std::uint32_t>(caps.size()), side)};
}

/// The words of a chain of this many splits, each the last octant of the one before; the last
/// octant of the last one is `end`. Its first unit is 0.
[[nodiscard]] inline std::vector<std::uint32_t> chain_of_splits(int splits, OctreeKind rest,
                                                                OctreeKind end) {
  std::vector<std::uint32_t> units;
  for (int split = 1; split <= splits; ++split) {
    units.push_back(static_cast<std::uint32_t>(split));
    units.push_back(octant_kinds(rest, {{7, split == splits ? end : OctreeKind::split}}));
  }
  return units;
}

}  // namespace spm::test
