// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/geometry/box_tree.hpp"

namespace spm::bench {

BoxTree::BoxTree(FloatMesh& mesh) : mesh_(&mesh) {
  nodes_.reserve(mesh.triangles.size());
  add(0, static_cast<std::uint32_t>(mesh.triangles.size()));
}

void BoxTree::add(std::uint32_t first, std::uint32_t end) {
  Node node;
  node.low.fill(1e30F);
  node.high.fill(-1e30F);
  for (std::uint32_t i = first; i < end; ++i) {
    for (const std::uint32_t vertex : mesh_->triangles[i]) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        node.low[axis] = std::min(node.low[axis], mesh_->vertices[vertex][axis]);
        node.high[axis] = std::max(node.high[axis], mesh_->vertices[vertex][axis]);
      }
    }
  }
  const std::size_t at = nodes_.size();
  if (end - first <= leaf_triangles) {
    node.next = first;
    node.count = end - first;
    nodes_.push_back(node);
    return;
  }
  nodes_.push_back(node);
  std::size_t widest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (node.high[axis] - node.low[axis] > node.high[widest] - node.low[widest]) widest = axis;
  }
  const auto middle_of = [&](const std::array<std::uint32_t, 3>& triangle) {
    float sum = 0;
    for (const std::uint32_t vertex : triangle) sum += mesh_->vertices[vertex][widest];
    return sum;
  };
  const std::uint32_t middle = first + (end - first) / 2;
  const auto begin = mesh_->triangles.begin();
  std::nth_element(begin + first, begin + middle, begin + end,
                   [&](const auto& a, const auto& b) { return middle_of(a) < middle_of(b); });
  add(first, middle);
  nodes_[at].next = static_cast<std::uint32_t>(nodes_.size());
  add(middle, end);
}

}  // namespace spm::bench
