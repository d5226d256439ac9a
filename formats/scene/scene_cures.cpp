// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene_cures.hpp"

namespace spm {

namespace {

constexpr double most_share = 2;  // twice the energy that sampling gives back

}  // namespace

CureSettings read_cures(TableReader& cures, const DeviceProfile* device) {
  CureSettings read = cures.flag("advised", false) ? advised_cures : CureSettings{};
  if (device != nullptr) read = in_loop_of(*device, read);
  read.damping_share = cures.number("damping", 0, most_share, read.damping_share);
  read.delay_ticks = cures.number("delay", 0, most_delay_ticks, read.delay_ticks);
  read.coupling = cures.quantity("coupling", Quantity::stiffness, "2N/mm", read.coupling,
                                 TableReader::Least::zero);
  if (cures.has("coupling_damping") && !(read.coupling > 0)) {
    cures.refuse("coupling_damping",
                 "'coupling_damping' is beside the spring of a coupling; give 'coupling', such as "
                 "\"2N/mm\"");
  }
  read.coupling_damping = cures.quantity("coupling_damping", Quantity::damping, "1Ns/m",
                                         read.coupling_damping, TableReader::Least::zero);
  read.passivity = cures.flag("passivity", read.passivity);
  if (const auto word = cures.word("velocity", {"estimate", "difference"})) {
    read.velocity = *word == 0 ? VelocityBy::estimate : VelocityBy::difference;
  }
  read.potential = cures.quantity("potential", Quantity::length, "0.1mm", read.potential,
                                  TableReader::Least::zero);
  return read;
}

}  // namespace spm
