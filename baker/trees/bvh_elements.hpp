// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/options/bake_report.hpp"
#include "baker/proof/surface_proof.hpp"
#include "baker/trees/fallback_triangles.hpp"
#include "baker/trees/sign_octree_build.hpp"

namespace spm::baker {

/// Lays out the content of a `sparse` asset: its tiles and triangles in the order of the BVH, the
/// triangles as the file stores them, and the surface's caps last.
class BvhElements {
 public:
  /// Keeps references.
  BvhElements(const Caster& caster, const std::vector<SurfacePiece>& triangles, double tolerance);

  /// Fills the asset's tree and triangles, and puts its tiles in order. With a `reachability`, an
  /// element is left out if it is nearest to no place of the band but pruned ones. Returns the
  /// bytes that this saves, by rule.
  [[nodiscard]] std::vector<Pruned> build(Asset& asset, const SignOctreeBuilder& sign_octree,
                                          const Reachability* reachability) const;

 private:
  const Caster& caster_;
  const std::vector<SurfacePiece>& triangles_;
  FallbackTriangles form_;
};

}  // namespace spm::baker
