// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "baker/mesh/sliver_removal.hpp"

namespace spm::baker {

/// The triangles around a vertex, which are a disk, over a plane along the mean of their normals.
class VertexPatch {
 public:
  static constexpr std::size_t most = 16;  ///< triangles

  /// Empty where they are no disk of the surface, too many, or fold over the plane. `star` holds
  /// the numbers of the triangles that have the vertex.
  static std::optional<VertexPatch> around(std::uint32_t vertex,
                                           const std::vector<Vector3>& vertices,
                                           const std::vector<LooseTriangle>& triangles,
                                           std::span<const std::uint32_t> star);

  [[nodiscard]] std::size_t size() const { return count_; }
  /// The neighbours in order around the vertex.
  [[nodiscard]] std::span<const std::uint32_t> ring() const { return {ring_.data(), count_}; }
  [[nodiscard]] const Vector3& normal() const { return normal_; }  ///< unit, of the plane

  struct Shape {
    double least_height = 0;  ///< m, of a new triangle
    double least_cosine = 0;  ///< of the angle from a new triangle's normal to the plane's
  };
  /// The fan from the k-th neighbour that may replace the triangles; empty where it folds over the
  /// plane.
  [[nodiscard]] std::optional<Shape> shape_of_fan(std::size_t k) const;
  /// How far that fan, which must not fold, is from the triangles at most, along the normal, m.
  [[nodiscard]] double gap_of_fan(std::size_t k) const;

 private:
  std::size_t count_ = 0;
  std::array<std::uint32_t, most> ring_{};
  std::array<Vector3, most> places_{};  ///< of the ring in the plane and above it, from the vertex
  Vector3 normal_ = Vector3::Zero();

  [[nodiscard]] const Vector3& place(std::size_t k) const {
    return places_[k < count_ ? k : k - count_];
  }
  [[nodiscard]] double gap_at_vertex(std::size_t k) const;
  [[nodiscard]] double gap_along(std::size_t k, std::size_t to) const;
};

}  // namespace spm::baker
