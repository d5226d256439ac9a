// SPDX-License-Identifier: Apache-2.0
#include "servo/force/tool_settings.hpp"

namespace spm {

bool ToolSettings::operator==(const ToolSettings& other) const noexcept {
  return asset == other.asset && placement.position == other.placement.position &&
         placement.rotation.coeffs() == other.placement.rotation.coeffs() &&
         placement.scale == other.placement.scale && coupling == other.coupling &&
         turning == other.turning && torque_cap == other.torque_cap && spacing == other.spacing &&
         samples == other.samples && budget == other.budget;
}

}  // namespace spm
