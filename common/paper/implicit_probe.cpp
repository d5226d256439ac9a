// SPDX-License-Identifier: Apache-2.0
#include "common/paper/implicit_probe.hpp"

#include <algorithm>
#include <cmath>

namespace spm {

ProbeSpan SphereProbe::span(const Vector3& origin, const Vector3& direction) const noexcept {
  const Vector3 to_centre = centre_ - origin;
  const double middle = to_centre.dot(direction);
  const double aside = (to_centre - middle * direction).squaredNorm();
  const double square = radius_ * radius_ - aside;
  // Written so that NaN counts as a miss.
  if (!(square >= 0)) return {};
  const double half = std::sqrt(square);
  return {middle - half, middle + half};
}

CapsuleProbe::CapsuleProbe(const Vector3& from, const Vector3& to, double radius) noexcept
    : from_(from), to_(to), length_((to - from).norm()), radius_(radius) {
  if (length_ > 0) along_ = (to - from) / length_;
}

ProbeSpan CapsuleProbe::span(const Vector3& origin, const Vector3& direction) const noexcept {
  ProbeSpan result;
  const auto include = [&result](const ProbeSpan& part) {
    if (!part.hit()) return;
    result.near = std::min(result.near, part.near);
    result.far = std::max(result.far, part.far);
  };
  // The capsule is convex, so its span runs from the first entry into one of its parts to the last
  // exit.
  include(SphereProbe(from_, radius_).span(origin, direction));
  include(SphereProbe(to_, radius_).span(origin, direction));
  if (!(length_ > 0)) return result;
  const Vector3 start = origin - from_;
  const Vector3 across = direction - direction.dot(along_) * along_;
  const Vector3 offset = start - start.dot(along_) * along_;
  const double a = across.squaredNorm(), b = across.dot(offset);
  const double c = offset.squaredNorm() - radius_ * radius_;
  const double square = b * b - a * c;
  if (!(a > 0) || !(square >= 0)) return result;
  for (const double root : {-std::sqrt(square), std::sqrt(square)}) {
    const double t = (root - b) / a;
    const double place = (start + t * direction).dot(along_);
    if (place >= 0 && place <= length_) include({t, t});
  }
  return result;
}

}  // namespace spm
