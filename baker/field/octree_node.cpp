// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/octree_node.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace spm::baker {

namespace {

void gather_few(OctreeNode& node) {
  std::vector<std::uint32_t> all;
  for (const OctreeNode& octant : *node.octants) {
    if (!octant.few || octant.kind == OctreeKind::pruned) return;
    all.insert(all.end(), octant.few->begin(), octant.few->end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  if (all.size() <= few_triangles) node.few = std::move(all);
}

}  // namespace

void join_octants(OctreeNode& node) {
  node.few.reset();
  gather_few(node);
  node.inside = node.octants->front().inside;
  for (const OctreeNode& octant : *node.octants) {
    if (octant.inside != node.inside) node.inside.reset();
  }
  const OctreeKind kind = node.octants->front().kind;
  bool same = kind == OctreeKind::far || kind == OctreeKind::pruned;
  double clearance = std::numeric_limits<double>::infinity();
  for (const OctreeNode& octant : *node.octants) {
    same = same && octant.kind == kind;
    clearance = std::min(clearance, octant.clearance - octant.cube.radius());
  }
  node.kind = same ? kind : OctreeKind::split;
  if (!same) return;
  node.rule = node.octants->front().rule;
  node.clearance = std::max(0.0, clearance);
  node.octants.reset();
}

}  // namespace spm::baker
