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

/// Which axis of a device, with which sign, becomes each of the world's: x to the right, y up, z
/// towards the user. All 48 choices are allowed; half of them mirror. Lengths and the work of a
/// force are kept exactly.
class DeviceAxes {
 public:
  /// The device's own.
  DeviceAxes() = default;

  /// Reads "+x-z+y": world x is the device's x, world y its z the other way round, world z its y.
  /// Nothing where that is not a sign and an axis three times, each axis once.
  [[nodiscard]] static std::optional<DeviceAxes> parse(std::string_view text);

  /// As `parse` takes it.
  [[nodiscard]] std::string text() const;

  [[nodiscard]] bool operator==(const DeviceAxes&) const = default;

  /// Whether they are of the other handedness than the device's.
  [[nodiscard]] bool mirrored() const noexcept;

  /// A position or a force.
  [[nodiscard]] Vector3 to_world(const Vector3& vector) const noexcept;
  [[nodiscard]] Vector3 from_world(const Vector3& vector) const noexcept;

  /// An angular velocity or a torque: its sense is by the right hand in either frame, so that a
  /// mirror turns it round.
  [[nodiscard]] Vector3 turn_to_world(const Vector3& vector) const noexcept;
  [[nodiscard]] Vector3 turn_from_world(const Vector3& vector) const noexcept;

  /// An orientation M R M^T, unit as it was: the tool's own axes are renamed as the device's, so
  /// that a tool that is not turned stays so, and a turn about an axis is one about its image.
  [[nodiscard]] Eigen::Quaterniond to_world(const Eigen::Quaterniond& orientation) const noexcept;
  [[nodiscard]] Eigen::Quaterniond from_world(const Eigen::Quaterniond& orientation) const noexcept;

 private:
  std::array<int, 3> axes_{0, 1, 2};  ///< the device's axis of each of the world's
  std::array<int, 3> signs_{1, 1, 1};
};

/// How any device is placed and limited, whatever its driver.
struct DevicePlacement {
  DeviceAxes axes;
  std::uint32_t clutch_button = 0;      ///< 1 to 32; 0: none
  std::optional<double> stiffness_cap;  ///< N/m, above 0; nothing: the driver's
  std::optional<Vector3> workspace;  ///< m, half edges, world frame; zero: no bound; nothing: the
                                     ///< driver's

  [[nodiscard]] bool operator==(const DevicePlacement&) const = default;
};

/// The options of a device's specification, those of any device taken out.
struct PlacedOptions {
  DevicePlacement placement;
  std::string own;  ///< what is left for the driver
};

/// Takes `axes=+x+y+z`, `clutch_button=N`, `stiffness_cap=STIFFNESS` and `workspace=AxBxC|off`
/// (edges of a box about the origin, along the world's axes, each a length with its unit) out of
/// what follows `device:`. Errors: usage, with the range or the form; one that is given twice.
[[nodiscard]] Result<PlacedOptions> take_placement(const std::string& device,
                                                   std::string_view options);

}  // namespace spm::servo
