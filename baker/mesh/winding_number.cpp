// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/winding_number.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

namespace spm::baker {
namespace {

constexpr std::uint32_t leaf_triangles = 2 * edge_lanes;

constexpr std::uint32_t worth_a_thread = 16384;  ///< triangles

/// The directed edges that remain after those that run in both directions cancelled; sorted.
std::vector<std::array<std::uint32_t, 2>> cancelled(
    const std::vector<std::array<std::uint32_t, 2>>& edges) {
  // The two ends, the lesser one first, and which way.
  std::vector<std::pair<std::uint64_t, int>> ways;
  ways.reserve(edges.size());
  for (const auto& [from, to] : edges) {
    const auto [low, high] = std::minmax(from, to);
    ways.emplace_back(std::uint64_t{low} << 32U | high, from < to ? 1 : -1);
  }
  std::sort(ways.begin(), ways.end());
  std::vector<std::array<std::uint32_t, 2>> left;
  for (std::size_t begin = 0; begin < ways.size();) {
    int net = 0;
    std::size_t end = begin;
    for (; end < ways.size() && ways[end].first == ways[begin].first; ++end) {
      net += ways[end].second;
    }
    const auto low = static_cast<std::uint32_t>(ways[begin].first >> 32U);
    const auto high = static_cast<std::uint32_t>(ways[begin].first);
    for (int i = 0; i < std::abs(net); ++i) {
      if (net > 0) {
        left.push_back({low, high});
      } else {
        left.push_back({high, low});
      }
    }
    begin = end;
  }
  return left;
}

}  // namespace

std::int32_t WindingNumber::Tree::append(const Tree& other) {
  const auto root = static_cast<std::int32_t>(nodes.size());
  const auto first_block = static_cast<std::uint32_t>(blocks.size());
  const auto first_triangles = static_cast<std::uint32_t>(leaves.size());
  for (Node node : other.nodes) {
    node.first_block += first_block;
    node.last_block += first_block;
    node.first_triangles += first_triangles;
    node.last_triangles += first_triangles;
    if (node.left >= 0) {
      node.left += root;
      node.right += root;
    }
    nodes.push_back(node);
  }
  blocks.insert(blocks.end(), other.blocks.begin(), other.blocks.end());
  leaves.insert(leaves.end(), other.leaves.begin(), other.leaves.end());
  return root;
}

class WindingNumber::Builder {
 public:
  Builder(std::span<const Vector3> vertices, std::span<const Triangle> triangles)
      : vertices_(vertices) {
    triangles_.reserve(triangles.size());
    for (const Triangle& corners : triangles) {
      const auto& [a, b, c] = corners;
      triangles_.push_back({vertices_[a] + vertices_[b] + vertices_[c], corners});
    }
  }

  /// Adds the tree over the triangles of some numbers; gives where its root comes to be, and the
  /// edges of its boundary.
  std::int32_t build(std::uint32_t first, std::uint32_t last, Tree& tree,
                     std::vector<Edge>& boundary) {
    const auto index = static_cast<std::int32_t>(tree.nodes.size());
    Node node;
    node.low.setConstant(std::numeric_limits<double>::infinity());
    node.high = -node.low;
    for (std::uint32_t t = first; t < last; ++t) {
      for (const std::uint32_t corner : triangles_[t].corners) {
        node.low = node.low.cwiseMin(vertices_[corner]);
        node.high = node.high.cwiseMax(vertices_[corner]);
      }
    }
    node.apex = (node.low + node.high) / 2;
    node.first = first;
    node.last = last;
    tree.nodes.push_back(node);
    std::vector<Edge> edges;
    if (last - first <= leaf_triangles) {
      add_leaf(tree, node, edges);
    } else {
      divide(tree, node, edges);
    }
    boundary = cancelled(edges);
    const std::vector<DirectedEdge> ends = ends_of(boundary);
    const std::vector<EdgeBlock> blocks = edge_blocks(ends);
    node.first_block = static_cast<std::uint32_t>(tree.blocks.size());
    tree.blocks.insert(tree.blocks.end(), blocks.begin(), blocks.end());
    node.last_block = static_cast<std::uint32_t>(tree.blocks.size());
    node.edges = static_cast<std::uint32_t>(ends.size());
    tree.nodes[static_cast<std::size_t>(index)] = node;
    return index;
  }

