// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "baker/fallback_triangles.hpp"
#include "baker/partition_records.hpp"
#include "common/grid_list.hpp"

namespace spm::baker {

/// Decides cubes of the partition: what lies in them, which elements their lists need, and whether
/// these tell the side right; see partition_tiles. Thread-safe.
class CubeDecider {
 public:
  /// Keeps references to all arguments; `asset` has its planes, metadata and grid's cell size.
  CubeDecider(const Asset& asset, const std::vector<Tile>& tiles, const Caster& caster,
              const FallbackTriangles& fallback, double tolerance, const PruneTest& prune);

  /// Elements that may matter in a cube whose middle is so far from the surface, out of all.
  [[nodiscard]] std::vector<std::uint32_t> all_near(const Vector3& middle, double edge,
                                                    double distance) const;

  /// Decides a cube and all below it; `near` holds the elements that may matter in it.
  void decide(PartitionNode& node, const std::vector<std::uint32_t>& near, int level) const;

  /// True where a leaf answers a point within the tolerance.
  [[nodiscard]] bool answers(const PartitionNode& leaf, const Vector3& point) const;

  /// Mends a leaf that answers a point wrong: cubes around the point are halved down to one that
  /// lies on one side or is smallest, which gets the surface's own triangles.
  void mend(PartitionNode& leaf, const Vector3& point) const;

 private:
  /// What one element says at the middle of a cube.
  struct Claim {
    double distance = std::numeric_limits<double>::infinity();
    bool inside = false;
    bool faces = false;
  };
  /// What a trial of a list at a point showed.
  struct Trial {
    bool right = true;
    bool faced = true;  ///< the nearest surface faces the point
  };

  const std::vector<Tile>& tiles_;
  const Caster& caster_;
  const FallbackTriangles& fallback_;
  double tolerance_;
  const PruneTest& prune_;
  Band band_;
  double smallest_edge_;
  AssetView view_;

  [[nodiscard]] Claim ask(std::uint32_t element, const Vector3& point, double limit) const;
  bool narrow(PartitionNode& node, const std::vector<std::uint32_t>& near, double radius) const;
  void tighten(PartitionNode& node, int times) const;
  void halve(PartitionNode& node, int level) const;
  [[nodiscard]] std::vector<std::uint32_t> words_of(const PartitionNode& node) const;
  [[nodiscard]] bool sides_hold(const PartitionNode& node, double distance, bool plain) const;
  [[nodiscard]] Trial try_lattice(const PartitionNode& node, int tries, const GridList& list) const;
  [[nodiscard]] Trial try_at(const Vector3& point, double truth, const GridList& list) const;
  void fall_back(PartitionNode& node, double distance) const;
};

}  // namespace spm::baker
