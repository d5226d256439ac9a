// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/motion/recording.hpp"
#include "formats/motion/trajectory.hpp"
#include "servo/base/statistics.hpp"
#include "servo/force/sampled_tool.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/record/scene_step.hpp"

namespace spm::servo {

enum class Pace {
  none,      ///< one tick after the other, without waiting
  realtime,  ///< each tick at its time
};

/// What happened to the force law in a tick of a recording, beside the pose.
struct ReplayMark {
  bool forgot = false;           ///< it had forgotten its state before this tick
  bool off = false;              ///< it was not evaluated: the force was off
  std::uint64_t ticks = 1;       ///< since the last one
  std::optional<Wrench> sent{};  ///< of what the law gave; empty: all of it
  ForceEffort effort{};          ///< time decides nothing in a replay
};

/// A change of the scene, and the row before whose force it comes.
struct ReplayStep {
  std::size_t row = 0;
  SceneStep step;
};

struct ReplayOptions {
  ForceScene scene = scene_of({});
  double rate_hz = 1000;
  double encoder_step = 0;      ///< m, of the hand: largest error of a recorded position
  FeltLimits limits;            ///< as they were for the device
  HandTurning turning;          ///< the same
  SampledTool* tool = nullptr;  ///< of the hand; null: it has none. It must outlive the replay.
  std::size_t hand = 0;         ///< number of the hand, whose tool it is
  Pace pace = Pace::none;
  std::vector<ReplayMark> marks;  ///< one for each row; empty: the law was evaluated in every tick
  std::vector<bool> gone;         ///< objects of the scene that are not there at the start
  /// changes of the scene, each before its row; ordered
  std::vector<ReplayStep> steps;
};

/// Of a tool in a tick, what tables tell.
struct TickOfTool {
  HandPose pose;  ///< world
  std::uint32_t patches = 0;
  std::uint32_t level = 0, culled = 0;
  bool capped = false;
};

/// The results of the loop's force law, one for each row of the trajectory.
struct ReplayResult {
  std::vector<ContactForce> contacts;
  std::vector<TickOfTool> tools;  ///< with a tool alone
  /// of the force law, in a single pass, including the cost of the clock itself
  std::vector<std::int64_t> busy_ns;
};

/// Runs the loop's own force law over recorded poses of the hand, in order, without the safety
/// stage. Writes to memory that was allocated before the first tick. `assets`: those that the
/// scene's objects name.
[[nodiscard]] ReplayResult replay(std::span<const AssetView* const> assets,
                                  const std::vector<TrajectorySample>& trajectory,
                                  const ReplayOptions& options);

/// One of several hands whose tools meet.
struct ReplayHand {
  std::span<const TrajectorySample> trajectory;
  std::span<const std::uint64_t> ticks;  ///< on the loop's grid, of each row
  const ReplayOptions* options = nullptr;
};

/// The same for several hands at once, tick by tick in the order of the hands, as the loop serves
/// them, so that their tools touch as they did. Without waiting. Pointers must outlive the call.
[[nodiscard]] std::vector<ReplayResult> replay_together(std::span<const AssetView* const> assets,
                                                        std::span<const ReplayHand> hands);

/// Why later rows of a recording do not belong to the scene that its daemon began with.
enum class SceneChange {
  none,
  application,  ///< an application moved, added or changed objects
  edit,         ///< an edited scene was taken up
};

/// One device's rows of a recording, in the form that replay() takes.
struct RecordedTicks {
  std::vector<TrajectorySample> trajectory;
  std::vector<ReplayMark> marks;
  std::vector<Wrench> wanted;              ///< the result of the force law then
  std::uint64_t added = 0;                 ///< ticks in which applications added a force
  std::uint64_t lost = 0;                  ///< places where ticks are missing
  SceneChange change = SceneChange::none;  ///< the first one
  std::uint64_t changed_tick = 0;  ///< on the loop's grid, of the first row in which it was felt
  /// The number of rows before it, whose forces a replay of the scene at the start reproduces; all
  /// rows if there is no change.
  std::size_t comparable = 0;
  /// The first row whose state of the force law a replay knows: the law had forgotten its state, or
  /// nothing was touched for so long that no memory is left. The number of rows if there is none.
  std::size_t settled = 0;
  std::vector<std::uint64_t> ticks;  ///< on the loop's grid, of each row
};
[[nodiscard]] RecordedTicks ticks_of(const Recording& recording, std::size_t device);

/// The changes of a recording's scene before rows of these ticks.
[[nodiscard]] std::vector<ReplayStep> steps_before(const std::vector<SceneStep>& steps,
                                                   const std::vector<std::uint64_t>& ticks);

/// How a replay's forces differ from the recorded ones, in the rows from `from` on for which there
/// are forces in `wanted`.
struct ForceDifference {
  std::uint64_t ticks = 0;      ///< in how many ticks any bit differs
  std::uint64_t first_row = 0;  ///< the first row that differs
  double largest = 0;           ///< N
  double largest_torque = 0;    ///< N m
};
[[nodiscard]] ForceDifference difference(const ReplayResult& result, std::span<const Wrench> wanted,
                                         std::size_t from = 0);

/// The first row of a recording that begins in the middle of a run from which on the replay feels
/// the same: all forces are equal bit by bit for longer than the law's longest memory, and many of
/// them in contact. The number of forces in `wanted` if there is none.
[[nodiscard]] std::size_t caught_up(const ReplayResult& result, std::span<const Wrench> wanted);

/// Durations of a replay's ticks, microseconds.
[[nodiscard]] Summary us_per_tick(const ReplayResult& result);

/// Magnitudes of the steps from tick to tick, |F_i - F_(i-1)|, N.
[[nodiscard]] Summary force_steps(const ReplayResult& result);

[[nodiscard]] std::uint64_t contact_ticks(const ReplayResult& result);

/// Writes one row for each tick. Errors: file_or_device.
[[nodiscard]] Result<void> write_replay(const std::string& path,
                                        const std::vector<TrajectorySample>& trajectory,
                                        const ReplayResult& result, double rate_hz);

}  // namespace spm::servo
