// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <string_view>

#include "common/base/device_profile.hpp"
#include "common/contact/stabilization_settings.hpp"
#include "common/contact/stable_stiffness.hpp"
#include "servo/force/placed_contact.hpp"

namespace spm {

/// What is served where nothing else is named: what is good in the most cases of the stability
/// laboratory, whose `default` is made of the same two.
inline constexpr Method default_method = Method::proxy;
inline constexpr std::string_view default_stabilization_words = "recommended";
inline constexpr const StabilizationSettings& default_stabilization = recommended_stabilization;

/// The device that forces are for, as far as they depend on it.
struct ForceDevice {
  const DeviceProfile* profile = nullptr;                          ///< null: of no known kind
  double stiffness_cap = std::numeric_limits<double>::infinity();  ///< N/m
};

/// The most that may be felt with a device, all objects together.
struct FeltLimits {
  double stiffness = std::numeric_limits<double>::infinity();  ///< N per metre of the hand, above 0
  double damping = std::numeric_limits<double>::infinity();    ///< N s/m, of eq. 18; 0 or more
  /// N per metre of the hand, above 0: what the device holds stably at one tick of delay and 1 kHz.
  /// Stiffness that is chosen for the device is held to it, and to less where the delay is longer.
  double stable = std::numeric_limits<double>::infinity();
};

/// The limits of a device in ticks of that length, s. The damping is what its moving mass bears.
[[nodiscard]] FeltLimits felt_limits(const ForceDevice& device, double tick) noexcept;

/// The stiffness that suits a device, N/m at the hand: what it holds stably. One of no known kind
/// gets what the worst one holds.
[[nodiscard]] constexpr double auto_stiffness(const ForceDevice& device) noexcept {
  const DeviceProfile& profile = device.profile != nullptr ? *device.profile : worst_device_profile;
  return std::min(stable_stiffness(profile), device.stiffness_cap);
}

/// Of several devices the one that suits the least stiffness; there may be none.
[[nodiscard]] ForceDevice least_stiff(std::span<const ForceDevice> devices) noexcept;

/// An object at the origin whose settings are all the default, but for the method where only
/// `paper` knows the probe. `stiffness` in N/m.
[[nodiscard]] PlacedObject default_object(double stiffness, const ProbeShape& probe) noexcept;

}  // namespace spm
