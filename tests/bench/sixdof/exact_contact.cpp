// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/sixdof/exact_contact.hpp"

#include <algorithm>
#include <array>

namespace spm::bench {
namespace {

using Corners = std::array<Vector3, 3>;

class Overlap {
 public:
  Overlap(const baker::ExactSurface& object, const Vector3& about, double stiffness, double radius)
      : object_(object), about_(about), stiffness_(stiffness), radius_(radius) {}

  /// Adds a triangle's part; `near` is a point of the object's surface that may be close.
  void add(const Corners& corners, const baker::SurfacePoint* near) {
    const Vector3 middle = (corners[0] + corners[1] + corners[2]) / 3;
    double reach = 0;
    for (const Vector3& corner : corners) reach = std::max(reach, (corner - middle).norm());
    const baker::SurfacePoint closest =
        near != nullptr ? object_.closest(middle, *near) : object_.closest(middle);
    const Vector3 out = closest.position - middle;
    const bool whole = out.norm() > reach;
    if (whole && !object_.inside(middle)) return;
    if (reach > radius_) {
      split(corners, closest);
    } else if (whole || object_.inside(middle)) {
      const double area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 2;
      const Vector3 force = stiffness_ * area * out;
      wrench_.force += force;
      wrench_.torque += (middle - about_).cross(force);
    }
  }
  [[nodiscard]] const Wrench& wrench() const noexcept { return wrench_; }

 private:
  const baker::ExactSurface& object_;
  Vector3 about_;
  double stiffness_, radius_;
  Wrench wrench_;

  void split(const Corners& corners, const baker::SurfacePoint& near) {
    // By the middle of the longest edge.
    std::size_t longest = 0;
    double most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double length = (corners[(k + 1) % 3] - corners[k]).norm();
      if (!(length > most)) continue;
      most = length;
      longest = k;
    }
    const Vector3 &from = corners[longest], &to = corners[(longest + 1) % 3],
                  &opposite = corners[(longest + 2) % 3];
    const Vector3 middle = (from + to) / 2;
    add({from, middle, opposite}, &near);
    add({middle, to, opposite}, &near);
  }
};

}  // namespace

Wrench exact_wrench(const BakedObject& tool, const BakedObject& object,
                    const Eigen::Isometry3d& tool_pose, double stiffness, double radius) {
  Overlap overlap(object.truth, tool_pose.translation(), stiffness, radius);
  const baker::OuterSurface& surface = tool.surface;
  for (const auto& triangle : surface.triangles) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = tool_pose * surface.vertices[triangle[k]];
    overlap.add(corners, nullptr);
  }
  return overlap.wrench();
}

}  // namespace spm::bench
