// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "servo/force/scene_force.hpp"
#include "formats/motion/recording.hpp"
#include "formats/motion/trajectory.hpp"
#include "servo/base/statistics.hpp"

namespace spm::servo {

enum class Pace {
  none,      ///< one tick after the other
  realtime,  ///< each tick at its time
};

/// What befell the force law in a tick of a recording, beside its position.
struct ReplayMark {
  bool forgot = false;  ///< it had forgotten what was before
  bool off = false;     ///< it was not asked: the force was off
};

struct ReplayOptions {
  ForceScene scene = scene_of({});
  double rate_hz = 1000;
  double encoder_step = 0;  ///< m, of the hand: how far a recorded position may be off
  /// N a metre of the hand, as the device's was.
  double stiffness_cap = std::numeric_limits<double>::infinity();
  Pace pace = Pace::none;
  std::vector<ReplayMark> marks;  ///< a row each; none: it was asked in every tick
};

/// What the loop's force law answered, a row of the trajectory each.
struct ReplayResult {
  std::vector<ContactForce> contacts;
  std::vector<std::int64_t>
      busy_ns;  ///< of the force law, single pass, the clock's own cost included
};

/// Runs the loop's own force law over recorded positions of the hand, in order, without the safety
/// stage. Writes to memory that was allocated before the first tick. `assets`: those that the
/// scene's objects name.
[[nodiscard]] ReplayResult replay(std::span<const AssetView* const> assets,
                                  const std::vector<TrajectorySample>& trajectory,
                                  const ReplayOptions& options);

/// Why the rows of a recording stop being those of the scene that its daemon began with.
enum class SceneChange {
  none,
  application,  ///< one moved, added or changed objects
  edit,         ///< an edited scene was taken up
};

/// One device's rows of a recording, as replay() takes them.
struct RecordedTicks {
  std::vector<TrajectorySample> trajectory;
  std::vector<ReplayMark> marks;
  std::vector<Vector3> wanted;             ///< N, what the law said then
  std::uint64_t lost = 0;                  ///< places where ticks are missing
  SceneChange change = SceneChange::none;  ///< the first one
  std::uint64_t changed_tick = 0;          ///< on the loop's grid, of the first row it was felt in
  /// Rows before it, whose forces a replay gives again; all of them where there is none.
  std::size_t comparable = 0;
};
[[nodiscard]] RecordedTicks ticks_of(const Recording& recording, std::size_t device);

/// How a replay's forces differ from those that were recorded, in the first rows.
struct ForceDifference {
  std::uint64_t ticks = 0;      ///< in which any bit differs
  std::uint64_t first_row = 0;  ///< the first of them
  double largest = 0;           ///< N
};
[[nodiscard]] ForceDifference difference(const ReplayResult& result,
                                         std::span<const Vector3> wanted);

/// Times of a replay's ticks, microseconds.
[[nodiscard]] Summary us_per_tick(const ReplayResult& result);

/// Sizes of the steps from tick to tick, |F_i - F_(i-1)|, N.
[[nodiscard]] Summary force_steps(const ReplayResult& result);

[[nodiscard]] std::uint64_t contact_ticks(const ReplayResult& result);

/// Writes one row a tick. Errors: file_or_device.
[[nodiscard]] Result<void> write_replay(const std::string& path,
                                        const std::vector<TrajectorySample>& trajectory,
                                        const ReplayResult& result, double rate_hz);

}  // namespace spm::servo
