// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/asset/asset_view.hpp"
#include "common/paper/paper_volume.hpp"

namespace spm {

/// Object against object to the paper's letter (section 3.3): of each object the support plane that
/// is most parallel to the line between their centres (Definition 2), the volume that these two
/// planes see (eq. 12 to 15), and the single force at its centre. Both assets must be `full`;
/// `pose2` takes object 2's frame to object 1's, both in metres of their files.
[[nodiscard]] PenetrationVolume paper_overlap(const AssetView& object1, const AssetView& object2,
                                              const Eigen::Isometry3d& pose2) noexcept;

/// The area of a tool, m2, from which on its overlap with an object of stiffness K (N/m) pushes as
/// a spring of K does: a part of the sides of its box. Where less is pressed the spring is softer.
[[nodiscard]] double paper_tool_area(const AssetView& tool) noexcept;

}  // namespace spm
