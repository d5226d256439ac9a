// SPDX-License-Identifier: Apache-2.0
#include "servo/doctor/doctor_usb.hpp"

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>

#include "servo/base/clock.hpp"
#include "servo/devices/base/usb_place.hpp"

namespace spm::servo {

namespace {

constexpr std::size_t max_round_trips = 300;
constexpr std::int64_t longest_ns = 1'000'000'000;
constexpr std::int64_t longest_all_ns = 4'000'000'000;  // of the 30 s that the command may take
constexpr unsigned timeout_ms = 100;

/// GET_STATUS of the device itself (USB 2.0, section 9.4.5): two bytes, without a side effect and
/// without claiming an interface, so that a running daemon keeps its device.
bool ask_for_status(libusb_device_handle* handle) {
  constexpr std::uint8_t to_host = LIBUSB_ENDPOINT_IN;
  std::array<unsigned char, 2> answer{};
  return libusb_control_transfer(handle, to_host, LIBUSB_REQUEST_GET_STATUS, 0, 0, answer.data(),
                                 static_cast<std::uint16_t>(answer.size()), timeout_ms) == 2;
}

RoundTrips measure(libusb_device* device, const std::string& place) {
  RoundTrips trips{place, 0, {}};
  libusb_device_handle* handle = nullptr;
  if (libusb_open(device, &handle) != LIBUSB_SUCCESS) return trips;
  std::vector<double> times;
  const std::int64_t start = now_ns();
  while (times.size() < max_round_trips && now_ns() - start < longest_ns) {
    const std::int64_t asked = now_ns();
    if (!ask_for_status(handle)) break;
    times.push_back(1e-3 * static_cast<double>(now_ns() - asked));
  }
  libusb_close(handle);
  trips.count = times.size();
  trips.us = summarise(times);
  return trips;
}

}  // namespace

std::vector<RoundTrips> measure_round_trips(const std::vector<FoundDevice>& devices) {
  std::vector<std::string> wanted;
  for (const FoundDevice& device : devices) {
    if (!device.usb.empty()) wanted.push_back(device.usb);
  }
  std::vector<RoundTrips> all;
  const std::int64_t start = now_ns();
  libusb_context* context = nullptr;
  if (wanted.empty() || libusb_init(&context) != LIBUSB_SUCCESS) return all;
  libusb_device** list = nullptr;
  const auto count = libusb_get_device_list(context, &list);
  if (count >= 0) {
    for (libusb_device* device : std::span(list, static_cast<std::size_t>(count))) {
      const std::string place = usb_place(device);
      if (std::find(wanted.begin(), wanted.end(), place) == wanted.end()) continue;
      if (now_ns() - start > longest_all_ns) break;
      RoundTrips trips = measure(device, place);
      if (trips.count > 0) all.push_back(std::move(trips));
    }
    libusb_free_device_list(list, 1);
  }
  libusb_exit(context);
  return all;
}

Check judge_devices(const DeviceSearch& search) {
  Check check{"devices", Verdict::unknown, "", ""};
  if (search.devices.empty()) {
    check.measured = fmt::format("no haptic device among {} USB devices", search.usb_devices);
    for (const std::string& note : search.notes) check.measured += "; " + note;
    check.cure = "Plug a device in and run this again; 'spm-servo devices' lists what is found.";
    return check;
  }
  for (const FoundDevice& device : search.devices) {
    const char* remark = device.permitted() ? "" : " (may not be opened)";
    if (!device.match.driven) remark = " (not driven yet)";
    check.measured += fmt::format("{}{} at {}{}", check.measured.empty() ? "" : ", ",
                                  device.match.driver, device.node, remark);
    if (!device.match.driven) continue;
    if (device.permitted()) {
      if (check.verdict == Verdict::unknown) check.verdict = Verdict::good;
      continue;
    }
    check.verdict = Verdict::poor;
    if (!check.cure.empty()) check.cure += " ";
    check.cure += cure_of(device);
  }
  return check;
}

Check judge_round_trips(const std::vector<RoundTrips>& trips) {
  Check check{"usb_round_trip", Verdict::unknown, "no haptic device on USB could be asked", ""};
  if (trips.empty()) return check;
  const auto slowest = std::max_element(
      trips.begin(), trips.end(),
      [](const RoundTrips& a, const RoundTrips& b) { return a.us.p50 < b.us.p50; });
  check.measured = fmt::format(
      "{} status requests to the device at {}: p50 {:.0f}, p99 {:.0f}, max "
      "{:.0f} us",
      slowest->count, slowest->usb, slowest->us.p50, slowest->us.p99, slowest->us.max);
  if (slowest->us.p50 < good_round_trip_us) {
    check.verdict = Verdict::good;
    return check;
  }
  check.verdict = slowest->us.p50 < fair_round_trip_us ? Verdict::fair : Verdict::poor;
  check.cure = "Use a port of the machine itself (USB 3 where there is one), without a hub.";
  return check;
}

}  // namespace spm::servo
