// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include "common/base/vector.hpp"

namespace spm::bench {

/// Counts along x, y and z; places in a regular grid are numbered with x fastest.
using GridCounts = std::array<int, 3>;

[[nodiscard]] inline std::size_t grid_number(const GridCounts& counts,
                                             const GridCounts& place) noexcept {
  return static_cast<std::size_t>(place[0]) +
         static_cast<std::size_t>(counts[0]) *
             (static_cast<std::size_t>(place[1]) +
              static_cast<std::size_t>(counts[1]) * static_cast<std::size_t>(place[2]));
}

[[nodiscard]] inline std::size_t grid_size(const GridCounts& counts) noexcept {
  return grid_number(counts, {0, 0, counts[2]});
}

/// The place that has a number.
[[nodiscard]] inline GridCounts grid_place(const GridCounts& counts, std::size_t number) noexcept {
  const auto columns = static_cast<std::size_t>(counts[0]);
  const auto rows = static_cast<std::size_t>(counts[1]);
  return {static_cast<int>(number % columns), static_cast<int>(number / columns % rows),
          static_cast<int>(number / columns / rows)};
}

[[nodiscard]] inline Vector3 grid_vector(const GridCounts& place) noexcept {
  return {static_cast<double>(place[0]), static_cast<double>(place[1]),
          static_cast<double>(place[2])};
}

}  // namespace spm::bench
