// SPDX-License-Identifier: Apache-2.0
#include "servo/force/tool_coupling.hpp"

#include <algorithm>
#include <cmath>

#include "servo/stabilize/turning_lever.hpp"

namespace spm {

ToolCoupling tool_coupling(const ToolSettings& tool, const ToolLoop& loop) noexcept {
  ToolCoupling made;
  const double chosen = std::min(loop.suitable, loop.limits.stable * loop.stable_share);
  made.stiffness = std::min(tool.coupling > 0 ? tool.coupling : chosen, loop.limits.stiffness);
  const double per_turn = turning_lever * turning_lever;
  made.turning = tool.turning > 0 ? tool.turning : per_turn * made.stiffness;
  made.force_cap =
      std::isfinite(loop.turning.force_cap) ? loop.turning.force_cap : assumed_force_cap;
  made.torque = loop.turning.torque_cap > 0;
  made.torque_cap = std::min(made.torque ? loop.turning.torque_cap : made.force_cap * turning_lever,
                             tool.torque_cap);
  if (!std::isfinite(made.torque_cap)) made.torque_cap = made.force_cap * turning_lever;
  if (made.torque) {
    // By inertia and mass alike: what is stable depends on stiffness times tick squared over mass.
    const double stiffest = std::max(made.stiffness, loop.suitable);
    made.turning = std::min({made.turning, stiffest * loop.turning.inertia / loop.device_mass,
                             made.torque_cap / least_capped_turn});
  }
  return made;
}

}  // namespace spm
