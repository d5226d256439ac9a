// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/sixdof/contact_sum.hpp"
#include "tests/bench/sixdof/sixdof_scene.hpp"

namespace spm::bench {

/// The answer of a method for one pose.
struct PeerAnswer {
  Vector3 force = Vector3::Zero();  ///< the size counts only if same_law()
  std::optional<Vector3> torque;    ///< about the tool's origin, where it is known
  std::uint64_t contacts = 0;
};

/// Another method that finds the contacts between a tool and a fixed object.
class Peer {
 public:
  Peer() = default;
  virtual ~Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  [[nodiscard]] virtual PeerAnswer ask(const Eigen::Isometry3d& tool_pose) = 0;
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual std::string settings() const = 0;
  /// Number of tool samples that it queries; 0 if it works on meshes.
  [[nodiscard]] virtual std::uint64_t samples() const { return 0; }
  /// True if the size of its forces can be compared with ours, not only the direction.
  [[nodiscard]] virtual bool same_law() const { return false; }
};

/// The finest level: the baked field at every finest sample, each of which pushes by its depth.
[[nodiscard]] PeerAnswer press_every_sample(const SurfaceSamples& tool, const AssetView& object,
                                            const Eigen::Isometry3d& tool_pose, double stiffness);

/// Queries the baked field at every sample, without culling.
[[nodiscard]] std::unique_ptr<Peer> make_every_sample(const SurfaceSamples& tool,
                                                      const AssetView& object, double stiffness);

/// FCL: OBB-RSS trees over both meshes report all pairs of triangles that intersect. The force is
/// the sum of their normals times their depths.
[[nodiscard]] std::unique_ptr<Peer> make_fcl(const BakedObject& tool, const BakedObject& object);

/// Bullet's GImpact for both meshes. The force is computed as for FCL.
[[nodiscard]] std::unique_ptr<Peer> make_bullet(const BakedObject& tool, const BakedObject& object);

}  // namespace spm::bench
