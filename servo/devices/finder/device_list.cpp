// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/finder/device_list.hpp"

#include <string_view>

#include "servo/devices/base/device_placed.hpp"
#include "servo/devices/base/option_list.hpp"
#include "servo/devices/external/device_external.hpp"
#include "servo/devices/falcon/device_falcon.hpp"
#include "servo/devices/finder/device_finder.hpp"
#include "servo/devices/pid/device_pid.hpp"
#include "servo/devices/sim/device_sim.hpp"
#include "servo/devices/spacemouse/device_spacemouse.hpp"
#include "servo/devices/wooden/device_wooden.hpp"

namespace spm::servo {

namespace {

/// The simulated device, NAME or NAME:option=value,..., with a scene's profile unless it names one.
std::string with_profile(std::string device, const SceneDevice& scene) {
  if (scene.profile == nullptr || device.find("profile=") != std::string::npos) return device;
  device += device == "sim" ? ":profile=" : ",profile=";
  return device + std::string(scene.profile->name);
}

/// Makes a device from its own parsed options.
template <class Made, class Options>
Result<std::unique_ptr<Device>> made_of(const Result<Options>& options) {
  if (!options) return tl::make_unexpected(options.error());
  return std::make_unique<Made>(*options);
}

Result<std::unique_ptr<Device>> make_sim(const std::string& own, const DeviceAxes& axes) {
  const auto options = parse_sim_options(own);
  if (options && options->hand != HandKind::recorded && axes.mirrored()) {
    return option_error("sim", "axes=" + axes.text() +
                                   " mirrors, and a hand is planned in a scene that is not; change "
                                   "one sign, or give the hand's motion with hand=path");
  }
  return made_of<DeviceSim>(options);
}

/// Makes a device of that name from its driver's own options.
Result<std::unique_ptr<Device>> make_driver(const std::string& name, const PlacedOptions& all) {
  const std::string& options = all.own;
  if (name == "sim") return make_sim(options, all.placement.axes);
  if (name == "falcon") return made_of<DeviceFalcon>(parse_falcon_options(options));
  if (name == "woodenhaptics") return made_of<DeviceWooden>(parse_wooden_options(options));
  if (name == "spacemouse") return made_of<DeviceSpaceMouse>(parse_spacemouse_options(options));
  if (name == "pid") return made_of<DevicePid>(parse_pid_options(options));
  if (name == "external") return made_of<DeviceExternal>(parse_external_options(options));
  return fail(
      ExitCode::usage,
      "--device '" + name +
          "' is not known; the devices are auto, sim, falcon, woodenhaptics, spacemouse, pid "
          "and external");
}

}  // namespace

std::string device_of(const SceneDevice& scene) {
  if (scene.driver.empty()) return "auto";
  const bool simulated = scene.driver == "sim" || scene.driver.starts_with("sim:");
  return simulated ? with_profile(scene.driver, scene) : scene.driver;
}

std::string simulated_device_of(const SceneDevice& scene) { return with_profile("sim", scene); }

std::string first_of(const DeviceSearch& search, const std::string& simulated) {
  for (const FoundDevice& found : search.devices) {
    // Only the user can say how strong a pid device is.
    if (std::string_view(found.match.driver) == "pid") continue;
    if (found.match.shares_ids) continue;
    if (found.match.driven && found.permitted()) return specification_of(found);
  }
  return simulated;
}

Result<std::unique_ptr<Device>> make_device(const std::string& asked,
                                            const std::string& simulated) {
  const std::string specification = asked == "auto" ? first_of(find_devices(), simulated) : asked;
  const std::size_t colon = specification.find(':');
  const std::string name = specification.substr(0, colon);
  const std::string options =
      colon == std::string::npos ? std::string() : specification.substr(colon + 1);
  if (name == "auto") {
    return fail(ExitCode::usage,
                "--device auto takes no options; name the device, as in sim:" + options);
  }
  const auto split = take_placement(name, options);
  if (!split) return tl::make_unexpected(split.error());
  auto device = make_driver(name, *split);
  if (!device) return device;
  return place_device(std::move(*device), split->placement);
}

}  // namespace spm::servo
