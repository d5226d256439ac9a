// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/device_wooden.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "common/base/device_profile.hpp"
#include "servo/base/clock.hpp"
#include "servo/base/state_folder.hpp"
#include "servo/devices/wooden/kept_signs.hpp"

namespace spm::servo {

DeviceWooden::DeviceWooden(const WoodenOptions& options)
    : options_(options),
      capabilities_(capabilities_of("woodenhaptics", *find_device_profile("wooden"))),
      tracker_(options) {
  capabilities_.force_cap = wooden_force_cap(*options.model);
  // The profile's box contains the arm's workspace, but no source says where it lies. It cannot be
  // about the origin, because the home pose, 0.2 m above the origin, is outside such a box. The
  // mechanics of the arm limit its workspace.
  capabilities_.workspace.setZero();
  // Assumed: half of the interval, 1 ms, at which a host asks a full-speed device.
  capabilities_.own_delay = 0.5e-3;
  capabilities_.guarded = true;
  capabilities_.buttons = 1;
  // A model with encoders D to F has a gimbal, which is read and not driven.
  const double per_turn = options.model->gimbal_counts_per_turn;
  capabilities_.turns = per_turn > 0;
  if (per_turn > 0) capabilities_.turn_step = 2 * std::numbers::pi / per_turn;
  // The options may be made without parsing, without a cap of their own.
  if (!(options_.force_cap > 0)) options_.force_cap = capabilities_.force_cap;
  capabilities_.force_cap = std::min(capabilities_.force_cap, options_.force_cap);
  tracker_ = WoodenTracker(options_);
}

Result<void> DeviceWooden::open(const DeviceSetup& setup) {
  using Opened = Result<std::unique_ptr<Port<WoodenReport, WoodenCommand>>>;
  const auto open_port = [this](const std::atomic<bool>& stop) -> Opened {
    auto port = WoodenPort::open(options_, connections_ + 1, stop);
    if (!port) return tl::make_unexpected(std::move(port.error()));
    if (auto known = know_signs(**port); !known) {
      return tl::make_unexpected(std::move(known.error()));
    }
    ++connections_;
    return Opened(std::move(*port));
  };
  return start(open_port, setup.realtime);
}

/// Those that are named, or else those that were kept, or else the model's, which nobody confirmed.
Result<void> DeviceWooden::know_signs(WoodenPort& port) {
  const WoodenBoard board{port.device().serial, options_.model->name, port.protocol()};
  const std::string state = state_folder();
  const std::string folder = state.empty() ? state : state + "/woodenhaptics";
  WoodenSigns signs = signs_of(wooden_calibration(options_, port.protocol()));
  const bool named = options_.count_signs.has_value();
  if (named && options_.keep_signs) {
    if (auto kept = keep_signs(folder, board, signs); !kept) return kept;
  }
  const auto kept = named ? std::nullopt : kept_signs(folder, board);
  if (kept) signs = *kept;
  const bool confirmed = named || kept.has_value();
  port.set_signs(signs, confirmed);
  const std::lock_guard lock(found_mutex_);
  if (!confirmed && (connections_ == 0 || found_.serial != board.serial)) {
    const WoodenCalibration usual = wooden_calibration(options_, port.protocol());
    spdlog::warn(
        "the WoodenHaptics at {} (serial number '{}') gives no force until its signs are "
        "confirmed, because wrong ones pull the hand into what it touches: move each joint and "
        "look whether the tool follows, then start with "
        "--device woodenhaptics:signs={},keep_signs=on, or with the signs that it needs",
        port.device().path, board.serial, signs_text(usual.count_signs.data(), 3));
  }
  found_ = port.device();
  found_protocol_ = port.protocol();
  found_signs_ = signs;
  found_confirmed_ = confirmed;
  return {};
}

Result<void> DeviceWooden::start(Threads::Open open, RealtimeMode realtime) {
  return threads_.start(std::move(open), realtime);
}

DeviceHealth DeviceWooden::health(std::int64_t at_ns) const noexcept {
  return threads_.is_open() ? tracker_.health(at_ns) : DeviceHealth::gone;
}

DeviceHealth DeviceWooden::read(DeviceState& state) noexcept {
  WoodenReport report;
  std::int64_t came_ns = 0;
  if (!threads_.look()) {
    tracker_.lose();
  } else if (threads_.take(report, came_ns)) {
    tracker_.take(report, came_ns);
  }
  state = tracker_.state();
  return health(now_ns());
}

bool DeviceWooden::wait_for_report(std::int64_t until_ns) noexcept {
  return threads_.wait(until_ns);
}

DeviceHealth DeviceWooden::write(const Wrench& wrench) noexcept {
  if (!threads_.is_open()) return DeviceHealth::gone;
  const std::int64_t now = now_ns();
  WoodenCommand command;
  if (tracker_.command(wrench, now, command)) threads_.give(command);
  return health(now);
}

nlohmann::ordered_json DeviceWooden::describe() const {
  const std::lock_guard lock(found_mutex_);
  WoodenCalibration calibration = wooden_calibration(options_, found_protocol_);
  if (found_signs_ != WoodenSigns{}) take_signs(found_signs_, calibration);
  nlohmann::ordered_json json{{"model", options_.model->name},
                              {"protocol", to_string(found_protocol_)},
                              {"path", found_.path},
                              {"serial", found_.serial},
                              {"signs", signs_text(calibration.count_signs.data(), 6)},
                              {"motor_signs", signs_text(calibration.motor_signs.data(), 3)},
                              {"signs_confirmed", found_confirmed_},
                              {"home_counts", calibration.home},
                              {"home_confirmed", to_string(options_.home_confirmed)},
                              {"imax_A", options_.full_scale_current},
                              {"current_limit_A", options_.current_limit},
                              {"gravity", options_.gravity},
                              {"reopened", threads_.reopened()},
                              {"latency_us", threads_.latency_us()}};
  if (options_.motor.known()) {
    json["motor_heat"] = {{"source", options_.motor.source},
                          {"winding_limit_c", options_.motor.winding_limit},
                          {"hottest_c", tracker_.hottest()},
                          {"limited_commands", tracker_.limited_commands()}};
  }
  if (tracker_.limited_commands() > 0) {
    json["warning"] = "the force was lowered because a motor's winding came near its limit";
  }
  threads_.add_last_error(json);
  return json;
}

}  // namespace spm::servo
