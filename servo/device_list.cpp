// SPDX-License-Identifier: Apache-2.0
#include "servo/device_list.hpp"

#include "servo/device_sim.hpp"
#include "servo/devices/device_external.hpp"

namespace spm::servo {

std::string device_of(const SceneDevice& scene) {
  std::string device = scene.driver.empty() ? "auto" : scene.driver;
  const std::string name = device.substr(0, device.find(':'));
  const bool simulated = name == "sim" || name == "auto";
  if (scene.profile == nullptr || !simulated || device.find("profile=") != std::string::npos) {
    return device;
  }
  const std::string profile = "profile=" + std::string(scene.profile->name);
  if (device == name) return "sim:" + profile;
  return device + "," + profile;
}

namespace {

/// A device from what its own options parse to.
template <class Made, class Options>
Result<std::unique_ptr<Device>> made_of(const Result<Options>& options) {
  if (!options) return tl::make_unexpected(options.error());
  return std::make_unique<Made>(*options);
}

}  // namespace

Result<std::unique_ptr<Device>> make_device(const std::string& specification) {
  const std::size_t colon = specification.find(':');
  const std::string name = specification.substr(0, colon);
  const std::string options =
      colon == std::string::npos ? std::string() : specification.substr(colon + 1);
  if (name == "auto" && colon != std::string::npos) {
    return fail(ExitCode::usage,
                "--device auto takes no options; name the device, as in sim:" + options);
  }
  if (name == "sim" || name == "auto") return made_of<DeviceSim>(parse_sim_options(options));
  if (name == "external") return made_of<DeviceExternal>(parse_external_options(options));
  return fail(ExitCode::usage,
              "--device '" + name + "' is not known; the devices are auto, sim and external");
}

}  // namespace spm::servo
