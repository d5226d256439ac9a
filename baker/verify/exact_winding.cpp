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

constexpr std::uint32_t leaf_triangles = 6;

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

/// A triangle seen from a point: half its solid angle is that of the vector (x, y).
struct HalfAngle {
  double y = 0, x = 0;
};

/// Van Oosterom and Strackee (1983). The corners are seen from the point.
HalfAngle half_angle(const Vector3& a, double length_a, const Vector3& b, const Vector3& c) {
  const double length_b = b.norm(), length_c = c.norm();
  return {a.dot(b.cross(c)), length_a * length_b * length_c + a.dot(b) * length_c +
                                 b.dot(c) * length_a + c.dot(a) * length_b};
}

/// A sum of angles. Small ones are added by multiplying complex numbers, which takes a tenth of the
/// time of an arc tangent each.
class AngleSum {
 public:
  void add(const HalfAngle& angle) {
    if (!(angle.x > 0 && std::abs(angle.y) <= angle.x)) {
      sum_ += std::atan2(angle.y, angle.x);
      return;
    }
    const double slope = angle.y / angle.x;
    // The angle is no larger than its slope, so the product's own angle is the sum below pi.
    constexpr double most = 3;
    bound_ += std::abs(slope);
    if (bound_ > most) {
      flush();
      bound_ = std::abs(slope);
    }
    const double real = real_;
    real_ = real - imaginary_ * slope;
    imaginary_ += real * slope;
  }
  [[nodiscard]] double total() {
    flush();
    return sum_;
  }

 private:
  double sum_ = 0, real_ = 1, imaginary_ = 0, bound_ = 0;

  void flush() {
    sum_ += std::atan2(imaginary_, real_);
    real_ = 1;
    imaginary_ = bound_ = 0;
  }
};

}  // namespace

double triangle_winding(const Vector3& point, const Vector3& a, const Vector3& b,
                        const Vector3& c) noexcept {
  const Vector3 from = a - point;
  const HalfAngle angle = half_angle(from, from.norm(), b - point, c - point);
  return std::atan2(angle.y, angle.x) / (2 * std::numbers::pi);
}

ExactWinding::ExactWinding(const Mesh& mesh)
    : vertices_(mesh.vertices), triangles_(mesh.triangles) {
  std::vector<Edge> boundary;
  if (!triangles_.empty()) build(0, static_cast<std::uint32_t>(triangles_.size()), boundary);
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
    for (std::uint32_t t = first; t < last; ++t) {
      const Triangle& corners = triangles_[t];
      for (std::size_t i = 0; i < 3; ++i) edges.push_back({corners[i], corners[(i + 1) % 3]});
    }
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
  node.first_edge = static_cast<std::uint32_t>(edges_.size());
  edges_.insert(edges_.end(), boundary.begin(), boundary.end());
  node.last_edge = static_cast<std::uint32_t>(edges_.size());
  nodes_[static_cast<std::size_t>(index)] = node;
  return index;
}

double ExactWinding::cluster(const Node& node, const Vector3& point) const noexcept {
  AngleSum sum;
  const Vector3 apex = node.apex - point;
  const double length = apex.norm();
  for (std::uint32_t e = node.first_edge; e < node.last_edge; ++e) {
    sum.add(
        half_angle(apex, length, vertices_[edges_[e][0]] - point, vertices_[edges_[e][1]] - point));
  }
  return sum.total() / (2 * std::numbers::pi);
}

double ExactWinding::at(const Vector3& point) const noexcept {
  if (nodes_.empty()) return 0;
  std::array<std::int32_t, 64> stack{};  // the tree halves, so it is at most 32 deep
  std::size_t depth = 0;
  stack[depth++] = 0;
  double sum = 0;
  while (depth > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(stack[--depth])];
    const bool outside =
        (point.array() < node.low.array()).any() || (point.array() > node.high.array()).any();
    if (outside && node.last_edge - node.first_edge <= node.last - node.first) {
      sum += cluster(node, point);
    } else if (node.left < 0) {
      for (std::uint32_t t = node.first; t < node.last; ++t) {
        const Triangle& corners = triangles_[t];
        sum += triangle_winding(point, vertices_[corners[0]], vertices_[corners[1]],
                                vertices_[corners[2]]);
      }
    } else {
      stack[depth++] = node.left;
      stack[depth++] = node.right;
    }
  }
  return sum;
}

double ExactWinding::variation(const Vector3& point, double distance) const noexcept {
  if (nodes_.empty()) return 0;
  const Node& root = nodes_.front();
  double gradient = 0;
  for (std::uint32_t e = root.first_edge; e < root.last_edge; ++e) {
    const Vector3& from = vertices_[edges_[e][0]];
    const Vector3 along = vertices_[edges_[e][1]] - from;
    const double length = along.norm();
    // No point of the edge is nearer than this.
    const double gap = (from + along / 2 - point).norm() - length / 2 - distance;
    if (gap <= 0) return std::numeric_limits<double>::infinity();
    gradient += length / (4 * std::numbers::pi * gap * gap);
  }
  return gradient * distance;
}

}  // namespace spm::baker
