// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "common/base/vector.hpp"
#include "common/field/feature_sides.hpp"

namespace spm {

/// Triangles of a cluster.
inline constexpr std::size_t cluster_size = 8;
/// Words of a cluster: a head of four, then the corners, then the sides.
inline constexpr std::size_t cluster_head = 4;
inline constexpr std::size_t cluster_words = cluster_head + 10 * cluster_size / 2;

/// The exact triangles of a `sparse` asset, in clusters of eight that lie close together. Views;
/// nothing is owned.
///
/// Corners lie on one lattice for all, so that triangles that share a corner share it exactly.
/// Words of a cluster:
///   0 to 2: lowest corner of its box, lattice steps from `origin`, signed;
///   3: bits 0-3 the number of triangles, bits 4-8 the shift, bit 9 set for caps, which decide the
///     side but carry no distance, bit 10 set where single precision will not do (exact), bits
///     16-23 which triangles no tile shows (bare);
///   then 72 numbers of 16 bits: for each corner, for each axis, one a triangle. A coordinate is
///     that of the box plus the number shifted to the left. The first side, from corner 0 to 1, is
///     the shortest. Triangles that are missing repeat the first;
///   then 8 numbers of 16 bits: the FeatureSides of each triangle.
struct TriangleClusters {
  Vector3 origin = Vector3::Zero();
  double step = 1;  ///< of the lattice, m
  std::span<const std::uint32_t> words;

  [[nodiscard]] std::size_t size() const noexcept { return words.size() / cluster_words; }
  /// The words of a cluster; null where it is not there.
  [[nodiscard]] const std::uint32_t* at(std::size_t cluster) const noexcept {
    return cluster < size() ? words.data() + cluster * cluster_words : nullptr;
  }
};

[[nodiscard]] constexpr std::uint32_t cluster_flags(std::uint32_t triangles, std::uint32_t shift,
                                                    bool caps, bool exact) noexcept {
  return triangles | shift << 4U | (caps ? 1U << 9U : 0U) | (exact ? 1U << 10U : 0U);
}
[[nodiscard]] inline std::uint32_t triangles_of(const std::uint32_t* cluster) noexcept {
  const std::uint32_t count = cluster[3] & 15U;
  return count < cluster_size ? count : std::uint32_t{cluster_size};
}
[[nodiscard]] inline std::uint32_t shift_of(const std::uint32_t* cluster) noexcept {
  return (cluster[3] >> 4U) & 31U;
}
[[nodiscard]] inline bool is_cap(const std::uint32_t* cluster) noexcept {
  return (cluster[3] >> 9U & 1U) != 0;
}
[[nodiscard]] inline bool is_exact(const std::uint32_t* cluster) noexcept {
  return (cluster[3] >> 10U & 1U) != 0;
}

/// Whether a triangle is part of the surface that no tile shows.
[[nodiscard]] inline bool is_bare(const std::uint32_t* cluster, std::size_t triangle) noexcept {
  return (cluster[3] >> (16U + triangle) & 1U) != 0;
}

/// Lowest corner of a cluster's box, m.
[[nodiscard]] inline Vector3 base_of(const TriangleClusters& clusters,
                                     const std::uint32_t* cluster) noexcept {
  std::array<std::int32_t, 3> at;
  std::memcpy(at.data(), cluster, sizeof at);
  return clusters.origin + clusters.step * Vector3(at[0], at[1], at[2]);
}

/// The corners of a triangle of a cluster, m.
[[nodiscard]] inline std::array<Vector3, 3> corners_of(const TriangleClusters& clusters,
                                                       const std::uint32_t* cluster,
                                                       std::size_t triangle) noexcept {
  std::array<std::int32_t, 3> base;
  std::memcpy(base.data(), cluster, sizeof base);
  const auto* numbers = reinterpret_cast<const char*>(cluster + cluster_head);
  std::array<Vector3, 3> corners;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::uint16_t number = 0;
      std::memcpy(&number, numbers + 2 * ((3 * corner + axis) * cluster_size + triangle), 2);
      const double steps = static_cast<double>(base[axis]) +
                           static_cast<double>(std::uint64_t{number} << shift_of(cluster));
      corners[corner][static_cast<int>(axis)] =
          clusters.origin[static_cast<int>(axis)] + clusters.step * steps;
    }
  }
  return corners;
}

[[nodiscard]] inline FeatureSides sides_of(const std::uint32_t* cluster,
                                           std::size_t triangle) noexcept {
  FeatureSides sides = 0;
  std::memcpy(
      &sides,
      reinterpret_cast<const char*>(cluster + cluster_head) + 2 * (9 * cluster_size + triangle), 2);
  return sides;
}

}  // namespace spm
