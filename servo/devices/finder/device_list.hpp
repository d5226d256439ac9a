// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "formats/scene/scene.hpp"
#include "servo/devices/base/device.hpp"
#include "servo/devices/finder/device_finder.hpp"

namespace spm::servo {

/// What `auto` is: the first device that was found and may be opened, as make_device takes it;
/// `simulated` where there is none.
[[nodiscard]] std::string first_of(const DeviceSearch& search, const std::string& simulated);

/// Makes the device that a command line asks for, NAME or NAME:option=value,..., with the options
/// of its driver and those that any device has (take_placement); it is not open yet. `auto` is the
/// first device found, and `simulated` where there is none. Errors: usage.
[[nodiscard]] Result<std::unique_ptr<Device>> make_device(const std::string& asked,
                                                          const std::string& simulated = "sim");

/// What a scene asks for, as make_device takes it: its driver, with the scene's profile where that
/// is simulated and names none; `auto` where the scene names no driver.
[[nodiscard]] std::string device_of(const SceneDevice& scene);

/// The simulated device that `auto` is for a scene where nothing is plugged in: of its profile.
[[nodiscard]] std::string simulated_device_of(const SceneDevice& scene);

}  // namespace spm::servo
