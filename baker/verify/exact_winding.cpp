// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/exact_winding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace spm::baker {
namespace {

constexpr std::uint32_t leaf_triangles = 2 * edge_lanes;

/// The directed edges that remain after those that run in both directions cancelled; sorted.
std::vector<std::array<std::uint32_t, 2>> cancelled(
    const std::vector<std::array<std::uint32_t, 2>>& edges) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> net;
  for (const auto& [from, to] : edges) {
    net[std::minmax(from, to)] += from < to ? 1 : -1;
  }
  std::vector<std::array<std::uint32_t, 2>> left;
  for (const auto& [edge, count] : net) {
    for (int i = 0; i < std::abs(count); ++i) {
      if (count > 0) {
        left.push_back({edge.first, edge.second});
      } else {
        left.push_back({edge.second, edge.first});
      }
    }
  }
  return left;
}

}  // namespace

ExactWinding::ExactWinding(const Mesh& mesh)
    : vertices_(mesh.vertices), triangles_(mesh.triangles) {
  std::vector<Edge> boundary;
  if (!triangles_.empty()) build(0, static_cast<std::uint32_t>(triangles_.size()), boundary);
  vertices_ = {};
  triangles_ = {};
}

std::int32_t ExactWinding::build(std::uint32_t first, std::uint32_t last,
                                 std::vector<Edge>& boundary) {
  const auto index = static_cast<std::int32_t>(nodes_.size());
  Node node;
  node.low.setConstant(std::numeric_limits<double>::infinity());
  node.high = -node.low;
  for (std::uint32_t t = first; t < last; ++t) {
    for (const std::uint32_t corner : triangles_[t]) {
      node.low = node.low.cwiseMin(vertices_[corner]);
      node.high = node.high.cwiseMax(vertices_[corner]);
    }
  }
  node.apex = (node.low + node.high) / 2;
  node.first = first;
  node.last = last;
  nodes_.push_back(node);

  std::vector<Edge> edges;
  if (last - first <= leaf_triangles) {
    add_leaf(node, edges);
  } else {
    Eigen::Index axis = 0;
    (node.high - node.low).maxCoeff(&axis);
    const std::uint32_t middle = first + (last - first) / 2;
    const auto centre = [&](const Triangle& t) {
      return vertices_[t[0]][axis] + vertices_[t[1]][axis] + vertices_[t[2]][axis];
    };
    std::nth_element(triangles_.begin() + first, triangles_.begin() + middle,
                     triangles_.begin() + last, [&](const Triangle& a, const Triangle& b) {
                       return std::pair(centre(a), a) < std::pair(centre(b), b);
                     });
    std::vector<Edge> other;
    node.left = build(first, middle, edges);
    node.right = build(middle, last, other);
    edges.insert(edges.end(), other.begin(), other.end());
  }
  boundary = cancelled(edges);
  std::vector<DirectedEdge> ends;
  ends.reserve(boundary.size());
  for (const auto& [from, to] : boundary) ends.push_back({vertices_[from], vertices_[to]});
  if (index == 0) boundary_ = ends;
  const std::vector<EdgeBlock> blocks = edge_blocks(ends);
  node.first_block = static_cast<std::uint32_t>(blocks_.size());
  blocks_.insert(blocks_.end(), blocks.begin(), blocks.end());
  node.last_block = static_cast<std::uint32_t>(blocks_.size());
  node.edges = static_cast<std::uint32_t>(ends.size());
  nodes_[static_cast<std::size_t>(index)] = node;
  return index;
}

/// Lays the triangles of a leaf in blocks, and adds their edges.
void ExactWinding::add_leaf(Node& node, std::vector<Edge>& edges) {
  std::vector<std::array<Vector3, 3>> corners;
  corners.reserve(node.last - node.first);
  for (std::uint32_t t = node.first; t < node.last; ++t) {
    const auto& [a, b, c] = triangles_[t];
    corners.push_back({vertices_[a], vertices_[b], vertices_[c]});
    for (const Edge& edge : {Edge{a, b}, Edge{b, c}, Edge{c, a}}) edges.push_back(edge);
  }
  const std::vector<TriangleBlock> blocks = triangle_blocks(corners);
  node.first_triangles = static_cast<std::uint32_t>(leaves_.size());
  leaves_.insert(leaves_.end(), blocks.begin(), blocks.end());
  node.last_triangles = static_cast<std::uint32_t>(leaves_.size());
}

double ExactWinding::at(const Vector3& point) const noexcept {
  if (nodes_.empty()) return 0;
  std::array<std::int32_t, 64> stack{};  // the tree halves, so it is at most 32 deep
  std::size_t depth = 0;
  stack[depth++] = 0;
  AngleSum sum;
  while (depth > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(stack[--depth])];
    const bool outside =
        (point.array() < node.low.array()).any() || (point.array() > node.high.array()).any();
    const std::uint32_t triangles = node.last - node.first;
    if (outside && node.edges <= triangles) {
      sum.add_fan({blocks_.data() + node.first_block, blocks_.data() + node.last_block}, node.apex,
                  point);
    } else if (node.left < 0) {
      sum.add_triangles(
          {leaves_.data() + node.first_triangles, leaves_.data() + node.last_triangles}, point);
    } else {
      stack[depth++] = node.left;
      stack[depth++] = node.right;
    }
  }
  return sum.total() / (2 * std::numbers::pi);
}

double ExactWinding::variation(const Vector3& point, double distance) const noexcept {
  if (nodes_.empty()) return 0;
  double gradient = 0;
  for (const auto& [from, to] : boundary_) {
    const Vector3 along = to - from;
    const double length = along.norm();
    // No point of the edge is nearer than this.
    const double gap = (from + along / 2 - point).norm() - length / 2 - distance;
    if (gap <= 0) return std::numeric_limits<double>::infinity();
    gradient += length / (4 * std::numbers::pi * gap * gap);
  }
  return gradient * distance;
}

}  // namespace spm::baker
