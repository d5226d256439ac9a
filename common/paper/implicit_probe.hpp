// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "common/base/vector.hpp"

namespace spm {

/// The part of a line that lies within a probe, m along the line; `near` is above `far` where the
/// line misses the probe.
struct ProbeSpan {
  double near = std::numeric_limits<double>::infinity();
  double far = -std::numeric_limits<double>::infinity();

  [[nodiscard]] bool hit() const noexcept { return near <= far; }
};

/// A convex probe in implicit form. Section 3.2 only needs to know where a line along a support
/// plane's normal enters the probe, S-, and where it leaves it, S+. All in the object's frame,
/// metres.
class ImplicitProbe {
 public:
  ImplicitProbe(const ImplicitProbe&) = delete;
  ImplicitProbe& operator=(const ImplicitProbe&) = delete;
  virtual ~ImplicitProbe() = default;

  /// The span within the probe of the line origin + t direction; direction of unit length.
  [[nodiscard]] virtual ProbeSpan span(const Vector3& origin,
                                       const Vector3& direction) const noexcept = 0;
  /// The probe lies within `bounding_radius` of the segment from centre - half_axis to centre +
  /// half_axis; a probe without a long side has no half_axis.
  [[nodiscard]] virtual Vector3 centre() const noexcept = 0;
  [[nodiscard]] virtual Vector3 half_axis() const noexcept { return Vector3::Zero(); }
  [[nodiscard]] virtual double bounding_radius() const noexcept = 0;

 protected:
  ImplicitProbe() = default;
};

class SphereProbe final : public ImplicitProbe {
 public:
  /// `radius` above 0.
  SphereProbe(const Vector3& centre, double radius) noexcept : centre_(centre), radius_(radius) {}

  [[nodiscard]] ProbeSpan span(const Vector3& origin,
                               const Vector3& direction) const noexcept override;
  [[nodiscard]] Vector3 centre() const noexcept override { return centre_; }
  [[nodiscard]] double bounding_radius() const noexcept override { return radius_; }

 private:
  Vector3 centre_;
  double radius_;
};

/// All points within a radius of the line segment between two points.
class CapsuleProbe final : public ImplicitProbe {
 public:
  /// `radius` above 0; both ends may be the same point.
  CapsuleProbe(const Vector3& from, const Vector3& to, double radius) noexcept;

  [[nodiscard]] ProbeSpan span(const Vector3& origin,
                               const Vector3& direction) const noexcept override;
  [[nodiscard]] Vector3 centre() const noexcept override { return (from_ + to_) / 2; }
  [[nodiscard]] Vector3 half_axis() const noexcept override { return (to_ - from_) / 2; }
  [[nodiscard]] double bounding_radius() const noexcept override { return radius_; }

 private:
  Vector3 from_, to_;
  Vector3 along_ = Vector3::Zero();  ///< unit, from the one to the other; zero if both are the same
  double length_, radius_;
};

}  // namespace spm
