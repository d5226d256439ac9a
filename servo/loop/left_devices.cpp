// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/left_devices.hpp"

#include <utility>

namespace spm::servo {

namespace {

constexpr int zeros_sent = 6;

}  // namespace

void LeftDevices::watch(const std::vector<std::string>& targets) {
  devices_.clear();
  for (const std::string& target : targets) {
    LeftDevice device{target, {}, 0, {}};
    if (may_open_early(target)) {
      if (auto opened = open_(target)) device.send = std::move(*opened);
    }
    devices_.push_back(std::move(device));
  }
}

void LeftDevices::begin(Clock::time_point due) {
  due_ = due;
  for (LeftDevice& device : devices_) device.left = zeros_sent;
}

bool LeftDevices::serve(LeftDevice& device) const {
  if (device.left == 0) return false;
  if (!device.send) {
    if (Clock::now() >= due_) return false;
    auto opened = open_(device.target);
    if (!opened) {
      device.problem = std::move(opened.error().message);
      return true;
    }
    device.send = std::move(*opened);
  }
  if (device.send()) {
    --device.left;
  } else {
    device.send = nullptr;
    device.left = zeros_sent;
    device.problem = "it was lost while zero was sent";
  }
  return device.left > 0;
}

bool LeftDevices::send_zeros() {
  bool any_left = false;
  for (LeftDevice& device : devices_) any_left = serve(device) || any_left;
  return any_left;
}

void LeftDevices::let_go() {
  for (LeftDevice& device : devices_) {
    device.left = 0;
    if (!may_open_early(device.target)) device.send = nullptr;
  }
}

std::string LeftDevices::outcome() const {
  std::string sent, failed;
  for (const LeftDevice& device : devices_) {
    if (device.left == 0) {
      sent += (sent.empty() ? "" : " and ") + device.target;
    } else {
      failed += (failed.empty() ? "" : " and ") + device.target + " (" + device.problem + ")";
    }
  }
  std::string text;
  if (!sent.empty()) text += "zero force was sent to " + sent;
  if (!sent.empty() && !failed.empty()) text += ", but ";
  if (!failed.empty()) {
    text += "no zero force could be sent to " + failed + ": let go of it and switch it off";
  }
  return text;
}

}  // namespace spm::servo
