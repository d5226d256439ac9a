// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::baker {

inline constexpr std::size_t edge_lanes = 4;

/// Directed edges, a coordinate of all in each array, metres. Where there are fewer, the rest run
/// from a point to itself, which no angle comes from.
struct EdgeBlock {
  using Coordinates = std::array<std::array<double, edge_lanes>, 3>;
  alignas(32) Coordinates from{};
  alignas(32) Coordinates to{};
};

using DirectedEdge = std::array<Vector3, 2>;
[[nodiscard]] std::vector<EdgeBlock> edge_blocks(std::span<const DirectedEdge> edges);

/// Triangles in the same form: `apex` is the corner that their edges, `base`, do not touch.
struct TriangleBlock {
  alignas(32) EdgeBlock::Coordinates apex{};
  EdgeBlock base;
};
[[nodiscard]] std::vector<TriangleBlock> triangle_blocks(
    std::span<const std::array<Vector3, 3>> triangles);

/// A sum of angles, radians. Small ones are added by multiplying complex numbers, four at a time,
/// which takes a tenth of the time of an arc tangent each.
class AngleSum {
 public:
  [[nodiscard]] double total() const;

  /// Adds half the solid angles under which `point` sees the triangles from an apex to each edge
  /// (Van Oosterom and Strackee 1983). A triangle with the point as a corner counts nothing.
  void add_fan(std::span<const EdgeBlock> edges, const Vector3& apex, const Vector3& point);

  /// The same for triangles that have no corner in common.
  void add_triangles(std::span<const TriangleBlock> triangles, const Vector3& point);

  /// Complex numbers x + i y.
  struct Lanes {
    alignas(32) std::array<double, edge_lanes> x{1, 1, 1, 1}, y{};
    /// The sum of their angles.
    [[nodiscard]] double angle() const;
  };

 private:
  double sum_ = 0;
  Lanes product_;  ///< angles that are not in the sum yet
};

}  // namespace spm::baker
