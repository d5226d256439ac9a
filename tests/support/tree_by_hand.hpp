// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include "common/asset/bvh.hpp"
#include "common/asset/sign_octree.hpp"

namespace spm::test {

/// A child of a node, and its box in 255ths of the node's box. The default is the whole box of the
/// node.
struct BoxedChild {
  BvhChild child;
  std::array<std::uint8_t, 3> low{0, 0, 0}, high{255, 255, 255};
};

inline BoxedChild node_child(std::uint32_t node) { return {{ElementKind::node, node, 1}}; }
inline BoxedChild tile_child(std::uint32_t tile) { return {{ElementKind::tile, tile, 1}}; }
/// A fan of `count` triangles that starts at corner `first`.
inline BoxedChild fan_child(std::uint32_t first, std::uint32_t count) {
  return {{ElementKind::fan, first, count}};
}

/// Adds a node of up to four children to a tree of elements.
inline void add_bvh_node(std::vector<std::uint32_t>& words,
                         const std::vector<BoxedChild>& children) {
  const std::size_t first = words.size();
  words.resize(first + bvh_node_words, 0);
  for (std::size_t k = 0; k < children.size(); ++k) {
    words.at(first + k) = pack_child(children[k].child);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      words.at(first + 4 + 2 * axis) |= std::uint32_t{children[k].low[axis]} << (8 * k);
      words.at(first + 5 + 2 * axis) |= std::uint32_t{children[k].high[axis]} << (8 * k);
    }
  }
}

/// A tree over leaves: each node holds three of them, and also the next node if there are more.
inline std::vector<std::uint32_t> bvh_over(const std::vector<BoxedChild>& leaves) {
  std::vector<std::uint32_t> words;
  for (std::size_t first = 0; first < leaves.size(); first += 3) {
    const std::size_t end = std::min(first + 3, leaves.size());
    std::vector<BoxedChild> children(leaves.begin() + static_cast<std::ptrdiff_t>(first),
                                     leaves.begin() + static_cast<std::ptrdiff_t>(end));
    if (end < leaves.size()) {
      children.push_back(node_child(static_cast<std::uint32_t>(first / 3 + 1)));
    }
    add_bvh_node(words, children);
  }
  return words;
}

/// The first word of a node of space whose octants are all of one kind, except those named.
inline std::uint32_t octants(SignKind rest,
                             std::initializer_list<std::pair<std::uint32_t, SignKind>> named = {}) {
  std::uint32_t kinds = 0;
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    SignKind kind = rest;
    for (const auto& [which, its_kind] : named) {
      if (which == octant) kind = its_kind;
    }
    kinds |= static_cast<std::uint32_t>(kind) << (sign_kind_bits * octant);
  }
  return kinds;
}

/// A chain of nodes: the last octant of each leads to the next node; that of the last is `end`.
inline std::vector<std::uint32_t> sign_octree_chain(int nodes, SignKind rest, SignKind end) {
  std::vector<std::uint32_t> words;
  for (int node = 1; node <= nodes; ++node) {
    const bool last = node == nodes;
    words.push_back(octants(rest, {{7, last ? end : SignKind::split}}));
    words.push_back(last ? 0 : static_cast<std::uint32_t>(node));
  }
  return words;
}

}  // namespace spm::test
