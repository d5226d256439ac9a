// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene_stabilization.hpp"

namespace spm {

namespace {

constexpr double max_share = 2;  // twice the energy that sampling gives back

}  // namespace

StabilizationSettings read_stabilization(TableReader& stabilization, const DeviceProfile* device) {
  StabilizationSettings read = stabilization.flag("recommended", false) ? recommended_stabilization
                                                                        : StabilizationSettings{};
  if (device != nullptr) read = in_loop_of(*device, read);
  read.damping_share = stabilization.number("damping", 0, max_share, read.damping_share);
  read.delay_ticks = stabilization.number("delay", 0, max_delay_ticks, read.delay_ticks);
  read.coupling = stabilization.quantity("coupling", Quantity::stiffness, "2N/mm", read.coupling,
                                         TableReader::Minimum::zero);
  if (stabilization.has("coupling_damping") && !(read.coupling > 0)) {
    stabilization.refuse(
        "coupling_damping",
        "'coupling_damping' is beside the spring of a coupling; give 'coupling', such as "
        "\"2N/mm\"");
  }
  read.coupling_damping = stabilization.quantity("coupling_damping", Quantity::damping, "1Ns/m",
                                                 read.coupling_damping, TableReader::Minimum::zero);
  read.passivity = stabilization.flag("passivity", read.passivity);
  if (const auto word = stabilization.word("velocity", {"estimate", "difference"})) {
    read.velocity = *word == 0 ? VelocityMethod::estimate : VelocityMethod::difference;
  }
  read.potential = stabilization.quantity("potential", Quantity::length, "0.1mm", read.potential,
                                          TableReader::Minimum::zero);
  return read;
}

}  // namespace spm
