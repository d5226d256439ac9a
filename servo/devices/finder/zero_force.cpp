// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/finder/zero_force.hpp"

#include <atomic>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "servo/devices/base/port.hpp"
#include "servo/devices/falcon/falcon_options.hpp"
#include "servo/devices/falcon/falcon_port.hpp"
#include "servo/devices/pid/pid_options.hpp"
#include "servo/devices/pid/pid_port.hpp"
#include "servo/devices/wooden/wooden_options.hpp"
#include "servo/devices/wooden/wooden_port.hpp"

namespace spm::servo {

namespace {

constexpr std::string_view falcon = "falcon:", wooden = "woodenhaptics:", pid = "pid:";
/// An answer that was not taken for this long no longer matters.
constexpr std::chrono::milliseconds answer_wait{200};
constexpr std::string_view path_option = ",path=";

/// `Command{}` is no force, as in PortThreads. The report is read because some boards wait for that
/// before they accept the next command.
template <class Report, class Command>
ZeroForce through(std::shared_ptr<Port<Report, Command>> port) {
  using Clock = std::chrono::steady_clock;
  return [port = std::move(port), sent = Clock::time_point::min()]() mutable {
    const auto now = Clock::now();
    Report report;
    // The first of several waits for nothing.
    const bool first = sent < now - answer_wait;
    sent = now;
    if (!first && port->receive(report) == Received::gone) return false;
    return port->send(Command{});
  };
}

Result<ZeroForce> open_falcon(std::string_view text) {
  const auto options = parse_falcon_options(text);
  if (!options) return tl::make_unexpected(options.error());
  auto usb = FalconUsb::open(options->path, options->product, UsbClaim::take_over);
  if (!usb) return tl::make_unexpected(std::move(usb.error()));
  auto port = FalconPort::start(std::move(*usb));
  if (!port) return tl::make_unexpected(std::move(port.error()));
  return through<FalconReport, FalconCommand>(std::move(*port));
}

/// Takes the node of a HID device out of a target; empty if it names none.
std::string take_path(std::string_view& text) {
  const std::size_t at = text.rfind(path_option);
  if (at == std::string_view::npos) return {};
  std::string path(text.substr(at + path_option.size()));
  text = text.substr(0, at);
  return path;
}

Result<ZeroForce> open_wooden(std::string_view text) {
  const std::string path = take_path(text);
  auto options = parse_wooden_options(text);
  if (!options) return tl::make_unexpected(options.error());
  options->path = path;
  const std::atomic<bool> stop{false};
  auto port = WoodenPort::open(*options, 0, stop, HidUse::shared);
  if (!port) return tl::make_unexpected(std::move(port.error()));
  return through<WoodenReport, WoodenCommand>(std::move(*port));
}

Result<ZeroForce> open_pid(std::string_view text) {
  const std::string path = take_path(text);
  auto options = parse_pid_options(text);
  if (!options) return tl::make_unexpected(options.error());
  options->path = path;
  const std::atomic<bool> stop{false};
  auto port = PidPort::open(*options, stop, HidUse::shared);
  if (!port) return tl::make_unexpected(std::move(port.error()));
  return through<PidReport, PidCommand>(std::move(*port));
}

/// The options that name a HID device: its serial number, if it has one, and its node, because two
/// boards may have the same number. The supervisor is told again when the device gets another node.
std::string which(const nlohmann::ordered_json& details) {
  const auto serial = details.at("serial").get<std::string>();
  const bool named = !serial.empty() && serial.find(',') == std::string::npos;
  return (named ? ",serial=" + serial : "") + std::string(path_option) +
         details.at("path").get<std::string>();
}

}  // namespace

std::string zero_force_target(const Device& device) {
  const std::string& name = device.capabilities().name;
  const nlohmann::ordered_json details = device.describe();
  if (name == "falcon") {
    return std::string(falcon) + "path=" + details.at("usb_path").get<std::string>() +
           ",product=" + details.at("usb_product").get<std::string>();
  }
  if (name == "woodenhaptics") {
    // The protocol is given, so that it need not be detected from a report first.
    return std::string(wooden) + "protocol=" + details.at("protocol").get<std::string>() +
           which(details);
  }
  // The strength must be given; for zero force any value gives the same.
  if (name == "pid") return std::string(pid) + "full_force=1N" + which(details);
  return {};
}

bool may_open_early(const std::string& target) { return target.starts_with(wooden); }

Result<ZeroForce> open_zero_force(const std::string& target) {
  if (target.starts_with(falcon)) return open_falcon(target.substr(falcon.size()));
  if (target.starts_with(wooden)) return open_wooden(target.substr(wooden.size()));
  if (target.starts_with(pid)) return open_pid(target.substr(pid.size()));
  return fail(ExitCode::usage, "'" + target + "' is no device that is sent zero force");
}

}  // namespace spm::servo
