// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "common/base/placement.hpp"
#include "common/base/vector.hpp"

namespace spm {

/// A tool with six degrees of freedom, as a scene names it: an object that the hand holds. What is
/// 0 here and says so is chosen by the device and the tool's asset.
struct ToolSettings {
  std::size_t asset = 0;  ///< which of the scene's assets it is; a `sparse` one
  /// Pose of the tool's frame in the frame of the device's tool (m), and the tool's scale.
  Placement placement;
  double coupling = 0;  ///< N/m of the hand, of the virtual coupling; 0: chosen
  double turning = 0;   ///< N m/rad, of the same; 0: chosen
  /// N m, in addition to the device's own; 0: no torque is sent.
  double torque_cap = std::numeric_limits<double>::infinity();
  double spacing = 0;       ///< m of the tool's asset, between samples; 0: chosen
  std::size_t samples = 0;  ///< largest number of samples; 0: as many as the spacing gives
  double budget = 0;        ///< s of a tick that the tool may take; 0: the loop's budget alone

  [[nodiscard]] bool operator==(const ToolSettings& other) const noexcept {
    return asset == other.asset && placement.position == other.placement.position &&
           placement.rotation.coeffs() == other.placement.rotation.coeffs() &&
           placement.scale == other.placement.scale && coupling == other.coupling &&
           turning == other.turning && torque_cap == other.torque_cap && spacing == other.spacing &&
           samples == other.samples && budget == other.budget;
  }
};

/// A device's turning, as far as the forces on a tool depend on it.
struct HandTurning {
  bool reads = false;     ///< it tells its orientation
  double torque_cap = 0;  ///< N m, largest torque that may ever be sent; 0: it gives no torque
  double turn_step = 0;   ///< rad, smallest turn that it resolves
  double inertia = 1e-4;  ///< kg m2, the least about any axis
  double force_cap = std::numeric_limits<double>::infinity();  ///< N
};

/// ContactPatch::object where the tool of another device is touched: this, and the device's number.
inline constexpr std::uint32_t tool_of_device = 1U << 31U;

/// A place where the tool touches an object; world frame.
struct ContactPatch {
  Vector3 place = Vector3::Zero();   ///< m, the middle of the pressure
  Vector3 normal = Vector3::Zero();  ///< unit, out of the object
  Vector3 force = Vector3::Zero();   ///< N, on the tool
  double depth = 0;                  ///< m, the deepest sample
  std::uint32_t object = 0;          ///< which of the scene's objects; or tool_of_device
};

/// Largest number of patches that are told; the strongest are kept.
inline constexpr std::size_t max_patches = 16;

/// What a tool did in a tick.
struct ToolTick {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of the tool's frame, world
  std::array<ContactPatch, max_patches> patches{};
  std::size_t patch_count = 0;
  bool capped = false;   ///< the coupled force or torque met its cap
  bool leaving = false;  ///< it lay in an object, or in another tool, and is led out of it

  [[nodiscard]] std::span<const ContactPatch> contacts() const noexcept {
    return {patches.data(), patch_count};
  }
};

}  // namespace spm
