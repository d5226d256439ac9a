// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/culling/support_culling.hpp"
#include "common/sixdof/object_contact.hpp"

namespace spm {

/// The broad phase of a tool: `objects_apart` for each object of a scene, with the plane that
/// separated each of them from the tool last. No call allocates or throws.
class ToolCulling {
 public:
  /// `tool` must outlive this. Allocates.
  ToolCulling(const SupportHull& tool, std::size_t objects)
      : tool_(&tool), last_(objects, no_plane) {}

  /// Whether an object is farther from the tool at `pose` (world) than `reach` (m), so that no
  /// motion by less makes it touch.
  [[nodiscard]] bool apart(std::size_t number, const ContactObject& object,
                           const Eigen::Isometry3d& pose, double reach) noexcept;

 private:
  const SupportHull* tool_;
  std::vector<std::uint32_t> last_;  ///< by objects
};

}  // namespace spm
