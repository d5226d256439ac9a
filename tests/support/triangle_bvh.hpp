// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "formats/asset/asset.hpp"

namespace spm::test {

/// Puts a `sparse` asset's triangles (floats) into a tree of elements. They are halved again and
/// again by their middles, and each is its own fan. The baker's own builder is not linked here.
class TriangleBvh {
 public:
  explicit TriangleBvh(Asset& asset) : asset_(asset) {
    for (std::size_t i = 0; i < asset.triangles.size(); i += 9) {
      Corners corners;
      std::copy_n(asset.triangles.begin() + static_cast<std::ptrdiff_t>(i), 9, corners.begin());
      triangles_.push_back(corners);
    }
    const Box all = box_of(0, triangles_.size());
    asset.bvh.origin = Vector3(all.low[0], all.low[1], all.low[2]) - Vector3::Constant(1e-5);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      asset.bvh.size[axis] = static_cast<float>(all.high[axis] - all.low[axis] + 2e-5);
    }
    add_node(0, triangles_.size(), {{}, asset.bvh.size});
    asset.triangles.clear();
    for (const Corners& corners : triangles_) {
      asset.triangles.insert(asset.triangles.end(), corners.begin(), corners.end());
    }
    asset.first_cap = static_cast<std::uint32_t>(3 * triangles_.size());
  }

 private:
  using Corners = std::array<float, 9>;
  struct Box {
    std::array<double, 3> low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  };

  Asset& asset_;
  std::vector<Corners> triangles_;

  [[nodiscard]] Box box_of(std::size_t first, std::size_t end) const {
    Box box;
    for (std::size_t i = first; i < end; ++i) {
      for (std::size_t k = 0; k < 9; ++k) {
        const auto value = static_cast<double>(triangles_[i][k]);
        box.low[k % 3] = std::min(box.low[k % 3], value);
        box.high[k % 3] = std::max(box.high[k % 3], value);
      }
    }
    return box;
  }

  void add_node(std::size_t first, std::size_t end, const BvhBox& box) {
    const Box extent = box_of(first, end);
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (extent.high[k] - extent.low[k] > extent.high[axis] - extent.low[axis]) axis = k;
    }
    std::sort(triangles_.begin() + static_cast<std::ptrdiff_t>(first),
              triangles_.begin() + static_cast<std::ptrdiff_t>(end),
              [axis](const Corners& a, const Corners& b) {
                return a[axis] + a[axis + 3] + a[axis + 6] < b[axis] + b[axis + 3] + b[axis + 6];
              });
    const std::size_t node = asset_.bvh.words.size();
    asset_.bvh.words.resize(node + bvh_node_words, 0);
    const std::size_t middle = (first + end) / 2;
    const std::array<std::array<std::size_t, 2>, 2> halves{{{first, middle}, {middle, end}}};
    for (std::size_t k = 0; k < 2; ++k) {
      const auto [from, to] = halves[k];
      if (from == to) continue;
      const Box part = box_of(from, to);
      for (std::size_t a = 0; a < 3; ++a) {
        const auto step = static_cast<double>(box.high[a] - box.low[a]) / 255;
        const double origin = asset_.bvh.origin[static_cast<int>(a)];
        const auto place = [&](double side) {
          return (side - origin - static_cast<double>(box.low[a])) / step;
        };
        const double low = std::clamp(std::floor(place(part.low[a]) - 0.01), 0.0, 255.0);
        const double high = std::clamp(std::ceil(place(part.high[a]) + 0.01), 0.0, 255.0);
        asset_.bvh.words[node + 4 + 2 * a] |= static_cast<std::uint32_t>(low) << (8 * k);
        asset_.bvh.words[node + 5 + 2 * a] |= static_cast<std::uint32_t>(high) << (8 * k);
      }
      const auto count = static_cast<std::uint32_t>(to - from);
      if (count == 1) {
        asset_.bvh.words[node + k] =
            pack_child({ElementKind::fan, static_cast<std::uint32_t>(3 * from), count});
        continue;
      }
      const auto next = static_cast<std::uint32_t>(asset_.bvh.words.size() / bvh_node_words);
      asset_.bvh.words[node + k] = pack_child({ElementKind::node, next, 1});
      add_node(from, to, child_box(box, asset_.bvh.words.data() + node, k));
    }
  }
};

/// Makes all octants of a `sparse` asset's space, a cube, of one kind.
inline void fill_sign_octree(Asset& asset, const Vector3& low, double edge, SignKind kind) {
  std::uint32_t kinds = 0;
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    kinds |= static_cast<std::uint32_t>(kind) << (sign_kind_bits * octant);
  }
  asset.sign_octree = {low, edge, {kinds, 0}};
}

}  // namespace spm::test
