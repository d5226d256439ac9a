// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/base/cube_bins.hpp"
#include "baker/surface/outer_surface.hpp"

namespace spm::baker {

/// A side of a triangle, of which the k-th leads from its k-th corner to the next.
struct SideUse {
  std::uint32_t triangle = 0;
  std::uint32_t k = 0;
};

/// The sides of triangles, each known to all triangles that have it, whichever way they pass it.
class TriangleSides {
 public:
  explicit TriangleSides(std::span<const Triangle> triangles);

  [[nodiscard]] std::size_t count() const { return count_; }
  /// Its uses, in the order of the triangles; 3 t + k stands for the k-th side of triangle t.
  [[nodiscard]] std::span<const std::uint32_t> uses(std::size_t side) const {
    return uses_.of(side, side);
  }
  /// The uses of a triangle's k-th side, its own among them.
  [[nodiscard]] std::span<const std::uint32_t> uses(std::uint32_t triangle, std::size_t k) const {
    return uses(numbers_[3 * std::size_t{triangle} + k]);
  }
  [[nodiscard]] static SideUse use(std::uint32_t number) { return {number / 3, number % 3}; }

 private:
  std::size_t count_ = 0;
  std::vector<std::uint32_t> numbers_;  ///< of the three sides of each triangle
  CubeBins uses_;
};

}  // namespace spm::baker
