// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/octree_pruning.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "common/base/octant.hpp"

namespace spm::baker {

namespace {

/// How long answers take, that of a map in a root the unit: measured on one processor. On others it
/// may not be quite the fastest octree that is chosen.
constexpr double map_time = 1, two_maps_time = 1.55, list_time = 1.27, packet_time = 1.73,
                 level_time = 0.13;

/// Of the octree's words; times by the volume in which they are taken.
struct Cost {
  double bytes = 0, time = 0;
  bool maps = false;  ///< whether there are any

  Cost& operator+=(const Cost& other) {
    bytes += other.bytes;
    time += other.time;
    maps = maps || other.maps;
    return *this;
  }
};

constexpr double word_bytes = 4, root_bytes = 4;
/// Of a triangle and of a corner in the file.
constexpr std::uint64_t stored_triangle_bytes = 10, stored_corner_bytes = 8;

Cost cost_of_list(std::size_t triangles, const Cube& cube, int level) {
  const TriangleList list{.solids = static_cast<std::uint32_t>(triangles)};
  const double time = list_time + packet_time * static_cast<double>(list.packets());
  return {
      .bytes = word_bytes * (words_of(OctreeKind::list) + static_cast<double>(list.word_count())),
      .time = cube.volume() * (time + level_time * level)};
}

Cost cost_of_leaf(const OctreeNode& node, int level) {
  if (node.kind == OctreeKind::list) {
    return cost_of_list(node.solids.size() + node.sheets.size(), node.cube, level);
  }
  Cost cost;
  cost.bytes = word_bytes * words_of(node.kind);
  if (node.kind == OctreeKind::map) {
    const double time = node.charts.size() > 1 ? two_maps_time : map_time;
    cost.bytes += node.shared_bytes;
    cost.time = node.cube.volume() * (time + level_time * level);
    cost.maps = true;
  }
  return cost;
}

bool all_far(const OctreeNode& node) {
  return std::all_of(node.octants->begin(), node.octants->end(),
                     [](const OctreeNode& octant) { return octant.kind == OctreeKind::far; });
}

double shared_in(const OctreeNode& node) {
  if (node.as_list || !node.octants) return node.as_list ? 0 : node.shared_bytes;
  double bytes = 0;
  for (const OctreeNode& octant : *node.octants) bytes += shared_in(octant);
  return bytes;
}

/// What a byte is worth, and whether lists may take the place of maps.
struct Pruning {
  double bytes_per_time = 0;
  bool keeps_maps = false;

  /// The least cost of a cube and all in it.
  Cost prune(OctreeNode& node, int level) const {
    if (!node.octants) return cost_of_leaf(node, level);
    if (all_far(node)) return {};  // these will be one cube
    Cost split{.bytes = word_bytes * words_of(OctreeKind::split)};
    for (OctreeNode& octant : *node.octants) split += prune(octant, level + 1);
    node.as_list = false;
    if (!node.few || (keeps_maps && split.maps)) return split;
    const Cost list = cost_of_list(node.few->size(), node.cube, level);
    node.as_list = weighed(list) < weighed(split);
    return node.as_list ? list : split;
  }

  /// Of all roots; `level` is theirs.
  Cost prune(OctreeRoots& roots, int level) const {
    Cost cost{.bytes = root_bytes * static_cast<double>(roots.nodes.size())};
    for (OctreeNode& root : roots.nodes) cost += prune(root, level);
    return cost;
  }

