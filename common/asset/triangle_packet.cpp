// SPDX-License-Identifier: Apache-2.0
#include "common/asset/triangle_packet.hpp"

#include <cmath>

namespace spm {

namespace {

/// Square of the sine between a triangle's sides, below which its normal is determined by rounding.
constexpr double thin_sine_squared = 1e-8;

void put(PacketVectors& to, std::size_t lane, const Vector3& from) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    to[static_cast<std::size_t>(axis)][lane] = static_cast<float>(from[axis]);
  }
}

float inverse_of(double square) noexcept {
  return square > 1e-30 ? static_cast<float>(1 / square) : 0.0F;
}

}  // namespace

void put_triangle(TrianglePacket& packet, std::size_t lane,
                  const std::array<Vector3, 3>& corners) noexcept {
  const Vector3 side = corners[1] - corners[0], other = corners[2] - corners[0];
  const double ss = side.squaredNorm(), so = side.dot(other), oo = other.squaredNorm();
  put(packet.corner, lane, corners[0]);
  put(packet.side, lane, side);
  put(packet.other, lane, other);
  packet.per_side[lane] = inverse_of(ss);
  packet.per_other[lane] = inverse_of(oo);
  packet.per_third[lane] = inverse_of((other - side).squaredNorm());
  const Vector3 normal = side.cross(other);
  const double area = normal.squaredNorm();
  const bool thin = !(area > thin_sine_squared * ss * oo);
  packet.min_share[lane] = thin ? no_share : 0;
  put(packet.normal, lane, thin ? Vector3(Vector3::Zero()) : Vector3(normal / std::sqrt(area)));
  put(packet.along_side, lane,
      thin ? Vector3(Vector3::Zero()) : Vector3((oo * side - so * other) / area));
  put(packet.along_other, lane,
      thin ? Vector3(Vector3::Zero()) : Vector3((ss * other - so * side) / area));
}

}  // namespace spm
