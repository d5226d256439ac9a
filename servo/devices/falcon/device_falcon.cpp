// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/device_falcon.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "common/base/device_profile.hpp"
#include "servo/base/clock.hpp"
#include "servo/devices/falcon/falcon_kinematics.hpp"
#include "servo/devices/falcon/falcon_port.hpp"
#include "servo/devices/falcon/falcon_usb.hpp"

namespace spm::servo {

namespace {

constexpr const DeviceProfile& profile = *find_device_profile("falcon");

/// A Falcon answers each packet within 1 or 2 ms; an older report says nothing about the hand.
constexpr std::int64_t longest_silence_ns =
    std::chrono::nanoseconds(std::chrono::milliseconds(10)).count();

void set_lights(FalconCommand& command, DeviceHealth health) noexcept {
  command.red = health == DeviceHealth::not_homed;
  command.green = health == DeviceHealth::ok;
  command.blue = !command.red && !command.green;
}

}  // namespace

DeviceFalcon::DeviceFalcon(FalconOptions options)
    : options_(std::move(options)),
      capabilities_(capabilities_of("falcon", profile)),
      tracker_(options_.home_angle) {
  capabilities_.force_cap = std::min(options_.force_cap, profile.force_cap);
  // 16 bytes each way at 1.5 Mbaud, and half of the chip's latency timer of 1 ms.
  capabilities_.own_delay = 0.7e-3;
  capabilities_.guarded = true;
  capabilities_.buttons = 4;
}

Result<void> DeviceFalcon::open(const DeviceSetup& setup) {
  if (!options_.firmware.empty()) {
    Result<FalconFirmwareFile> file = read_falcon_firmware(options_.firmware);
    if (!file) return tl::make_unexpected(std::move(file.error()));
    if (!file->known) {
      spdlog::warn(
          "{}: is no firmware that is known (sha256 {}); it is loaded if the Falcon needs "
          "one, check that it is the file that came with the device's software",
          file->path, file->sha256);
    }
    firmware_ = std::move(*file);
  }
  return start([this](const std::atomic<bool>& stop) { return connect(stop); }, setup.realtime);
}

Result<void> DeviceFalcon::start(Threads::Open open, RealtimeMode realtime) {
  return threads_.start(std::move(open), realtime);
}

Result<std::unique_ptr<DeviceFalcon::Threads::DevicePort>> DeviceFalcon::connect(
    const std::atomic<bool>& stop) {
  auto usb = FalconUsb::open(options_.path, options_.product);
  if (!usb) return tl::make_unexpected(std::move(usb.error()));
  const auto set = set_falcon_normal_mode(**usb);
  if (!set) return tl::make_unexpected(set.error());
  const Result<bool> runs = falcon_firmware_runs(**usb, stop);
  if (!runs) return tl::make_unexpected(runs.error());
  if (!*runs) {
    if (!firmware_) {
      return fail(ExitCode::file_or_device,
                  fmt::format("the Novint Falcon at the USB path {} runs no firmware, and none is "
                              "given; name the file that came with the device's software: --device "
                              "falcon:firmware=FILE, or FALCON_FIRMWARE=FILE in the environment",
                              (*usb)->path()));
    }
    const auto uploaded = upload_falcon_firmware(**usb, firmware_->bytes, stop);
    if (!uploaded) return tl::make_unexpected(uploaded.error());
  }
  {
    const std::lock_guard lock(mutex_);
    connection_.path = (*usb)->path();
    connection_.uploaded = !*runs;
    connection_.uploads += *runs ? 0 : 1;
  }
  auto port = FalconPort::start(std::move(*usb));
  if (!port) return tl::make_unexpected(std::move(port.error()));
  return std::unique_ptr<Threads::DevicePort>(std::move(*port));
}

DeviceHealth DeviceFalcon::read(DeviceState& state) noexcept {
  health_ = look();
  if (health_ == DeviceHealth::ok) {
    state.position = tracker_.position();
    state.orientation = Eigen::Quaterniond::Identity();
    state.buttons = buttons_;
  }
  return health_;
}

DeviceHealth DeviceFalcon::look() noexcept {
  if (!threads_.look()) {
    tracker_.restart();
    came_ns_ = 0;
    return DeviceHealth::gone;
  }
  const std::int64_t now = now_ns();
  FalconReport report;
  std::int64_t came_ns = 0;
  // A report that was there since before a loss is too old, and says nothing.
  if (threads_.take(report, came_ns) && now - came_ns <= longest_silence_ns) {
    came_ns_ = came_ns;
    buttons_ = report.buttons;
    followed_ = tracker_.follow(report, came_ns);
    homed_.store(report.homed == falcon_all_homed, std::memory_order_relaxed);
  }
  return now - came_ns_ > longest_silence_ns ? DeviceHealth::silent : followed_;
}

bool DeviceFalcon::wait_for_report(std::int64_t until_ns) noexcept {
  return threads_.wait(until_ns);
}

DeviceHealth DeviceFalcon::write(const Wrench& wrench) noexcept {
  FalconCommand command;
  DeviceHealth written = threads_.is_open() ? DeviceHealth::ok : DeviceHealth::gone;
  if (health_ == DeviceHealth::ok && !push(wrench.force, command)) written = DeviceHealth::fault;
  if (health_ != DeviceHealth::ok) tracker_.pushed(0);
  set_lights(command, health_);
  // In every tick, also without force: a Falcon that receives nothing stops after a while.
  threads_.give(command);
  return written;
}

bool DeviceFalcon::push(const Vector3& force, FalconCommand& command) noexcept {
  const double size = force.norm();
  tracker_.pushed(0);
  if (!std::isfinite(size)) return false;
  const double factor = size > capabilities_.force_cap ? capabilities_.force_cap / size : 1;
  const auto torques = falcon_torques(tracker_.position(), tracker_.angles(), factor * force);
  if (!torques) return false;
  command.motors = falcon_motors(*torques);
  tracker_.pushed(factor * size);
  return true;
}

nlohmann::ordered_json DeviceFalcon::describe() const {
  const std::lock_guard lock(mutex_);
  nlohmann::ordered_json json{{"usb_path", connection_.path},
                              {"usb_product", fmt::format("{:04x}", options_.product)},
                              {"homed", homed_.load(std::memory_order_relaxed)},
                              {"reopened", threads_.reopened()},
                              {"firmware", connection_.uploaded ? "uploaded" : "was_running"},
                              {"firmware_uploads", connection_.uploads},
                              {"home_angle_rad", options_.home_angle},
                              {"latency_us", threads_.latency_us()}};
  if (firmware_) {
    json["firmware_file"] = {
        {"path", firmware_->path}, {"sha256", firmware_->sha256}, {"known", firmware_->known}};
  }
  threads_.add_last_error(json);
  return json;
}

}  // namespace spm::servo
