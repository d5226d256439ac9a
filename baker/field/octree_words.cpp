// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/octree_words.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <tuple>

#include "baker/base/bake_error.hpp"
#include "common/field/triangle_cluster.hpp"

namespace spm::baker {

namespace {

constexpr std::uint32_t no_cluster = 0xFFFFFFFF;

template <class Visit>
void each_leaf(const OctreeNode& node, const Visit& visit) {
  if (node.octants) {
    for (const OctreeNode& octant : *node.octants) each_leaf(octant, visit);
  } else {
    visit(node);
  }
}

Vector3 middle_of(const LatticeTriangle& triangle) {
  return (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3;
}

/// Groups triangles of one kind, eight each, by halving along the longest side again and again.
void group(const LatticeSurface& surface, std::vector<std::uint32_t>& triangles, std::size_t first,
           std::size_t last, std::vector<std::vector<std::uint32_t>>& groups) {
  if (last - first <= cluster_size) {
    if (first < last) {
      groups.emplace_back(triangles.begin() + static_cast<std::ptrdiff_t>(first),
                          triangles.begin() + static_cast<std::ptrdiff_t>(last));
    }
    return;
  }
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (std::size_t i = first; i < last; ++i) {
    const Vector3 middle = middle_of(surface.triangles[triangles[i]]);
    low = low.cwiseMin(middle);
    high = high.cwiseMax(middle);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  // Whole clusters on the left.
  const std::size_t clusters = (last - first + cluster_size - 1) / cluster_size;
  const std::size_t split = first + clusters / 2 * cluster_size;
  const auto begin = triangles.begin();
  std::nth_element(begin + static_cast<std::ptrdiff_t>(first),
                   begin + static_cast<std::ptrdiff_t>(split),
                   begin + static_cast<std::ptrdiff_t>(last), [&](auto a, auto b) {
                     const double x = middle_of(surface.triangles[a])[axis];
                     const double y = middle_of(surface.triangles[b])[axis];
                     return x != y ? x < y : a < b;
                   });
  group(surface, triangles, first, split, groups);
  group(surface, triangles, split, last, groups);
}

/// Appends a cluster; false where its box spans more than 16 bits.
bool append_cluster(const LatticeSurface& surface, const std::vector<std::uint32_t>& triangles,
                    std::vector<std::uint32_t>& words) {
  const LatticeTriangle& any = surface.triangles[triangles.front()];
  LatticePoint low = any.steps[0], high = low;
  bool exact = false;
  for (const std::uint32_t triangle : triangles) {
    exact = exact || surface.triangles[triangle].exact;
    for (const LatticePoint& corner : surface.triangles[triangle].steps) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], corner[axis]);
        high[axis] = std::max(high[axis], corner[axis]);
      }
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if ((high[axis] - low[axis]) >> any.shift > 65535) return false;
  }
  std::array<std::uint32_t, cluster_words> cluster{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto base = static_cast<std::int32_t>(low[axis]);
    std::memcpy(&cluster[axis], &base, 4);
  }
  cluster[3] =
      cluster_flags(static_cast<std::uint32_t>(triangles.size()), any.shift, any.cap, exact);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    cluster[3] |= surface.triangles[triangles[i]].bare ? 1U << (16 + i) : 0U;
  }
  for (std::size_t i = 0; i < cluster_size; ++i) {
    const LatticeTriangle& triangle = surface.triangles[triangles[i < triangles.size() ? i : 0]];
    for (std::size_t corner = 0; corner < 3; ++corner) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto number =
            static_cast<std::uint16_t>((triangle.steps[corner][axis] - low[axis]) >> any.shift);
        std::memcpy(reinterpret_cast<char*>(cluster.data() + cluster_head) +
                        2 * ((3 * corner + axis) * cluster_size + i),
                    &number, 2);
      }
    }
    std::memcpy(reinterpret_cast<char*>(cluster.data() + cluster_head) + 2 * (9 * cluster_size + i),
                &triangle.sides, 2);
  }
  words.insert(words.end(), cluster.begin(), cluster.end());
  return true;
}

/// Which cluster each triangle is in.
std::vector<std::uint32_t> make_clusters(const std::vector<OctreeNode>& roots,
                                         const LatticeSurface& surface, BuiltOctree& built) {
  std::vector<bool> used(surface.triangles.size(), false);
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    used[i] = surface.triangles[i].bare;
  }
  for (const OctreeNode& root : roots) {
    each_leaf(root, [&](const OctreeNode& leaf) {
      for (const ListedCandidate& listed : leaf.triangles) used[listed.triangle] = true;
      for (const ListedCandidate& listed : leaf.caps) used[listed.triangle] = true;
    });
  }
  // What stands in a cluster has one shift, and caps and thin triangles stand apart.
  using Kind = std::tuple<bool, std::uint8_t, bool>;
  std::map<Kind, std::vector<std::uint32_t>> kinds;
  for (std::uint32_t i = 0; i < surface.triangles.size(); ++i) {
    const LatticeTriangle& triangle = surface.triangles[i];
    if (used[i]) kinds[{triangle.cap, triangle.shift, triangle.exact}].push_back(i);
  }
  std::vector<std::uint32_t> cluster_of(surface.triangles.size(), no_cluster);
  for (auto& [kind, triangles] : kinds) {
    built.counts.triangles += triangles.size();
    std::vector<std::vector<std::uint32_t>> groups;
    group(surface, triangles, 0, triangles.size(), groups);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const auto cluster = static_cast<std::uint32_t>(built.data.clusters.size() / cluster_words);
      if (!append_cluster(surface, groups[i], built.data.clusters)) {
        // Too far apart: each half by itself.
        const auto half = static_cast<std::ptrdiff_t>(groups[i].size() / 2);
        groups.emplace_back(groups[i].begin() + half, groups[i].end());
        groups[i].resize(static_cast<std::size_t>(half));
        --i;
        continue;
      }
      for (const std::uint32_t triangle : groups[i]) cluster_of[triangle] = cluster;
    }
  }
  if (built.data.clusters.size() / cluster_words > 0xFFFFFF) {
    throw BakeError(ExitCode::invalid_input, "the mesh has too many triangles for exact lists");
  }
  return cluster_of;
}

