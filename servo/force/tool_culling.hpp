// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/sixdof/object_contact.hpp"

namespace spm {

/// The broad phase of a tool: whether an object is apart from it as a whole, by box and by support
/// planes (section 2.1: the step between bounding boxes and narrow phase). The object's side are
/// the support planes of its baked file (Definition 1): first the one that separated the two last,
/// then the one that the tool's middle is farthest outside of. The tool's side is the support
/// mapping of a coarse level of its samples, each with its sphere. No call allocates or throws.
class ToolCulling {
 public:
  /// `tool` must outlive this. Allocates.
  ToolCulling(const SurfaceSamples& tool, std::size_t objects);

  /// Whether an object is farther from the tool at `pose` (world) than `reach` (m), so that no
  /// motion by less makes it touch.
  [[nodiscard]] bool apart(std::size_t number, const ContactObject& object,
                           const Eigen::Isometry3d& pose, double reach) noexcept;

 private:
  const SurfaceSamples* tool_;
  SampleLevel level_;
  double grown_ = 0;                 ///< m: what the surface may stand out of the samples' spheres
  std::vector<std::uint32_t> last_;  ///< by objects: the plane that separated last

  [[nodiscard]] double gap(const SupportPlane& plane, double scale,
                           const Eigen::Isometry3d& to_object) const noexcept;
};

}  // namespace spm
