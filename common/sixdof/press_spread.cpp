// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/press_spread.hpp"

#include <algorithm>
#include <cmath>

namespace spm {

PressedSpread press_spread(const SpreadSpring& spread, std::uint64_t count,
                           ContactSum& sum) noexcept {
  const Vector3 &slope = spread.field.slope, &middle = spread.moments.middle, &arm = spread.arm;
  const Eigen::Matrix3d &bend = spread.field.bend, &second = spread.moments.second;
  // The depth at r from the place is depth - slope . r - r' bend r; its direction is normal + turn
  // r.
  const double depth = -spread.field.distance;
  const double along = slope.dot(middle), bent = bend.cwiseProduct(second).sum();
  const double mean = depth - along - bent;
  const Vector3& normal = spread.field.normal;
  const double size = slope.norm(), per = size > 0 ? 1 / size : 0;
  const Vector3 product = second * slope;
  const Vector3 offset = depth * middle - product;  // mean of depth times r
  PressedSpread made;
  const Vector3 force = mean * normal + 2 * per * (bend * offset);
  const double square = slope.dot(product);
  made.pressing = spread.spring * mean;
  made.force = spread.spring * force;
  made.torque = spread.spring * (arm.cross(force) + offset.cross(normal));
  made.moment = spread.spring * (mean * arm + offset);
  made.deepest = mean + std::sqrt(3 * std::max(0.0, square - along * along));
  // How the force changes as all are moved: as if their direction were that of their mean.
  const Vector3 turn = (arm + middle).cross(normal);
  const Eigen::Matrix3d arms =
      second + arm * arm.transpose() + arm * middle.transpose() + middle * arm.transpose();
  Eigen::Matrix3d cross;  // cross * arm = arm x normal
  cross << 0, normal[2], -normal[1], -normal[2], 0, normal[0], normal[1], -normal[0], 0;
  const Eigen::Matrix3d turns = cross * arms * cross.transpose();
  for (int row = 0; row < 3; ++row) {
    sum.wrench[row] += made.force[row];
    sum.wrench[3 + row] += made.torque[row];
    for (int column = 0; column < 3; ++column) {
      sum.stiffness(row, column) += spread.spring * normal[row] * normal[column];
      sum.stiffness(3 + row, column) += spread.spring * turn[row] * normal[column];
      sum.stiffness(3 + row, 3 + column) += spread.spring * turns(row, column);
    }
  }
  sum.energy += spread.spring / 2 * (depth * depth - 2 * depth * (along + bent) + square);
  sum.deepest = std::max(sum.deepest, made.deepest);
  sum.contacts += count;
  return made;
}

}  // namespace spm
