// SPDX-License-Identifier: Apache-2.0
#include "servo/device_list.hpp"

#include "servo/device_sim.hpp"

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

Result<std::unique_ptr<Device>> make_device(const std::string& specification) {
  const std::size_t colon = specification.find(':');
  const std::string name = specification.substr(0, colon);
  const std::string options =
      colon == std::string::npos ? std::string() : specification.substr(colon + 1);
  if (name == "auto" && colon != std::string::npos) {
    return fail(ExitCode::usage,
                "--device auto takes no options; name the device, as in sim:" + options);
  }
  if (name != "sim" && name != "auto") {
    return fail(ExitCode::usage,
                "--device '" + name + "' is not known; the devices are auto and sim");
  }
  const Result<SimOptions> parsed = parse_sim_options(options);
  if (!parsed) return tl::make_unexpected(parsed.error());
  return std::make_unique<DeviceSim>(*parsed);
}

}  // namespace spm::servo
