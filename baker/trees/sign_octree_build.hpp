// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "baker/reachability/reachability.hpp"
#include "common/asset/sign_octree.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// A cube of the sign octree while it is built.
struct SignOctreeNode {
  SignKind kind = SignKind::boundary;
  PruneRule rule = PruneRule::none;  ///< of a pruned one
  Vector3 middle = Vector3::Zero();
  double edge = 0;
  std::unique_ptr<std::array<SignOctreeNode, 8>> octants;
};

/// Builds and writes the sign octree: it divides the space around a surface into cubes. There are
/// cubes that lie on one side, since their middle is farther from the surface than their corners
/// are from the middle. There are cubes that the bake leaves out. And there are cubes through which
/// the surface passes, where the elements tell the side.
class SignOctreeBuilder {
 public:
  /// `reachability` may be null: then nothing is left out. Keeps references.
  SignOctreeBuilder(const Caster& caster, const Band& band, double tolerance,
                    const Reachability* reachability, const Progress& progress);

  /// Divides the cubes around a point of the band down to one that lies on one side: for places
  /// where the elements give the wrong side. False where the point is in such a cube already, or
  /// where no division helps.
  bool resolve(const Vector3& point);

  /// The kind of the cube around a point; `far` outside all cubes.
  [[nodiscard]] SignKind place(const Vector3& point) const;

  /// Calls `visit` with every cube that is not divided.
  void visit_leaves(const std::function<void(const SignOctreeNode&)>& visit) const;

  /// The octree in the words that the file stores; see SignOctree.
  [[nodiscard]] SignOctreeData data() const;

 private:
  const Caster& caster_;
  Band band_;
  double tolerance_;
  const Reachability* reachability_;
  SignOctreeNode root_;

  void decide(SignOctreeNode& node, int level) const;
};

}  // namespace spm::baker