  [[nodiscard]] std::vector<DirectedEdge> ends_of(const std::vector<Edge>& edges) const {
    std::vector<DirectedEdge> ends;
    ends.reserve(edges.size());
    for (const auto& [from, to] : edges) ends.push_back({vertices_[from], vertices_[to]});
    return ends;
  }

 private:
  struct Placed {
    Vector3 sum = Vector3::Zero();  ///< of the corners
    Triangle corners{};
  };

  /// Lays the triangles of a leaf in blocks, and adds their edges.
  void add_leaf(Tree& tree, Node& node, std::vector<Edge>& edges) const {
    std::vector<std::array<Vector3, 3>> corners;
    corners.reserve(node.last - node.first);
    for (std::uint32_t t = node.first; t < node.last; ++t) {
      const auto& [a, b, c] = triangles_[t].corners;
      corners.push_back({vertices_[a], vertices_[b], vertices_[c]});
      for (const Edge& edge : {Edge{a, b}, Edge{b, c}, Edge{c, a}}) edges.push_back(edge);
    }
    const std::vector<TriangleBlock> blocks = triangle_blocks(corners);
    node.first_triangles = static_cast<std::uint32_t>(tree.leaves.size());
    tree.leaves.insert(tree.leaves.end(), blocks.begin(), blocks.end());
    node.last_triangles = static_cast<std::uint32_t>(tree.leaves.size());
  }

  /// Adds the trees over both halves of a node, and their edges.
  void divide(Tree& tree, Node& node, std::vector<Edge>& edges) {
    Eigen::Index axis = 0;
    (node.high - node.low).maxCoeff(&axis);
    const std::uint32_t middle = node.first + (node.last - node.first) / 2;
    std::nth_element(triangles_.begin() + node.first, triangles_.begin() + middle,
                     triangles_.begin() + node.last, [axis](const Placed& a, const Placed& b) {
                       return a.sum[axis] != b.sum[axis] ? a.sum[axis] < b.sum[axis]
                                                         : a.corners < b.corners;
                     });
    std::vector<Edge> other;
    if (node.last - node.first > worth_a_thread) {
      Tree left, right;
      tbb::parallel_invoke([&] { build(node.first, middle, left, edges); },
                           [&] { build(middle, node.last, right, other); });
      node.left = tree.append(left);
      node.right = tree.append(right);
    } else {
      node.left = build(node.first, middle, tree, edges);
      node.right = build(middle, node.last, tree, other);
    }
    edges.insert(edges.end(), other.begin(), other.end());
  }

  std::span<const Vector3> vertices_;
  std::vector<Placed> triangles_;
};

WindingNumber::WindingNumber(std::span<const Vector3> vertices,
                             std::span<const Triangle> triangles) {
  if (triangles.empty()) return;
  std::vector<Edge> boundary;
  Builder(vertices, triangles)
      .build(0, static_cast<std::uint32_t>(triangles.size()), tree_, boundary);
}

double WindingNumber::at(const Vector3& point) const noexcept {
  if (tree_.nodes.empty()) return 0;
  std::array<std::int32_t, 64> stack{};  // the tree halves, so it is at most 32 deep
  std::size_t depth = 0;
  stack[depth++] = 0;
  AngleSum sum;
  while (depth > 0) {
    const Node& node = tree_.nodes[static_cast<std::size_t>(stack[--depth])];
    const bool outside =
        (point.array() < node.low.array()).any() || (point.array() > node.high.array()).any();
    const std::uint32_t triangles = node.last - node.first;
    if (outside && node.edges <= triangles) {
      sum.add_fan({tree_.blocks.data() + node.first_block, tree_.blocks.data() + node.last_block},
                  node.apex, point);
    } else if (node.left < 0) {
      sum.add_triangles(
          {tree_.leaves.data() + node.first_triangles, tree_.leaves.data() + node.last_triangles},
          point);
    } else {
      stack[depth++] = node.left;
      stack[depth++] = node.right;
    }
  }
  return sum.total() / (2 * std::numbers::pi);
}

}  // namespace spm::baker
