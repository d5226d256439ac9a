// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/bench/model/float_mesh.hpp"

namespace spm::bench {

/// A box that a search may shrink while it runs, metres.
struct SearchBox {
  std::array<float, 3> low{}, high{};

  /// Encloses both ends of a move, grown by `grow` and a little more for rounding.
  void set(const Vector3& from, const Vector3& to, double grow) noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<int>(axis);
      const double slack = grow + 1e-7 * (std::abs(from[a]) + grow);
      low[axis] = static_cast<float>(std::min(from[a], to[a]) - slack);
      high[axis] = static_cast<float>(std::max(from[a], to[a]) + slack);
    }
  }
};

/// All triangles, one after the other: the search without a structure.
class AllTriangles {
 public:
  explicit AllTriangles(FloatMesh& mesh) : mesh_(&mesh) {}

  [[nodiscard]] static std::uint64_t bytes() noexcept { return 0; }

  /// Calls `visit(triangle)` for each whose box meets `box`, which `visit` may shrink.
  template <class Visit>
  void each(const SearchBox& box, const Visit& visit) const {
    const auto count = static_cast<std::uint32_t>(mesh_->triangles.size());
    for (std::uint32_t i = 0; i < count; ++i) {
      if (triangle_meets(*mesh_, i, box)) visit(i);
    }
  }

  /// Whether the box of a triangle meets another box.
  [[nodiscard]] static bool triangle_meets(const FloatMesh& mesh, std::uint32_t triangle,
                                           const SearchBox& box) noexcept {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const auto &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float low = std::min(std::min(p[axis], q[axis]), r[axis]);
      const float high = std::max(std::max(p[axis], q[axis]), r[axis]);
      if (low > box.high[axis] || high < box.low[axis]) return false;
    }
    return true;
  }

 private:
  const FloatMesh* mesh_;
};

/// A binary tree of boxes around triangles, split in halves by their middles on the widest axis.
class BoxTree {
 public:
  /// Puts the mesh's triangles in the tree's order. The mesh must outlive the tree.
  explicit BoxTree(FloatMesh& mesh);

  [[nodiscard]] std::uint64_t bytes() const noexcept { return nodes_.size() * sizeof(Node); }

  /// The same as AllTriangles::each.
  template <class Visit>
  void each(const SearchBox& box, const Visit& visit) const {
    std::array<std::uint32_t, max_depth> open{};
    std::size_t count = 0;
    std::uint32_t at = 0;
    while (true) {
      const Node& node = nodes_[at];
      if (meets(node, box)) {
        if (node.count == 0) {
          open[count++] = node.next;
          ++at;
          continue;
        }
        for (std::uint32_t i = node.next; i < node.next + node.count; ++i) {
          if (AllTriangles::triangle_meets(*mesh_, i, box)) visit(i);
        }
      }
      if (count == 0) return;
      at = open[--count];
    }
  }

 private:
  static constexpr std::size_t max_depth = 64;
  static constexpr std::size_t leaf_triangles = 4;

  /// The node of the first half directly follows its parent.
  struct Node {
    std::array<float, 3> low{}, high{};
    std::uint32_t next = 0;   ///< the second half's node; in a leaf its first triangle
    std::uint32_t count = 0;  ///< number of triangles of a leaf, else 0
  };

  [[nodiscard]] static bool meets(const Node& node, const SearchBox& box) noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (node.low[axis] > box.high[axis] || node.high[axis] < box.low[axis]) return false;
    }
    return true;
  }

  void add(std::uint32_t first, std::uint32_t end);

  FloatMesh* mesh_;
  std::vector<Node> nodes_;
};

}  // namespace spm::bench
