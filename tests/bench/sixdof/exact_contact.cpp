// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/sixdof/exact_contact.hpp"

#include "common/query/query.hpp"

namespace spm::bench {

Wrench exact_wrench(const SurfaceSamples& tool, const BakedObject& object,
                    const Eigen::Isometry3d& tool_pose, double stiffness) {
  const AssetView& field = object.view();
  const SampleLevel& finest = tool.levels.back();
  Wrench wrench;
  for (std::uint32_t i = finest.first; i < finest.first + finest.count; ++i) {
    const auto& position = tool.places[i].position;
    const Vector3 place = tool_pose * Vector3(position[0], position[1], position[2]);
    // Written so that a sample that is far, which has no distance, is left out.
    if (!(query_point(field, place).distance < 3 * field.tolerance)) continue;
    if (!object.truth.inside(place)) continue;
    // Depth times direction.
    const Vector3 out = object.truth.closest(place).position - place;
    const Vector3 force = stiffness * static_cast<double>(tool.shares[i].area) * out;
    wrench.force += force;
    wrench.torque += (place - tool_pose.translation()).cross(force);
  }
  return wrench;
}

}  // namespace spm::bench
