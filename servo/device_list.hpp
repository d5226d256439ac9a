// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "formats/scene.hpp"
#include "servo/device.hpp"

namespace spm::servo {

/// The first device that is plugged in and may be opened, as make_device takes it; `sim` where
/// there is none.
[[nodiscard]] std::string first_device_found();

/// Makes the device that a command line asks for, NAME or NAME:option=value,..., with the options
/// of its driver and those that any device has (take_placement); it is not open yet. `auto` is the
/// first device found, and the simulated one where there is none. Errors: usage.
[[nodiscard]] Result<std::unique_ptr<Device>> make_device(const std::string& asked);

/// What a scene asks for, as make_device takes it: its driver, with the scene's profile where that
/// is simulated and names none; `auto` where the scene says nothing.
[[nodiscard]] std::string device_of(const SceneDevice& scene);

}  // namespace spm::servo
