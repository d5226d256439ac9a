// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// Generalised winding number of a triangle soup (Jacobson et al. 2013): 1 inside a closed solid
/// whose normals point out, 0 outside, in between near holes. Near triangles are summed exactly.
/// Far triangles are summed by clusters, each a Taylor expansion to second order (Barill et al.
/// 2018).
class WindingNumber {
 public:
  /// Copies what it needs. Indices must be in range. Degenerate triangles add nothing.
  WindingNumber(std::span<const Vector3> vertices, std::span<const Triangle> triangles);

  /// Within 1e-3 of the exact sum. A point on the surface takes the value of one of its sides.
  /// Thread-safe and deterministic.
  [[nodiscard]] double at(const Vector3& point) const noexcept;

 private:
  struct Cluster {
    Vector3 centre = Vector3::Zero();
    double near2 =
        0;  ///< squared distance from the centre within which the expansion is too coarse
    Vector3 area = Vector3::Zero();    ///< sum of area times normal
    double trace = 0;                  ///< of the first moment of area times normal
    std::array<double, 6> first{};     ///< its symmetric part: xx yy zz, 2xy 2yz 2zx
    Vector3 traces = Vector3::Zero();  ///< contractions of the second moment
    std::array<double, 10> second{};   ///< its symmetric part, over the monomials of degree 3
    std::uint32_t begin = 0, end = 0;  ///< its triangles
    std::uint32_t after = 0;           ///< next cluster that is not below this one
    bool leaf = false;
  };
  using Corners = std::array<Vector3, 3>;

  /// Where a triangle lies: the sum of its corners.
  struct Middle {
    Vector3 place = Vector3::Zero();
    std::uint32_t triangle = 0;
    std::uint32_t position = 0;  ///< among those that are divided with it
  };

  /// Makes the cluster of that number of some triangles, which come to lie from `begin` on, and
  /// those below it.
  void build(std::span<const Corners> unsorted, std::span<Middle> middles, std::uint32_t begin,
             std::uint32_t self);
  [[nodiscard]] Cluster summarise(std::uint32_t begin, std::uint32_t end) const;
  static void add_moments(const Corners& corners, Cluster& cluster);
  [[nodiscard]] static double expansion(const Cluster& cluster, const Vector3& point) noexcept;

  std::vector<Corners> triangles_;
  std::vector<Cluster> clusters_;  ///< in depth-first order
};

}  // namespace spm::baker
