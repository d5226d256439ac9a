// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/asset/asset_view.hpp"

namespace spm {

/// A place where a line meets the surface as an asset's answers tell it: where distances change
/// their sign. Asset's frame, m.
struct SurfaceCrossing {
  Vector3 place = Vector3::Zero();
  Vector3 normal = Vector3::Zero();  ///< unit, out of the solid
};

/// Lines along each axis through a box, evenly apart; the outermost are half of that inside it.
struct LineLattice {
  Vector3 low = Vector3::Zero();   ///< m
  Vector3 step = Vector3::Zero();  ///< m, at most what was asked for
  std::array<std::uint32_t, 3> count{};

  [[nodiscard]] double place(int axis, std::uint32_t number) const noexcept {
    return low[axis] + (number + 0.5) * step[axis];
  }
  /// Of all three families.
  [[nodiscard]] std::uint64_t lines() const noexcept {
    const std::uint64_t x = count[0], y = count[1], z = count[2];
    return x * y + y * z + z * x;
  }
};

/// The lattice over the mesh's box, or over the octree where that is not known. `step` above 0; at
/// most 2^20 lines side by side.
[[nodiscard]] LineLattice line_lattice(const AssetView& asset, double step) noexcept;

/// Finds crossings of lines with the surface of a `sparse` asset. A line goes from cube to cube of
/// the octree, and in each by as much as the answers say that the surface is away. So solids and
/// gaps that are thinner than the tolerance may be missed. Where two cubes do not agree, which is
/// within two tolerances, a line meets the surface once. Allocates: for loading, not for a tick.
class CrossingSearch {
 public:
  /// `most_queries`: how many answers may be asked for, since a broken file could need any number.
  CrossingSearch(const AssetView& asset, std::size_t most_queries);

  /// The crossings of the line along an axis through a place, in order. Valid until the next call;
  /// none once queries are used up.
  [[nodiscard]] const std::vector<SurfaceCrossing>& along(int axis, const Vector3& through);
  [[nodiscard]] bool exhausted() const noexcept { return left_ == 0; }

 private:
  enum class Side : std::uint8_t { unknown, outside, inside };
  /// What is known at a place of the line.
  struct Place {
    Vector3 at = Vector3::Zero(), normal = Vector3::Zero();
    double distance = 0;  ///< m
    Side side = Side::unknown;
  };
  const AssetView& asset_;
  double slack_, least_step_;
  std::size_t left_;
  std::vector<SurfaceCrossing> found_;

  [[nodiscard]] Place ask(const Leaf& leaf, const Vector3& place) noexcept;
  [[nodiscard]] Place between(const Leaf& leaf, int axis, Place before, Place after) noexcept;
  void walk_leaf(const Leaf& leaf, int axis, double end, Place& last);
  void meet(int axis, const Place& at, bool enters);
};

}  // namespace spm
