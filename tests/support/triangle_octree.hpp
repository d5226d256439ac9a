// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "tests/support/octree_by_hand.hpp"
#include "tests/support/shapes.hpp"

namespace spm::test {

/// On which side places lie that are nearest to a side or corner of a shape's triangles: told by
/// normals where two triangles are nearly flat, else outside where all of its sides are convex,
/// inside where all are concave, and by crossings where some are.
class ShapeSides {
 public:
  explicit ShapeSides(const Shape& shape) : shape_(shape), corners_(shape.vertices.size()) {
    for (std::uint32_t t = 0; t < shape.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) opposite_[side(t, k)] = shape.triangles[t][(k + 2) % 3];
    }
    for (std::uint32_t t = 0; t < shape.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const FeatureSide found = at_side(t, k);
        if (found == FeatureSide::by_normal) continue;
        for (const std::uint32_t vertex : {side(t, k).first, side(t, k).second}) {
          corners_[vertex] |= 1U << static_cast<unsigned>(found);
        }
      }
    }
  }

  [[nodiscard]] FeatureSides of(std::uint32_t triangle) const {
    FeatureSides sides = 0;
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t met = corners_[side(triangle, k).first];
      const FeatureSide corner = met == 2U   ? FeatureSide::outside
                                 : met == 4U ? FeatureSide::inside
                                 : met == 0U ? FeatureSide::by_normal
                                             : FeatureSide::by_crossings;
      sides = static_cast<FeatureSides>(
          sides | pack_side(static_cast<TriangleFeature>(1 + k), at_side(triangle, k)) |
          pack_side(static_cast<TriangleFeature>(4 + k), corner));
    }
    return sides;
  }

 private:
  using Side = std::pair<std::uint32_t, std::uint32_t>;
  const Shape& shape_;
  std::map<Side, std::uint32_t> opposite_;  ///< the third corner of a triangle with this side
  std::vector<std::uint32_t> corners_;      ///< one bit for each FeatureSide met there

  [[nodiscard]] Side side(std::uint32_t triangle, std::size_t k) const {
    const auto& corners = shape_.triangles[triangle];
    return {corners[k], corners[(k + 1) % 3]};
  }

  [[nodiscard]] Vector3 normal(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vector3& at = shape_.vertices[a];
    return (shape_.vertices[b] - at).cross(shape_.vertices[c] - at).normalized();
  }

  [[nodiscard]] FeatureSide at_side(std::uint32_t triangle, std::size_t k) const {
    constexpr double flat_cosine = 0.9;
    const auto [a, b] = side(triangle, k);
    const auto other = opposite_.find({b, a});
    if (other == opposite_.end()) return FeatureSide::by_normal;
    const Vector3 mine = normal(a, b, shape_.triangles[triangle][(k + 2) % 3]);
    if (mine.dot(normal(b, a, other->second)) > flat_cosine) return FeatureSide::by_normal;
    const double above = mine.dot(shape_.vertices[other->second] - shape_.vertices[a]);
    return above > 0 ? FeatureSide::inside : FeatureSide::outside;
  }
};

/// A shape with its corners rounded as triangle_octree rounds them.
[[nodiscard]] inline Shape on_lattice(Shape shape, double step) {
  for (Vector3& vertex : shape.vertices) vertex = step * (vertex / step).array().round().matrix();
  return shape;
}

/// A cube of space.
struct CubeOfSpace {
  Vector3 low = Vector3::Zero();
  double edge = 0;
};

/// A shape whose triangles each begin with their shortest side, as exact ones do.
[[nodiscard]] inline Shape shortest_first(Shape shape) {
  const auto length = [&shape](const auto& corners, std::size_t k) {
    return (shape.vertices[corners[(k + 1) % 3]] - shape.vertices[corners[k]]).norm();
  };
  for (auto& corners : shape.triangles) {
    std::size_t shortest = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (length(corners, k) < length(corners, shortest)) shortest = k;
    }
    std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(shortest),
                corners.end());
  }
  return shape;
}

/// The octree of a shape that is one cube, with all of the shape's triangles in its list: right
/// everywhere, and slow. Corners are rounded to a lattice about the origin, `step` metres apart.
/// The baker's own builder is not linked here.
[[nodiscard]] inline OctreeData triangle_octree(const Shape& any, const CubeOfSpace& space,
                                                double step, ListSide side = ListSide::surface) {
  OctreeData octree;
  octree.origin = space.low;
  octree.edge = space.edge;
  octree.roots = {1, 1, 1};
  octree.reach = space.edge;
  set_lattice(octree, Vector3::Zero(), step);
  const Shape shape = shortest_first(any);
  const ShapeSides sides(shape);
  std::vector<std::uint32_t> list;
  for (std::uint32_t t = 0; t < shape.triangles.size(); ++t) {
    TriangleByHand triangle;
    triangle.sides = sides.of(t);
    for (std::size_t k = 0; k < 9; ++k) {
      const double place = shape.vertices[shape.triangles[t][k / 3]][static_cast<int>(k % 3)];
      triangle.corners[k / 3][k % 3] = static_cast<std::int32_t>(std::lround(place / step));
    }
    list.push_back(add_triangle(octree, triangle));
  }
  auto unit = add_list(octree, list, {}, side);
  // The space is around the shape.
  if (side == ListSide::surface) unit[1] |= list_word(0, 0, side, false, KnownPlace{});
  octree.words.assign(unit.begin(), unit.end());
  octree.root_words = {root_word(OctreeKind::list, 0)};
  return octree;
}

}  // namespace spm::test
