// SPDX-License-Identifier: Apache-2.0
#include "servo/force/default_settings.hpp"

#include "common/contact/turn_limit.hpp"
#include "servo/stabilize/matched_damping.hpp"

namespace spm {

FeltLimits felt_limits(const ForceDevice& device, double tick) noexcept {
  const StabilizationSettings loop =
      device.profile != nullptr ? in_loop_of(*device.profile, {}) : StabilizationSettings{};
  const DeviceProfile& kind = device.profile != nullptr ? *device.profile : worst_device_profile;
  return {device.stiffness_cap, max_damping(loop.device_mass, tick, loop.total_delay(tick)),
          margin_below_border(kind)};
}

ForceDevice least_stiff(std::span<const ForceDevice> devices) noexcept {
  ForceDevice least;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    if (i == 0 || auto_stiffness(devices[i]) < auto_stiffness(least)) least = devices[i];
  }
  return least;
}

PlacedObject default_object(double stiffness, const ProbeShape& probe) noexcept {
  PlacedObject object;
  object.force.method = probe.paper_only() ? Method::paper : default_method;
  object.force.stiffness = stiffness;
  object.force.take_probe(probe);
  object.effects.turn.rate = default_turn_rate;
  return object;
}

}  // namespace spm
