// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "servo/base/statistics.hpp"
#include "servo/loop/loop.hpp"
#include "servo/realtime/realtime.hpp"
#include "servo/record/black_box.hpp"
#include "servo/scene/asset_keeper.hpp"
#include "servo/scene/force_choice.hpp"
#include "servo/shared/socket_path.hpp"

namespace spm::servo {

struct RunOptions {
  ForceOptions force;
  /// in the form that make_device takes; empty: the scene's, or auto
  std::vector<std::string> devices;
  double rate_hz = 1000;
  bool paced_by_device = false;            ///< ticks follow the reports of the first device
  double tick_budget = usual_tick_budget;  ///< of the period, see LoopSettings
  RealtimeMode realtime = RealtimeMode::attempt;
  std::optional<unsigned> core;  ///< for the loop and the threads of its devices; empty: any core
  bool acknowledge = false;      ///< after a fault the force waits for an acknowledgement
  std::uint32_t enable_button = 0;  ///< of each device; without it held no force; 0: none
  MapMode map = MapMode::file;
  double duration = 0;     ///< s, from the first tick; 0: until a signal
  std::string trace;       ///< file with one row for each tick of the first device; empty: none
  std::string record;      ///< file for a recording of all devices; empty: none
  bool supervisor = true;  ///< another process sends zero force if this one is killed
  /// where to ask for that process (start_outside); empty: it is a child of this one
  std::string supervisor_socket;
  bool serve = true;                       ///< applications may connect
  std::string name = usual_daemon_name();  ///< of the daemon, by which they find it
  std::string socket;                      ///< path of their socket; empty: the one of that name
  std::optional<std::uint32_t> app_group;  ///< whose members may connect too; needs a path
  std::string black_box = default_black_box();  ///< file for the ticks about a fault, as
                                                ///< write_black_box takes it; empty: none
};

/// What one device did in a run.
struct DeviceReport {
  DeviceCapabilities capabilities;
  nlohmann::ordered_json details;
  DeviceCounters counters;
  LoopDelay delay;
};

/// What a run did.
struct RunReport {
  RunOptions options;
  ForceChoice force;
  LoopCounters counters;
  Summary wake_us, busy_us;
  RealtimeState realtime;
  bool latency_held = false;     ///< /dev/cpu_dma_latency, while the loop ran
  std::string latency_not_held;  ///< why not, as a clause
  std::vector<DeviceReport> devices;
  std::vector<KeeperReport> assets;  ///< in the order of the choice's
  std::uint64_t black_boxes = 0;     ///< how often the black box was written
};

/// Serves forces from a baked asset or a scene until the duration is over, or SIGINT, SIGTERM or
/// SIGHUP comes. The loop has a thread of its own, each asset a loading thread, and the caller's
/// thread takes the loop's records. Warnings go to the default log. Errors: usage (options),
/// file_or_device and invalid_input (scene, assets, trace), realtime_refused.
[[nodiscard]] Result<RunReport> run(const RunOptions& options);

}  // namespace spm::servo
