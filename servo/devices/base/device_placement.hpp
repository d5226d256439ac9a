// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/vector.hpp"

namespace spm::servo {

/// Which axis of a device, with which sign, becomes each of the world's axes: x to the right, y up,
/// z towards the user. All 48 choices are allowed; half of them mirror. Lengths and the work of a
/// force are preserved exactly.
class DeviceAxes {
 public:
  /// The device's own axes.
  DeviceAxes() = default;

  /// Reads "+x-z+y": world x is the device's x, world y is its z with the opposite sign, world z is
  /// its y. Nothing if the text is not three times a sign and an axis, with each axis once.
  [[nodiscard]] static std::optional<DeviceAxes> parse(std::string_view text);

  /// The text that `parse` reads.
  [[nodiscard]] std::string text() const;

  [[nodiscard]] bool operator==(const DeviceAxes&) const = default;

  /// Whether the handedness is the opposite of the device's.
  [[nodiscard]] bool mirrored() const noexcept;

  /// For a position or a force.
  [[nodiscard]] Vector3 to_world(const Vector3& vector) const noexcept;
  [[nodiscard]] Vector3 from_world(const Vector3& vector) const noexcept;

  /// For an angular velocity or a torque. Its sense follows the right-hand rule in either frame, so
  /// that a mirror reverses it.
  [[nodiscard]] Vector3 turn_to_world(const Vector3& vector) const noexcept;
  [[nodiscard]] Vector3 turn_from_world(const Vector3& vector) const noexcept;

  /// The orientation M R M^T, still unit. The tool's axes are renamed as the device's are: a tool
  /// that is not rotated stays so, and a rotation about an axis becomes one about the image of the
  /// axis.
  [[nodiscard]] Eigen::Quaterniond to_world(const Eigen::Quaterniond& orientation) const noexcept;
  [[nodiscard]] Eigen::Quaterniond from_world(const Eigen::Quaterniond& orientation) const noexcept;

 private:
  std::array<int, 3> axes_{0, 1, 2};  ///< the device's axis for each of the world's
  std::array<int, 3> signs_{1, 1, 1};
};

/// The placement and limits of any device, whatever its driver.
struct DevicePlacement {
  DeviceAxes axes;
  std::uint32_t clutch_button = 0;      ///< 1 to 32; 0: none
  std::optional<double> stiffness_cap;  ///< N/m, above 0; empty: the driver's
  /// m, half edges, world frame; zero: no bound; empty: the driver's
  std::optional<Vector3> workspace;

  [[nodiscard]] bool operator==(const DevicePlacement&) const = default;
};

/// The options of a device, split into those of every device and the driver's own.
struct PlacedOptions {
  DevicePlacement placement;
  std::string own;  ///< the rest, for the driver
};

/// Takes `axes=+x+y+z`, `clutch_button=N`, `stiffness_cap=STIFFNESS` and `workspace=AxBxC|off` out
/// of the text after `device:`. The edges of the workspace's box about the origin are along the
/// world's axes, each a length with its unit. Errors: usage, with the range or the form; an option
/// that is given twice.
[[nodiscard]] Result<PlacedOptions> take_placement(const std::string& device,
                                                   std::string_view options);

}  // namespace spm::servo
