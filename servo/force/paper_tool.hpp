// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "common/paper/paper_volume.hpp"
#include "servo/force/force_budget.hpp"

namespace spm {

/// The planes by which two `full` assets see each other: of each the support plane that is most
/// parallel to the line between their centres (Definition 2).
struct PaperPlanes {
  std::size_t of1 = 0, of2 = 0;
  /// One of the two planes parts the objects (section 2.1), so that they share no volume; or one
  /// has no maps.
  bool apart = true;
};

/// `pose2` takes object 2's frame to object 1's, both in metres of their files.
[[nodiscard]] PaperPlanes paper_planes(const AssetView& object1, const AssetView& object2,
                                       const Eigen::Isometry3d& pose2) noexcept;

/// Object against object to the paper's letter (section 3.3): the volume that these planes see (eq.
/// 12 to 15), and the single force at its centre. `density`, `stride`: as of penetration_volume.
[[nodiscard]] PenetrationVolume paper_overlap(const AssetView& object1, const AssetView& object2,
                                              const Eigen::Isometry3d& pose2,
                                              const PaperPlanes& planes, double density = 1,
                                              std::uint32_t stride = 1) noexcept;

/// The area of a tool, m2, from which on its overlap with an object of stiffness K (N/m) pushes as
/// a spring of K does: a part of the sides of its box. Where less is pressed the spring is softer.
[[nodiscard]] double paper_tool_area(const AssetView& tool) noexcept;

/// Places of a `full` asset's surface by its maps (eq. 4), its frame, m: for each of `directions`
/// evenly spread ones the place that is farthest that way. Empty where no ray met it. Allocates.
[[nodiscard]] std::vector<Vector3> outermost_places(const AssetView& asset, std::size_t directions);

/// What a tick looks at: the objects that no plane parts from the tool, and how finely each is
/// looked at in the time that there is. Work is counted in cells of maps. Where it does not suffice
/// for all cells, every 2nd, 4th, ... sample is taken; objects that pressed in the last tick are
/// the last to be coarser. None is left out. Construction allocates, no other call does.
class PaperLooks {
 public:
  struct Look {
    std::uint32_t object = 0;  ///< its number
    PaperPlanes planes;
    Eigen::Isometry3d pose2 = Eigen::Isometry3d::Identity();
    std::uint32_t columns = 2, rows = 2;  ///< of the tool's map
    std::uint32_t level = 0;              ///< the stride is two to the power of it
  };

  explicit PaperLooks(std::size_t objects);

  void begin() noexcept { looks_.clear(); }
  /// With room for as many as the constructor was told.
  void add(const Look& look) noexcept { looks_.push_back(look); }
  /// Chooses the levels, and tells them. `own`: s of a tick that the tool may take; 0: any.
  void choose(const ForceBudget& budget, double own, ForceEffort& effort) noexcept;
  [[nodiscard]] std::span<const Look> looks() const noexcept { return looks_; }
  /// Whether an object pressed, for the next tick.
  void note(std::uint32_t object, bool pressed) noexcept { pressed_[object] = pressed ? 1 : 0; }
  /// All overlaps were computed: learns from the clock how long a cell takes.
  void end(const ForceBudget& budget) noexcept;
  /// None pressed.
  void forget() noexcept;

 private:
  /// Cells that there is time for.
  [[nodiscard]] std::uint32_t time_for(const ForceBudget& budget, double own) noexcept;
  void share_out(std::uint32_t cells) noexcept;

  std::vector<Look> looks_;
  std::vector<std::uint8_t> pressed_;              ///< by objects, in the last tick
  double cell_time_;                               ///< ns, what a cell takes by recent ticks
  std::uint32_t before_ = ForceEffort::unstopped;  ///< what there was time for in the last tick
  std::int64_t begun_ = 0;                         ///< ns
};

}  // namespace spm
