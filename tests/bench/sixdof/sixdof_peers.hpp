// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <string>

#include "common/sixdof/contact_sum.hpp"
#include "tests/bench/sixdof/sixdof_scene.hpp"

namespace spm::bench {

/// What a method says of a pose.
struct PeerAnswer {
  Vector3 force = Vector3::Zero();  ///< its direction; its size only where the method has our law
  std::uint64_t contacts = 0;
};

/// Another way to find the contacts of a tool and an object that stands still.
class Peer {
 public:
  Peer() = default;
  virtual ~Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  [[nodiscard]] virtual PeerAnswer ask(const Eigen::Isometry3d& tool_pose) = 0;
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual std::string settings() const = 0;
  /// Samples of the tool that it asks; 0 where it takes meshes.
  [[nodiscard]] virtual std::uint64_t samples() const { return 0; }
  /// True where its forces can be held against ours in size too.
  [[nodiscard]] virtual bool same_law() const { return false; }
};

/// Every sample asked of the baked field, none culled.
[[nodiscard]] std::unique_ptr<Peer> make_every_sample(const SurfaceSamples& tool,
                                                      const AssetView& object, double stiffness);

/// FCL: trees of OBB-RSS over both meshes, all pairs of triangles that meet; the force is the sum
/// of their normals times depths.
[[nodiscard]] std::unique_ptr<Peer> make_fcl(const BakedObject& tool, const BakedObject& object);

/// Bullet's GImpact for both meshes; the force as with FCL.
[[nodiscard]] std::unique_ptr<Peer> make_bullet(const BakedObject& tool, const BakedObject& object);

}  // namespace spm::bench
