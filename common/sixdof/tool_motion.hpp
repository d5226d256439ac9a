// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <span>

#include "common/sixdof/sample_vectors.hpp"
#include "common/sixdof/surface_samples.hpp"

namespace spm {

/// Upper bounds of the motion of a tool's parts from one pose to another, m.
class ToolMotion {
 public:
  ToolMotion(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) noexcept
      : turned_(to.linear() - from.linear()),
        moved_(to.translation() - from.translation()),
        // A rotation by t moves a point at distance r from the axis by 2 r sin(t / 2).
        turn_(turned_.norm() / std::sqrt(2.0) * (1 + 1e-9)) {}
  [[nodiscard]] double of(const Vector3& middle, double radius) const noexcept {
    return (turned_ * middle + moved_).norm() + turn_ * radius;
  }
  /// Of a sample and those below it.
  [[nodiscard]] double of(const SamplePlace& place) const noexcept {
    const Vector3 way = turned(turned_, place.position) + moved_;
    return way.norm() + turn_ * static_cast<double>(place.radius);
  }
  /// The same of each of many, as many `ways`, in single numbers so that several are found at once.
  void of_each(std::span<const SamplePlace> places, std::span<float> ways) const noexcept {
    const Eigen::Matrix3f turned = turned_.cast<float>();
    const Eigen::Vector3f moved = moved_.cast<float>();
    const auto turn = static_cast<float>(turn_);
    float* const way = ways.data();
    const SamplePlace* const place = places.data();
    const float a = turned(0, 0), b = turned(0, 1), c = turned(0, 2), d = turned(1, 0),
                e = turned(1, 1), f = turned(1, 2), g = turned(2, 0), h = turned(2, 1),
                i = turned(2, 2), u = moved[0], v = moved[1], w = moved[2];
    // What rounding may take from a sum of four parts.
    constexpr float rounding = 1e-6F;
    const float least = rounding * moved.norm(), per = 2 * rounding * turned.norm();
    for (std::size_t k = 0; k < ways.size(); ++k) {
      const float x = place[k].position[0], y = place[k].position[1], z = place[k].position[2];
      const float along_x = a * x + b * y + c * z + u, along_y = d * x + e * y + f * z + v,
                  along_z = g * x + h * y + i * z + w;
      const float length = std::sqrt(along_x * along_x + along_y * along_y + along_z * along_z);
      way[k] = (1 + rounding) * (length + turn * place[k].radius) + least +
               per * (std::abs(x) + std::abs(y) + std::abs(z));
    }
  }

 private:
  Eigen::Matrix3d turned_;
  Vector3 moved_;
  double turn_;
};

}  // namespace spm
