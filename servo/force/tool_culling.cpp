// SPDX-License-Identifier: Apache-2.0
#include "servo/force/tool_culling.hpp"

#include <algorithm>

namespace spm {

bool ToolCulling::apart(std::size_t number, const ContactObject& object,
                        const Eigen::Isometry3d& pose, double reach) noexcept {
  constexpr double doubtful_tolerances = 2;
  const AssetView& field = *object.field;
  const double lift = std::max(object.texture.amplitude, 0.0);
  const double far = reach + lift + doubtful_tolerances * object.scale * field.tolerance;
  const Extent extent = extent_of(field);
  return objects_apart({extent.low, extent.low + extent.size, field.planes, object.scale}, *tool_,
                       object.pose.inverse(Eigen::Isometry) * pose, far,
                       last_[number]) != CullStage::none;
}

}  // namespace spm
