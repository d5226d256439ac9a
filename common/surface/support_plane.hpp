// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/vector.hpp"

namespace spm {

/// A support plane of an object (Definition 1): it touches the object, which lies on its negative
/// side. In the object's frame, metres. u, v, n are an orthonormal, right-handed basis: n = u x v,
/// and n points away from the object.
struct SupportPlane {
  Vector3 x0 = Vector3::Zero();
  Vector3 u = Vector3::UnitX();
  Vector3 v = Vector3::UnitY();
  Vector3 n = Vector3::UnitZ();
};

/// Point of the support plane at the parameters (eta, omega), metres: eq. 1.
[[nodiscard]] inline Vector3 support_plane_point(const SupportPlane& plane, double eta,
                                                 double omega) noexcept {
  return plane.x0 + eta * plane.u + omega * plane.v;
}

/// S_SP of eq. 3: depth of a point below the plane, metres; positive on the object's side.
[[nodiscard]] inline double support_plane_depth(const SupportPlane& plane,
                                                const Vector3& point) noexcept {
  return plane.n.dot(plane.x0 - point);
}

/// A point in the frame of a plane: the parameters of its projection P_M, and its depth S_SP;
/// metres.
struct PlaneCoordinates {
  double eta = 0;
  double omega = 0;
  double depth = 0;
};

/// Projects a point on the plane along its normal (P_M and S_SP of Fig. 3).
[[nodiscard]] inline PlaneCoordinates project_on_plane(const SupportPlane& plane,
                                                       const Vector3& point) noexcept {
  const Vector3 offset = point - plane.x0;
  return {offset.dot(plane.u), offset.dot(plane.v), -offset.dot(plane.n)};
}

/// Transforms a vector from the plane's frame (along u, v and -n) to the object's frame.
[[nodiscard]] inline Vector3 from_plane_frame(const SupportPlane& plane, double along_u,
                                              double along_v, double below) noexcept {
  return along_u * plane.u + along_v * plane.v - below * plane.n;
}

}  // namespace spm
