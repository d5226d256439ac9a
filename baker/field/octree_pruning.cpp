// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/octree_pruning.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "baker/field/octree_triangles.hpp"
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

  Cost& operator+=(const Cost& other) {
    bytes += other.bytes;
    time += other.time;
    return *this;
  }
};

constexpr double word_bytes = 4, root_bytes = 4;

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

class Pruning {
 public:
  explicit Pruning(double bytes_per_time) : bytes_per_time_(bytes_per_time) {}

  /// The least cost of a cube and all in it.
  Cost prune(OctreeNode& node, int level) const {
    if (!node.octants) return cost_of_leaf(node, level);
    if (all_far(node)) return {};  // these will be one cube
    Cost split{.bytes = word_bytes * words_of(OctreeKind::split), .time = 0};
    for (OctreeNode& octant : *node.octants) split += prune(octant, level + 1);
    node.as_list = false;
    if (!node.few) return split;
    const Cost list = cost_of_list(node.few->size(), node.cube, level);
    node.as_list = weighed(list) < weighed(split);
    return node.as_list ? list : split;
  }

 private:
  double bytes_per_time_;

  [[nodiscard]] double weighed(const Cost& cost) const {
    return cost.bytes + bytes_per_time_ * cost.time;
  }
};

Cost cost_of_roots(double bytes_per_time, OctreeRoots& roots) {
  const Pruning pruning(bytes_per_time);
  Cost cost;
  for (OctreeNode& root : roots.nodes) cost += pruning.prune(root, 0);
  cost.bytes += root_bytes * static_cast<double>(roots.nodes.size());
  return cost;
}

/// Eight roots that lie together in one.
OctreeRoots joined(OctreeRoots&& roots, const RootMaker& make_root) {
  OctreeRoots half;
  for (std::size_t axis = 0; axis < 3; ++axis) half.count[axis] = (roots.count[axis] + 1) / 2;
  const double edge = 2 * roots.nodes.front().cube.half;
  const Vector3 first = roots.nodes.front().cube.middle;
  for (std::uint32_t z = 0; z < half.count[2]; ++z) {
    for (std::uint32_t y = 0; y < half.count[1]; ++y) {
      for (std::uint32_t x = 0; x < half.count[0]; ++x) {
        OctreeNode& node = half.nodes.emplace_back();
        node.kind = OctreeKind::split;
        node.octants = std::make_unique<std::array<OctreeNode, 8>>();
        for (std::uint32_t octant = 0; octant < 8; ++octant) {
          const std::uint32_t at_x = 2 * x + (is_upper(octant, 0) ? 1U : 0U),
                              at_y = 2 * y + (is_upper(octant, 1) ? 1U : 0U),
                              at_z = 2 * z + (is_upper(octant, 2) ? 1U : 0U);
          const bool there =
              at_x < roots.count[0] && at_y < roots.count[1] && at_z < roots.count[2];
          (*node.octants)[octant] =
              there ? std::move(roots.nodes[at_x + roots.count[0] *
                                                       (at_y + std::size_t{at_z} * roots.count[1])])
                    : make_root({first + edge * Vector3(at_x, at_y, at_z), edge / 2});
        }
        node.cube = {node.octants->front().cube.middle + Vector3::Constant(edge / 2), edge};
      }
    }
  }
  return half;
}

/// Eight roots of each, up to so many along the axes.
OctreeRoots parted(OctreeRoots&& half, const std::array<std::uint32_t, 3>& count,
                   const RootMaker& make_root) {
  OctreeRoots roots;
  roots.count = count;
  for (std::uint32_t z = 0; z < count[2]; ++z) {
    for (std::uint32_t y = 0; y < count[1]; ++y) {
      for (std::uint32_t x = 0; x < count[0]; ++x) {
        OctreeNode& node =
            half.nodes[x / 2 + half.count[0] * (y / 2 + std::size_t{z / 2} * half.count[1])];
        const std::uint32_t octant = (x & 1U) | (y & 1U) << 1U | (z & 1U) << 2U;
        roots.nodes.push_back(node.octants ? std::move((*node.octants)[octant])
                                           : make_root(node.cube.octant(octant)));
      }
    }
  }
  return roots;
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

namespace {

double bytes_as_divided(const OctreeNode& node) {
  if (!node.octants) return cost_of_leaf(node, 0).bytes;
  double bytes = word_bytes * words_of(OctreeKind::split);
  for (const OctreeNode& octant : *node.octants) bytes += bytes_as_divided(octant);
  return bytes;
}

}  // namespace

double bytes_as_divided(const OctreeRoots& roots) {
  double bytes = root_bytes * static_cast<double>(roots.nodes.size());
  for (const OctreeNode& root : roots.nodes) bytes += bytes_as_divided(root);
  return bytes;
}

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

double find_least_bytes(OctreeRoots& roots) { return cost_of_roots(0, roots).bytes; }

double find_fastest(double bytes, OctreeRoots& roots) {
  // What time is worth, in bytes for that of a map in a cubic metre, from next to nothing to
  // all; halved as a logarithm, since it may be of any size.
  double low = 0, high = 60;
  constexpr int steps = 24;
  const auto cost_at = [&](double worth) { return cost_of_roots(std::exp(worth), roots).bytes; };
  if (const double all = cost_at(high); all <= bytes) return all;
  for (int step = 0; step < steps; ++step) {
    const double middle = (low + high) / 2;
    (cost_at(middle) <= bytes ? low : high) = middle;
  }
  return cost_at(low);
}

int join_roots(int most, const RootMaker& make_root, OctreeRoots& roots) {
  // Larger roots take longer to look into.
  constexpr double worth_joining = 0.99;
  double bytes = find_least_bytes(roots);
  for (int times = 0; times < most; ++times) {
    const std::array<std::uint32_t, 3> count = roots.count;
    OctreeRoots half = joined(std::move(roots), make_root);
    for (OctreeNode& node : half.nodes) gather_octants(node);
    const double joined_bytes = find_least_bytes(half);
    if (joined_bytes > worth_joining * bytes) {
      roots = parted(std::move(half), count, make_root);
      return times;
    }
    bytes = joined_bytes;
    roots = std::move(half);
    for (OctreeNode& node : roots.nodes) join_octants(node);
  }
  return most;
}

bool part_roots(const RootMaker& make_root, OctreeRoots& roots) {
  constexpr double worth_parting = 0.09;  // as many bytes more, for looking into one cube less
  double more = 7 * root_bytes * static_cast<double>(roots.nodes.size());
  for (const OctreeNode& root : roots.nodes) {
    more += word_bytes *
            (root.octants ? -1.0 * words_of(OctreeKind::split) : 7.0 * words_of(root.kind));
  }
  if (more > worth_parting * bytes_as_divided(roots)) return false;
  const auto& [x, y, z] = roots.count;
  roots = parted(std::move(roots), {2 * x, 2 * y, 2 * z}, make_root);
  return true;
}

void make_lists(const LatticeSurface& surface, OctreeRoots& roots) {
  for (OctreeNode& root : roots.nodes) make_lists_in(surface, root);
}

}  // namespace spm::baker
