// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/asset/asset_view.hpp"

namespace spm {

/// A tile, or a triangle that no tile shows.
struct SurfaceElement {
  bool is_tile = false;
  std::uint32_t number = 0;  ///< of a tile
  /// Of a triangle, m.
  std::array<Vector3, 3> corners{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
};

/// What a `sparse` asset shows of its surface: triangles first, then tiles; found by place. Built
/// at load time (allocates).
class SurfaceElements {
 public:
  explicit SurfaceElements(const AssetView& asset);

  [[nodiscard]] std::size_t size() const noexcept { return elements_.size(); }
  [[nodiscard]] const SurfaceElement& operator[](std::size_t which) const noexcept {
    return elements_[which];
  }

  /// Whether `meets` is false for the numbers of all elements whose boxes come within `distance`
  /// (m) of a point.
  template <class Meets>
  [[nodiscard]] bool none_near(const Vector3& point, double distance, const Meets& meets) const {
    std::array<std::uint32_t, stack_size> stack{};
    std::size_t count = nodes_.empty() ? 0 : 1;
    while (count > 0) {
      const Node& node = nodes_[stack[--count]];
      if ((node.low - point).cwiseMax(point - node.high).maxCoeff() > distance) continue;
      if (node.leaf) {
        if (meets(node.first)) return false;
      } else if (count + 2 <= stack.size()) {
        stack[count++] = node.first;
        stack[count++] = node.second;
      }
    }
    return true;
  }

 private:
  static constexpr std::size_t stack_size = 128;  ///< more than twice the levels of a halved list
  struct Node {
    Vector3 low, high;
    bool leaf = true;
    std::uint32_t first = 0, second = 0;  ///< of a leaf the element
  };
  std::vector<SurfaceElement> elements_;
  std::vector<Node> nodes_;  ///< the root first

  std::uint32_t build(std::vector<Node>& leaves, std::size_t first, std::size_t last);
};

}  // namespace spm
