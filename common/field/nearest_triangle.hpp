// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/field/triangle_cluster.hpp"

namespace spm {

/// A triangle of a list: the place of its cluster there, and its own place in the cluster.
struct ListedTriangle {
  std::size_t entry = 0;
  std::size_t triangle = 0;
  float square = 0;  ///< of its distance, m^2, in single precision; infinite where there is none
};

/// The nearest triangle of a list (DistanceOctree), by several at once in single precision.
/// Clusters that are too far to matter are passed over: `reach` is what 255 of a list's bounds
/// stand for, m.
[[nodiscard]] ListedTriangle nearest_triangle(const TriangleClusters& clusters,
                                              std::span<const std::uint32_t> list, double reach,
                                              const Vector3& point) noexcept;

}  // namespace spm
