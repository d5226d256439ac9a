// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "common/surface/support_plane.hpp"

namespace spm {

/// Kind of a node's child in an BVH.
enum class ElementKind : std::uint32_t { none = 0, node = 1, tile = 2, fan = 3 };

/// Bounding volume hierarchy (BVH) of the elements of a `sparse` asset, its tiles and fans of
/// triangles: boxes in a tree whose nodes have up to four children, used to find the elements
/// nearest to a point. A node has ten words:
///   0-3: one word per child: bits 0-23 the number of a node, of a tile or of a fan's first corner,
///     24-29 the number of the fan's triangles less one, 30-31 the ElementKind;
///   4-9: its children's boxes, one byte per child: least x, largest x, then the same for y and z,
///   in
///     255ths of the node's own box, rounded outwards.
/// Triangle k of a fan that begins at corner f has the corners f, f + k + 1 and f + k + 2. A
/// child's number is greater than its parent's. Views; nothing is owned.
struct Bvh {
  Vector3 origin = Vector3::Zero();  ///< lowest corner of the root's box, m
  std::array<float, 3> size{};       ///< of that box, m
  std::span<const std::uint32_t> words;
};

inline constexpr std::size_t bvh_node_words = 10;
inline constexpr std::size_t bvh_children = 4;
inline constexpr std::uint32_t max_fan_triangles = 64;
inline constexpr std::uint32_t max_bvh_elements = 1U << 24U;
/// Largest depth of the tree, in nodes.
inline constexpr int bvh_levels = 48;

/// A child, unpacked from its word.
struct BvhChild {
  ElementKind kind = ElementKind::none;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

[[nodiscard]] constexpr BvhChild unpack_child(std::uint32_t word) noexcept {
  return {static_cast<ElementKind>(word >> 30U), word & 0xFFFFFFU, ((word >> 24U) & 63U) + 1};
}
[[nodiscard]] constexpr std::uint32_t pack_child(const BvhChild& child) noexcept {
  return static_cast<std::uint32_t>(child.kind) << 30U | (child.count - 1) << 24U | child.first;
}

/// A box relative to the tree's origin, m; in floats, as the query computes.
struct BvhBox {
  std::array<float, 3> low, high;
};

/// The box of a node's child.
[[nodiscard]] inline BvhBox child_box(const BvhBox& box, const std::uint32_t* node,
                                      std::size_t child) noexcept {
  BvhBox result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float step = (box.high[axis] - box.low[axis]) * (1.0F / 255);
    const std::uint32_t low = (node[4 + 2 * axis] >> (8 * child)) & 255U;
    const std::uint32_t high = (node[5 + 2 * axis] >> (8 * child)) & 255U;
    result.low[axis] = box.low[axis] + static_cast<float>(low) * step;
    result.high[axis] = box.low[axis] + static_cast<float>(high) * step;
  }
  return result;
}

/// The boxes of a node's children, as child_box gives them, and the squares of their distances from
/// a point, m and m^2. Also filled for absent children.
struct NodeBoxes {
  using Lanes = std::array<float, bvh_children>;  ///< one number per child
  alignas(16) std::array<Lanes, 3> low, high;
  alignas(16) Lanes squares;

  [[nodiscard]] BvhBox box(std::size_t child) const noexcept {
    return {{low[0][child], low[1][child], low[2][child]},
            {high[0][child], high[1][child], high[2][child]}};
  }
};

/// Computes these boxes and squares, all four at once. `box` is the node's own. A NaN point gives
/// 0.
void find_node_boxes(const BvhBox& box, const std::uint32_t* node,
                     const std::array<float, 3>& place, NodeBoxes& found) noexcept;

/// A point relative to the tree's origin, m; in floats, as the query computes.
[[nodiscard]] inline std::array<float, 3> from_origin(const Bvh& bvh,
                                                      const Vector3& point) noexcept {
  const Vector3 place = point - bvh.origin;
  return {static_cast<float>(place.x()), static_cast<float>(place.y()),
          static_cast<float>(place.z())};
}

/// Calls `visit(child)` for the leaves that may lie nearer to a point than `limit()` (m), nearest
/// boxes first. The limit may shrink on the way. Terminates for any words: it opens at most as many
/// nodes as there are.
template <class Visit, class Limit>
void visit_elements(const Bvh& bvh, const Vector3& point, const Visit& visit,
                    const Limit& limit) noexcept {
  // Left uninitialised: only pushed entries are read, and there are many.
  struct Pending {
    float square;
    std::uint32_t word;
    BvhBox box;
  };
  std::array<Pending, static_cast<std::size_t>(bvh_levels) * (bvh_children - 1) + bvh_children>
      stack;
  const std::array<float, 3> place = from_origin(bvh, point);
  const std::size_t nodes = bvh.words.size() / bvh_node_words;
  if (nodes == 0) return;
  stack[0] = {0, pack_child({ElementKind::node, 0, 1}), {{}, bvh.size}};
  std::size_t pending = 1;
  std::size_t left = nodes;
  NodeBoxes boxes;
  while (pending > 0) {
    const Pending next = stack[--pending];
    const double bound = limit();
    if (static_cast<double>(next.square) > bound * bound) continue;
    const BvhChild child = unpack_child(next.word);
    if (child.kind != ElementKind::node) {
      visit(child);
      continue;
    }
    if (child.first >= nodes || left == 0) continue;
    --left;
    const std::uint32_t* node = bvh.words.data() + child.first * bvh_node_words;
    find_node_boxes(next.box, node, place, boxes);
    // Pushed farthest first, so that the nearest is popped first.
    std::array<std::size_t, bvh_children> order;
    std::size_t count = 0;
    for (std::size_t k = 0; k < bvh_children; ++k) {
      const float square = boxes.squares[k];
      if (unpack_child(node[k]).kind == ElementKind::none ||
          static_cast<double>(square) > bound * bound) {
        continue;
      }
      std::size_t at = count++;
      for (; at > 0 && boxes.squares[order[at - 1]] < square; --at) order[at] = order[at - 1];
      order[at] = k;
    }
    for (std::size_t i = 0; i < count && pending < stack.size(); ++i, ++pending) {
      const std::size_t k = order[i];
      stack[pending] = {boxes.squares[k], node[k], boxes.box(k)};
    }
  }
}

}  // namespace spm
