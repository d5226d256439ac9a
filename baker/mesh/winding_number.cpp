// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/winding_number.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace spm::baker {
namespace {

constexpr std::size_t leaf_triangles = 8;

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

/// A sum of half the solid angles of triangles (Van Oosterom and Strackee 1983). Small ones are
/// added by multiplying complex numbers, which takes a tenth of the time of an arc tangent each.
class AngleSum {
 public:
  /// Of a triangle whose corners are seen from the point. One at a corner counts nothing.
  void add(const Vector3& a, const Vector3& b, const Vector3& c) {
    const double to_a = a.norm(), to_b = b.norm(), to_c = c.norm();
    const double x = to_a * to_b * to_c + a.dot(b) * to_c + b.dot(c) * to_a + c.dot(a) * to_b;
    const double y = a.dot(b.cross(c)), size = std::hypot(x, y);
    if (!(size > 0)) return;
    if (!(std::abs(y) <= x)) {
      sum_ += std::atan2(y, x);
      return;
    }
    const double turned = (product_x_ * x - product_y_ * y) / size;
    product_y_ = (product_x_ * y + product_y_ * x) / size;
    product_x_ = turned;
    if (std::abs(product_y_) <= product_x_) return;
    sum_ = total();
    product_x_ = 1;
    product_y_ = 0;
  }
  [[nodiscard]] double total() const { return sum_ + std::atan2(product_y_, product_x_); }

 private:
  double sum_ = 0;
  double product_x_ = 1, product_y_ = 0;  ///< of angles that are not in the sum yet
};

}  // namespace

std::int32_t WindingNumber::add(std::span<const Vector3> vertices, std::span<Triangle> triangles,
                                std::uint32_t first, std::vector<Edge>& boundary) {
  const auto index = static_cast<std::int32_t>(nodes_.size());
  Node node;
  node.first = first;
  node.last = first + static_cast<std::uint32_t>(triangles.size());
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t corner : triangle) node.box.extend(vertices[corner]);
  }
  nodes_.push_back(node);
  std::vector<Edge> edges;
  if (triangles.size() <= leaf_triangles) {
    for (const auto& [a, b, c] : triangles) {
      edges.insert(edges.end(), {Edge{a, b}, Edge{b, c}, Edge{c, a}});
      triangles_.push_back({vertices[a], vertices[b], vertices[c]});
    }
  } else {
    Eigen::Index axis = 0;
    node.box.sizes().maxCoeff(&axis);
    const auto along = [&](const Triangle& t) {
      return vertices[t[0]][axis] + vertices[t[1]][axis] + vertices[t[2]][axis];
    };
    const std::size_t half = triangles.size() / 2;
    std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half),
                     triangles.end(), [&](const Triangle& a, const Triangle& b) {
                       const double at_a = along(a), at_b = along(b);
                       return at_a != at_b ? at_a < at_b : a < b;
                     });
    std::vector<Edge> other;
    node.left = add(vertices, triangles.first(half), first, edges);
    node.right =
        add(vertices, triangles.subspan(half), first + static_cast<std::uint32_t>(half), other);
    edges.insert(edges.end(), other.begin(), other.end());
  }
  boundary = cancelled(edges);
  node.first_edge = static_cast<std::uint32_t>(boundaries_.size());
  for (const auto& [from, to] : boundary) boundaries_.push_back({vertices[from], vertices[to]});
  node.last_edge = static_cast<std::uint32_t>(boundaries_.size());
  nodes_[static_cast<std::size_t>(index)] = node;
  return index;
}

WindingNumber::WindingNumber(std::span<const Vector3> vertices,
                             std::span<const Triangle> triangles) {
  if (triangles.empty()) return;
  std::vector<Triangle> ordered(triangles.begin(), triangles.end());
  std::vector<Edge> boundary;
  add(vertices, ordered, 0, boundary);
}

double WindingNumber::at(const Vector3& point) const noexcept {
  if (nodes_.empty()) return 0;
  std::array<std::int32_t, 64> stack{};  // the tree halves, so it is at most 32 deep
  std::size_t depth = 0;
  stack[depth++] = 0;
  AngleSum sum;
  while (depth > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(stack[--depth])];
    const std::uint32_t edges = node.last_edge - node.first_edge;
    if (!node.box.contains(point) && edges <= node.last - node.first) {
      const Vector3 apex = node.box.center() - point;
      for (std::uint32_t i = node.first_edge; i < node.last_edge; ++i) {
        sum.add(apex, boundaries_[i][0] - point, boundaries_[i][1] - point);
      }
    } else if (node.left < 0) {
      for (std::uint32_t i = node.first; i < node.last; ++i) {
        sum.add(triangles_[i][0] - point, triangles_[i][1] - point, triangles_[i][2] - point);
      }
    } else {
      stack[depth++] = node.left;
      stack[depth++] = node.right;
    }
  }
  return sum.total() / (2 * std::numbers::pi);
}

}  // namespace spm::baker
