// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/asset_view.hpp"
#include "common/closest_element.hpp"
#include "common/element_units.hpp"

namespace spm {

/// Tells what can matter in a cube, by what is known to be near: the foot of its middle, and the
/// patch of surface around that. The distance to either is convex, and that to what lies behind a
/// plane is linear at least; so how much nearer the known is than another is least at a corner of
/// the cube.
class CubeReach {
 public:
  /// `nearest` is the foot of the cube's middle.
  CubeReach(const AssetView& asset, const Vector3& middle, double half, const ElementFoot& nearest);

  /// Whether a point of the cube can be so near to a box that the box is farther by less than
  /// `slack` (m) than what is known.
  [[nodiscard]] bool may_matter(const OrientedBox& box, double slack) const;

  /// Beyond this from the middle nothing can matter, m.
  [[nodiscard]] double farthest(double slack) const;

 private:
  using Corners = Eigen::Array<double, 8, 1>;  ///< a number for each of the cube's, m
  Vector3 middle_;
  double half_;
  double nearest_;
  std::vector<Corners> known_;  ///< how far the surface is at most

  [[nodiscard]] Vector3 corner(unsigned which) const;
  void know_tile(const AssetView& asset, const Tile& tile, std::uint32_t cell, int cells);
};

}  // namespace spm