 private:
  [[nodiscard]] double weighed(const Cost& cost) const {
    return cost.bytes + bytes_per_time * cost.time;
  }
};

/// Prunes roots so that bytes, with those beside them, times time is least: another byte then is as
/// great a share of all bytes as what it saves is of the time. Maps stay.
Cost best_of_roots(double beside, int level, OctreeRoots& roots) {
  for (Pruning pruning{.keeps_maps = true};;) {
    Cost cost = pruning.prune(roots, level);
    cost.bytes += beside;
    const double worth = cost.time > 0 ? cost.bytes / cost.time : 0;
    // It only rises, from octree to octree.
    if (!(worth > pruning.bytes_per_time)) return cost;
    pruning.bytes_per_time = worth;
  }
}

/// Eight roots of each.
OctreeRoots parted(OctreeRoots&& roots, const RootMaker& make_root) {
  OctreeRoots parts;
  for (std::size_t axis = 0; axis < 3; ++axis) parts.count[axis] = 2 * roots.count[axis];
  const auto& [columns, rows, layers] = parts.count;
  for (std::uint32_t z = 0; z < layers; ++z) {
    for (std::uint32_t y = 0; y < rows; ++y) {
      for (std::uint32_t x = 0; x < columns; ++x) {
        OctreeNode& node =
            roots.nodes[x / 2 + roots.count[0] * (y / 2 + std::size_t{z / 2} * roots.count[1])];
        const std::uint32_t octant = (x & 1U) | (y & 1U) << 1U | (z & 1U) << 2U;
        parts.nodes.push_back(node.octants ? std::move((*node.octants)[octant])
                                           : make_root(node.cube.octant(octant)));
      }
    }
  }
  return parts;
}

void mark_used(const OctreeNode& node, std::vector<bool>& used) {
  if (node.as_list) {
    for (const std::uint32_t triangle : *node.few) used[triangle] = true;
  } else if (node.octants) {
    for (const OctreeNode& octant : *node.octants) mark_used(octant, used);
  } else {
    for (const auto* listed : {&node.solids, &node.sheets}) {
      for (const ListedCandidate& candidate : *listed) used[candidate.triangle] = true;
    }
    for (const std::uint32_t triangle : node.crossed) used[triangle] = true;
  }
}

void make_lists_in(const LatticeSurface& surface, OctreeNode& node) {
  if (!node.octants) return;
  if (!node.as_list) {
    for (OctreeNode& octant : *node.octants) make_lists_in(surface, octant);
    return;
  }
  node.as_list = false;
  node.kind = OctreeKind::list;
  node.side = side_of(node.inside);
  for (const std::uint32_t triangle : *node.few) {
    // Lists of few triangles have no bounds.
    (surface.triangles[triangle].sheet ? node.sheets : node.solids).push_back({triangle, 0});
  }
  node.octants.reset();
}

}  // namespace

double shared_bytes(const OctreeRoots& roots) {
  double bytes = 0;
  for (const OctreeNode& root : roots.nodes) bytes += shared_in(root);
  return bytes;
}

std::vector<bool> used_triangles(const LatticeSurface& surface, const OctreeRoots& roots) {
  std::vector<bool> used(surface.triangles.size() + surface.crossed.size(), false);
  for (const OctreeNode& root : roots.nodes) mark_used(root, used);
  return used;
}

double triangle_bytes(const LatticeSurface& surface, const OctreeRoots& roots) {
  const std::vector<bool> used = used_triangles(surface, roots);
  std::uint64_t bytes = 4;  // a triangle's half of a word may be alone
  std::set<LatticePoint> corners;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    bytes += stored_triangle_bytes;
    const auto& steps = surface.any_triangle(i).steps;
    corners.insert(steps.begin(), steps.end());
  }
  return static_cast<double>(bytes + stored_corner_bytes * corners.size());
}

double find_least_bytes(OctreeRoots& roots) { return Pruning().prune(roots, 0).bytes; }

double find_fastest(double bytes, OctreeRoots& roots) {
  // What time is worth, in bytes for that of a map in a cubic metre, from next to nothing to
  // all; halved as a logarithm, since it may be of any size.
  double low = 0, high = 60;
  constexpr int steps = 24;
  const auto cost_at = [&](double worth) {
    return Pruning{.bytes_per_time = std::exp(worth)}.prune(roots, 0).bytes;
  };
  if (const double all = cost_at(high); all <= bytes) return all;
  for (int step = 0; step < steps; ++step) {
    const double middle = (low + high) / 2;
    (cost_at(middle) <= bytes ? low : high) = middle;
  }
  return cost_at(low);
}

int find_best(const LatticeSurface& surface, int most, const RootMaker& make_root,
              OctreeRoots& roots) {
  static_cast<void>(best_of_roots(0, 0, roots));
  const double triangles = triangle_bytes(surface, roots);
  for (int times = 0;; ++times) {
    double more = 7 * root_bytes * static_cast<double>(roots.nodes.size());
    for (const OctreeNode& root : roots.nodes) {
      more += word_bytes *
              (root.octants ? -1.0 * words_of(OctreeKind::split) : 7.0 * words_of(root.kind));
    }
    // All that is in them is then a level nearer.
    const Cost parts = best_of_roots(triangles + more, -1, roots);
    const Cost whole = best_of_roots(triangles, 0, roots);
    if (times == most || parts.bytes * parts.time >= whole.bytes * whole.time) return times;
    roots = parted(std::move(roots), make_root);
  }
}

void make_lists(const LatticeSurface& surface, OctreeRoots& roots) {
  for (OctreeNode& root : roots.nodes) make_lists_in(surface, root);
}

}  // namespace spm::baker
