// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::baker {

/// A box of space cut into cubes of one edge, m, numbered x fastest.
struct CubeGrid {
  Vector3 low = Vector3::Zero();
  double edge = 1;
  std::array<std::int64_t, 3> count{1, 1, 1};

  CubeGrid() = default;
  CubeGrid(const Vector3& low_, const Vector3& size, double edge_) : low(low_), edge(edge_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      count[axis] = static_cast<std::int64_t>(size[static_cast<int>(axis)] / edge) + 1;
    }
  }

  [[nodiscard]] std::size_t cubes() const {
    return static_cast<std::size_t>(count[0] * count[1] * count[2]);
  }
  [[nodiscard]] std::size_t number(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>((z * count[1] + y) * count[0] + x);
  }
  /// Where a coordinate lies along an axis, in whole cubes from the lowest.
  [[nodiscard]] double place(double coordinate, std::size_t axis) const {
    return std::floor((coordinate - low[static_cast<int>(axis)]) / edge);
  }
  /// The number of the cube that a point lies in; none outside the box.
  [[nodiscard]] std::optional<std::size_t> find(const Vector3& point) const {
    std::array<std::int64_t, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double where = place(point[static_cast<int>(axis)], axis);
      if (!(where >= 0 && where < static_cast<double>(count[axis]))) return std::nullopt;
      at[axis] = static_cast<std::int64_t>(where);
    }
    return number(at[0], at[1], at[2]);
  }
  /// Along each axis the cube that a point lies in, or the nearest of the box.
  [[nodiscard]] std::array<std::int64_t, 3> nearest(const Vector3& point) const {
    std::array<std::int64_t, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[axis] = static_cast<std::int64_t>(std::clamp(place(point[static_cast<int>(axis)], axis),
                                                      0.0, static_cast<double>(count[axis] - 1)));
    }
    return at;
  }
};

/// Numbers by the cube that they belong to; in each cube they keep the order that they came in.
class CubeBins {
 public:
  /// A cube and a number that belongs to it.
  using Member = std::pair<std::uint64_t, std::uint32_t>;

  CubeBins() : starts_(2, 0) {}
  CubeBins(std::size_t cubes, std::span<const Member> members)
      : starts_(cubes + 1, 0), numbers_(members.size()) {
    for (const Member& member : members) ++starts_[member.first + 1];
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    std::vector<std::uint64_t> next(starts_.begin(), starts_.end() - 1);
    for (const Member& member : members) numbers_[next[member.first]++] = member.second;
  }

  /// The numbers of the cubes from `first` to `last`.
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t first, std::size_t last) const {
    return std::span(numbers_).subspan(starts_[first], starts_[last + 1] - starts_[first]);
  }

 private:
  std::vector<std::uint64_t> starts_;
  std::vector<std::uint32_t> numbers_;
};

}  // namespace spm::baker
