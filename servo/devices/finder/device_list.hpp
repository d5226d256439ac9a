// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "formats/scene/scene.hpp"
#include "servo/devices/base/device.hpp"
#include "servo/devices/finder/device_finder.hpp"

namespace spm::servo {

/// What `auto` means: the first device that was found and may be opened, in the form that
/// make_device takes; `simulated` if there is none.
[[nodiscard]] std::string first_of(const DeviceSearch& search, const std::string& simulated);

/// Makes the device that a command line asks for, NAME or NAME:option=value,..., with the options
/// of its driver and those of every device (take_placement). It is not open yet. `auto` is the
/// first device found, or `simulated` if there is none. Errors: usage.
[[nodiscard]] Result<std::unique_ptr<Device>> make_device(const std::string& asked,
                                                          const std::string& simulated = "sim");

/// The device that a scene asks for, in the form that make_device takes: its driver, with the
/// scene's profile if the driver is simulated and names none; `auto` if the scene names no driver.
[[nodiscard]] std::string device_of(const SceneDevice& scene);

/// The simulated device that `auto` means for a scene if nothing is plugged in: with the scene's
/// profile.
[[nodiscard]] std::string simulated_device_of(const SceneDevice& scene);

}  // namespace spm::servo