class Writer {
 public:
  Writer(const std::vector<std::uint32_t>& cluster_of, BuiltOctree& built)
      : cluster_of_(cluster_of), built_(built), data_(built.data) {}

  [[nodiscard]] std::uint32_t root_word(const OctreeNode& node) {
    const auto kind = static_cast<std::uint32_t>(node.kind);
    if (node.kind == OctreeKind::far) {
      const double steps = std::floor(node.clearance / data_.clearance_unit);
      return kind | static_cast<std::uint32_t>(std::clamp(steps, 0.0, 268435455.0)) << 4U;
    }
    const std::uint32_t first = reserve(units_of(node.kind));
    write(node, first);
    return kind | first << 4U;
  }

 private:
  const std::vector<std::uint32_t>& cluster_of_;
  BuiltOctree& built_;
  OctreeData& data_;
  std::map<std::vector<std::uint32_t>, std::uint32_t> known_;

  std::uint32_t reserve(std::uint32_t units) {
    const auto first = static_cast<std::uint32_t>(data_.units.size() / 2);
    if (first > 0x0FFFFFFF - 64) {
      throw BakeError(ExitCode::tolerance_not_met,
                      "the octree is too large; take a coarser tolerance");
    }
    data_.units.resize(data_.units.size() + 2 * std::size_t{units});
    return first;
  }

  void write(const OctreeNode& node, std::uint32_t unit) {
    const std::size_t at = 2 * std::size_t{unit};
    const double volume = 8 * node.cube.half * node.cube.half * node.cube.half;
    switch (node.kind) {
      case OctreeKind::split: {
        std::uint32_t units = 0, kinds = 0;
        for (std::uint32_t i = 0; i < 8; ++i) {
          const OctreeKind kind = (*node.octants)[i].kind;
          units += units_of(kind);
          kinds |= static_cast<std::uint32_t>(kind) << (4 * i);
        }
        const std::uint32_t first = reserve(units);
        data_.units[at] = first;
        data_.units[at + 1] = kinds;
        for (std::uint32_t i = 0; i < 8; ++i) {
          write((*node.octants)[i], first + units_before(kinds, i));
        }
        break;
      }
      case OctreeKind::list:
        ++built_.counts.lists;
        built_.counts.list_volume += volume;
        data_.units[at] = list_of(node, data_.units[at + 1]);
        break;
      case OctreeKind::pruned:
        built_.counts.pruned_volume[static_cast<std::size_t>(node.rule)] += volume;
        break;
      case OctreeKind::far:
        break;
      default:
        if (node.kind != OctreeKind::deep) {
          ++(node.kind == OctreeKind::polynomial ? built_.counts.polynomials : built_.counts.pairs);
          built_.counts.polynomial_volume += volume;
        }
        std::copy(node.words.begin(), node.words.end(),
                  data_.units.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }

  /// Clusters with the least bound of their triangles here, ascending.
  [[nodiscard]] std::vector<std::uint32_t> entries_of(
      const std::vector<ListedCandidate>& listed) const {
    std::map<std::uint32_t, double> bounds;
    for (const ListedCandidate& candidate : listed) {
      const auto [found, fresh] = bounds.emplace(cluster_of_[candidate.triangle], candidate.bound);
      if (!fresh) found->second = std::min(found->second, candidate.bound);
    }
    std::vector<std::uint32_t> entries;
    for (const auto& [cluster, bound] : bounds) {
      const double steps = std::floor(bound / data_.reach * 255 * (1 - 1e-6));
      entries.push_back(cluster | static_cast<std::uint32_t>(std::clamp(steps, 0.0, 255.0)) << 24U);
    }
    std::sort(entries.begin(), entries.end());
    return entries;
  }

  std::uint32_t list_of(const OctreeNode& node, std::uint32_t& word) {
    std::vector<std::uint32_t> entries = entries_of(node.triangles);
    const std::vector<std::uint32_t> caps = entries_of(node.caps);
    entries.insert(entries.end(), caps.begin(), caps.end());
    if (entries.size() > 0xFFF) {
      throw BakeError(ExitCode::tolerance_not_met,
                      "more than 4095 clusters of triangles meet in one place");
    }
    word = static_cast<std::uint32_t>(entries.size()) |
           static_cast<std::uint32_t>(caps.size()) << 12U |
           static_cast<std::uint32_t>(node.side) << 24U;
    built_.counts.listed_clusters += entries.size();
    const auto [found, fresh] =
        known_.emplace(entries, static_cast<std::uint32_t>(data_.lists.size()));
    if (fresh) data_.lists.insert(data_.lists.end(), entries.begin(), entries.end());
    return found->second;
  }
};

}  // namespace

void write_words(const std::vector<OctreeNode>& roots, const LatticeSurface& surface,
                 BuiltOctree& built) {
  built.data.cluster_origin = surface.origin;
  built.data.cluster_step = surface.step;
  const std::vector<std::uint32_t> cluster_of = make_clusters(roots, surface, built);
  Writer writer(cluster_of, built);
  for (const OctreeNode& root : roots) built.data.root_words.push_back(writer.root_word(root));
  const OctreeData& data = built.data;
  built.counts.bytes =
      4 * (data.root_words.size() + data.units.size() + data.lists.size() + data.clusters.size());
}

}  // namespace spm::baker
