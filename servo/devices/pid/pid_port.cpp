// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/pid/pid_port.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <string_view>
#include <thread>
#include <utility>

#include "servo/base/clock.hpp"
#include "servo/devices/base/device_ids.hpp"

namespace spm::servo {

namespace {

constexpr std::string_view name = "HID PID device";

/// How long a reset takes, and how long a device may be busy with an effect, differs; no source
/// says [U].
constexpr std::chrono::milliseconds reset_wait{20};
constexpr std::chrono::milliseconds load_wait{5};
constexpr int load_attempts = 40;

/// After this many requests without an answer a device is no longer asked for its report: each
/// request may take until the kernel's timeout.
constexpr int max_unanswered = 3;

constexpr std::uint16_t set_effect_usage = 0x21;

bool is_pid(const HidDevice& device) {
  const auto match = match_hid({{device.vendor, device.product},
                                device.usage_page,
                                device.usage,
                                has_pid_force(hid_descriptor_of(device)),
                                device.product_name});
  return match && std::string_view(match->driver) == "pid";
}

std::string named(const HidDevice& device) {
  return fmt::format("the {} at {} ({:04x}:{:04x})", name, device.path, device.vendor,
                     device.product);
}

Result<PidLayout> layout_of(const HidDevice& device, std::optional<PidDirection> direction) {
  const auto descriptor = parse_hid_descriptor(hid_descriptor_of(device));
  if (!descriptor) {
    return fail(ExitCode::unsupported,
                fmt::format("{} has a report descriptor that cannot be read ({}): it cannot be "
                            "driven; check its firmware",
                            named(device), to_string(descriptor.error())));
  }
  auto layout = find_pid_layout(*descriptor, direction);
  if (!layout) {
    return fail(ExitCode::unsupported,
                fmt::format("{} cannot be driven: {}; use a device with constant force, or, where "
                            "direction= was given, leave that away",
                            named(device), layout.error()));
  }
  return std::move(*layout);
}

}  // namespace

std::vector<std::uint8_t> hid_descriptor_of(const HidDevice& device) {
  const std::string node = std::filesystem::path(device.path).filename().string();
  std::ifstream file("/sys/class/hidraw/" + node + "/device/report_descriptor", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

Result<std::unique_ptr<PidPort>> PidPort::open(const PidOptions& options,
                                               const std::atomic<bool>& stop, HidUse use) {
  std::optional<HidDevice> forceless;
  const auto fits = [&options, &forceless](const HidDevice& device) {
    if (!options.path.empty() && device.path != options.path) return false;
    if (is_pid(device)) return true;
    const bool is_meant = options.serial.empty() || device.serial == options.serial;
    if (is_meant && has_usage(hid_descriptor_of(device), pid_usage_page, set_effect_usage)) {
      forceless = device;
    }
    return false;
  };
  auto opened = open_hid({name, fits, options.serial}, use);
  if (!opened && forceless) {
    // It has effects, so that what it lacks is worth a word.
    if (auto layout = layout_of(*forceless, options.direction); !layout) {
      return tl::make_unexpected(std::move(layout.error()));
    }
  }
  if (!opened) return tl::make_unexpected(std::move(opened.error()));
  auto layout = layout_of(opened->device, options.direction);
  if (!layout) return tl::make_unexpected(std::move(layout.error()));
  auto writer = HidHandle::open(opened->device, name, HidUse::shared);
  if (!writer) return tl::make_unexpected(std::move(writer.error()));
  std::unique_ptr<PidPort> port(new PidPort(std::move(opened->device), std::move(*layout),
                                            std::move(opened->handle), std::move(*writer),
                                            options.watchdog, use));
  const Result<void> ready = port->set_up(stop);
  if (!ready) return tl::make_unexpected(ready.error());
  return port;
}

PidPort::~PidPort() {
  // If the device is gone these fail, and there is nothing left to stop.
  for (const PidBlock block : effects_) {
    static_cast<void>(send_message(pid_stop(layout_, block)));
    const auto give_back = pid_free(layout_, block);
    if (give_back) static_cast<void>(send_message(*give_back));
  }
}

tl::unexpected<Error> PidPort::failed(const char* what) const {
  return fail(ExitCode::file_or_device,
              fmt::format("{} {}: unplug it, plug it in again, and end other programs that use its "
                          "force feedback",
                          named(device_), what));
}

Result<void> PidPort::set_up(const std::atomic<bool>& stop) {
  const auto sent = [this](const std::optional<PidChoice>& what) {
    return !what || send_message(pid_control(layout_, *what));
  };
  // Twice, as the kernel's driver does: some miss the first while they are busy.
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (!sent(layout_.reset)) return failed("refuses to be reset");
    std::this_thread::sleep_for(reset_wait);
  }
  if (!sent(layout_.stop_all)) return failed("refuses to stop what it plays by itself");
  if (!sent(layout_.enable)) return failed("refuses to switch its motors on");
  if (layout_.gain && !send_message(pid_full_gain(layout_, *layout_.gain))) {
    return failed("refuses its gain");
  }
  if (Result<void> done = check_memory(); !done) return done;
  for (std::size_t axis = 0; axis < layout_.axes; ++axis) {
    const Result<PidBlock> block = create_effect(stop);
    if (!block) return tl::make_unexpected(block.error());
    effects_.push_back(*block);
    const PidDuration duration = watchdog_ ? PidDuration(pid_effect_seconds) : std::nullopt;
    if (!send_message(pid_set_effect(layout_, *block, axis, duration)) ||
        !send_message(pid_constant_force(layout_, *block, axis, 0)) ||
        !send_message(pid_start(layout_, *block))) {
      return failed("refuses to start an effect");
    }
  }
  started_ns_ = now_ns();
  return {};
}

Result<void> PidPort::check_memory() {
  if (!layout_.device_managed_pool) return {};
  const HidField& field = *layout_.device_managed_pool;
  std::vector<std::uint8_t> bytes(1 + layout_.payload_bytes(field.type, field.report_id));
  bytes[0] = field.report_id;
  // A device that does not answer here may still create effects.
  if (writer_->get_feature(bytes) != static_cast<int>(bytes.size())) return {};
  if (hid_value(field, std::span(bytes).subspan(1)) != 0) return {};
  return fail(ExitCode::unsupported,
              named(device_) +
                  " wants the host to manage its memory of effects, which is not supported: use "
                  "another device");
}

Result<PidBlock> PidPort::create_effect(const std::atomic<bool>& stop) {
  if (!send_message(pid_create(layout_))) return failed("refuses to create an effect");
  for (int attempt = 0; attempt < load_attempts && !stop.load(); ++attempt) {
    std::vector<std::uint8_t> bytes = pid_load_request(layout_).bytes;
    const int count = writer_->get_feature(bytes);
    if (count < 1) return failed("does not say what became of an effect");
    const auto payload =
        std::span<const std::uint8_t>(bytes).first(static_cast<std::size_t>(count));
    const auto loaded = decode_pid_load(layout_, payload.subspan(1));
    if (loaded && loaded->load == PidLoad::done) return loaded->block;
    if (loaded && loaded->load == PidLoad::full) return failed("has no room for another effect");
    std::this_thread::sleep_for(load_wait);
  }
  return failed("refuses an effect of constant force");
}

bool PidPort::send_message(const PidMessage& message) {
  return message.type == HidReportType::feature ? writer_->send_feature(message.bytes)
                                                : writer_->write(message.bytes);
}

bool PidPort::take(std::span<const std::uint8_t> bytes, PidReport& report) {
  if (bytes.empty()) return false;
  const std::uint8_t id = layout_.has_ids ? bytes[0] : 0;
  if (!take_pid_report(layout_, id, layout_.has_ids ? bytes.subspan(1) : bytes, latest_)) {
    return false;
  }
  report = latest_;
  return true;
}

Received PidPort::receive(PidReport& report) {
  std::array<std::uint8_t, max_report_bits / 8 + 1> buffer{};
  const int count = reader_->read(buffer, static_cast<int>(pid_ask_after.count()));
  if (count < 0) return Received::gone;
  if (count == 0) return ask(report);
  const auto bytes = std::span<const std::uint8_t>(buffer).first(static_cast<std::size_t>(count));
  return take(bytes, report) ? Received::report : Received::nothing;
}

Received PidPort::ask(PidReport& report) {
  if (unanswered_ >= max_unanswered) return Received::nothing;
  const HidField& field = layout_.position[0];
  std::vector<std::uint8_t> bytes(1 + layout_.payload_bytes(field.type, field.report_id));
  bytes[0] = field.report_id;
  const int count = reader_->get_input(bytes);
  const auto sent =
      std::span<const std::uint8_t>(bytes).first(static_cast<std::size_t>(std::max(count, 0)));
  // Also without ids, the first byte here is the place of the id. Some answer with that alone.
  if (count < 1 || !take(layout_.has_ids ? sent : sent.subspan(1), report)) {
    ++unanswered_;
    return Received::nothing;
  }
  unanswered_ = 0;
  return Received::report;
}

bool PidPort::send(const PidCommand& command) {
  const std::int64_t now = now_ns();
  const std::int64_t before = std::exchange(last_send_ns_, now);
  if (use_ == HidUse::alone && before != 0 && now - before > loop_stall_ns) {
    // Where the loop stood still the supervisor may have reset the device, which then has no
    // effects any longer: it must be opened again.
    for (const PidBlock block : effects_) static_cast<void>(send_message(pid_stop(layout_, block)));
    return false;
  }
  const bool restart =
      watchdog_ && now - started_ns_ >= std::chrono::nanoseconds(pid_restart_after).count();
  for (std::size_t axis = 0; axis < effects_.size(); ++axis) {
    // Each report takes a frame of the bus, so a force that did not change is not sent again.
    if (!restart && command.force[axis] == sent_[axis]) continue;
    // What the device has after a failed transfer is not known.
    sent_[axis] = std::numeric_limits<double>::quiet_NaN();
    if (!send_message(pid_constant_force(layout_, effects_[axis], axis, command.force[axis]))) {
      return false;
    }
    sent_[axis] = command.force[axis];
    if (restart && !send_message(pid_start(layout_, effects_[axis]))) return false;
  }
  if (restart) started_ns_ = now;
  return true;
}

}  // namespace spm::servo
