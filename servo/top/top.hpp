// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "servo/client/spm_client.h"

namespace spm::servo {

/// One look at a running daemon, as libspm_client reports it.
struct TopSample {
  /// A device, with the daemon's texts for its cause of zero force: the present one, or else the
  /// last one.
  struct Device {
    std::string name;
    spm_client_device state{};
    spm_client_device_counts counts{};
    std::string cause, cure;
  };
  int daemon = SPM_CLIENT_STALLED;  ///< enum spm_client_daemon
  double age = -1;                  ///< s since the last tick; below 0: no tick so far
  spm_client_info info{};
  spm_client_loop loop{};
  std::vector<Device> devices;
  std::vector<spm_client_application> applications;
};

/// Durations of the ticks between two samples, us. They are at most a quarter too long, never too
/// short. The maximum is exact if it is the longest since the loop began.
struct TopTimes {
  double p50 = 0, p99 = 0, max = 0;
};

/// What was counted between two samples, and since the loop began.
struct TopCount {
  std::uint64_t recent = 0, total = 0;
};

/// The tool that a device's hand holds.
struct TopTool {
  bool is_there = false;
  std::array<double, 3> position{};     ///< m, world
  std::array<double, 4> orientation{};  ///< unit, w first
  std::uint32_t contacts = 0;           ///< places at which it touches
  std::uint32_t level = 0;              ///< of its samples, coarser than the finest
  std::uint32_t culled = 0;             ///< objects that were found apart from it as a whole
  bool capped = false;                  ///< the coupling of hand and tool is at its cap
  TopCount cap_hits;                    ///< ticks in which it was
};

struct TopDevice {
  std::string name;
  bool connected = false;
  bool contact = false;
  std::uint64_t contacts = 0;  ///< how often contact began
  double force = 0;            ///< N, now
  double force_max = 0;        ///< N
  TopCount cap_hits, slew_hits;
  double torque = 0;      ///< N m, now
  double torque_max = 0;  ///< N m
  double torque_cap = 0;  ///< N m; 0: it gives no torque; infinity: none
  TopCount torque_cap_hits, torque_slew_hits;
  TopTool tool;
  double energy = 0;         ///< J, net work on the hand of what was sent
  double generated_max = 0;  ///< J
  bool off = false;          ///< the force is zero now, for a cause
  TopCount cuts;             ///< how often the force was cut to zero
  /// of the zero force now, or else of the last cut; empty: there was none
  std::string cause, cure;
};

/// What `top` shows of the time between two samples.
struct TopView {
  int daemon = SPM_CLIENT_STALLED;
  double age = -1;  ///< s
  std::string version;
  std::uint32_t process = 0;
  double seconds = 0;         ///< from the first counted tick to the last
  double rate_hz = 0;         ///< ticks a second; 0 if no time passed
  double wanted_rate_hz = 0;  ///< Hz
  TopTimes wake, busy;
  double busy_share = 0;  ///< busy fraction of the time, 0 to 1
  std::uint64_t ticks = 0;
  TopCount missed, skipped;
  TopCount degraded;  ///< ticks that had too little time for all objects
  TopCount coarse;    ///< ticks of devices at a coarser level of the tool's samples
  std::vector<TopDevice> devices;
  std::vector<spm_client_application> applications;
  std::uint64_t commands = 0, refused = 0, garbage = 0;
};

/// Percentiles (nearest rank) of the difference of two histograms of the loop. `longest`: ns, since
/// the loop began, at each sample.
[[nodiscard]] TopTimes times_between(const std::uint64_t (&before)[64],
                                     const std::uint64_t (&now)[64], std::uint64_t longest_before,
                                     std::uint64_t longest);

/// What happened between two samples of one connection, the earlier one first.
[[nodiscard]] TopView view_between(const TopSample& before, const TopSample& now);

/// One object for `--json`.
[[nodiscard]] nlohmann::ordered_json to_json(const TopView& view);

}  // namespace spm::servo
