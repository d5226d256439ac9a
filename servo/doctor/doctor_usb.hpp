// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "servo/base/statistics.hpp"
#include "servo/devices/finder/device_finder.hpp"
#include "servo/doctor/verdict.hpp"

namespace spm::servo {

/// Time from a request to a USB device to its answer.
struct RoundTrips {
  std::string usb;        ///< the device, by bus and ports
  std::size_t count = 0;  ///< answers
  Summary us;
};

/// Largest median of a round trip that is good, us. A control transfer has two or three stages. A
/// host controller that need not wait for the next frame of 1 ms (xHCI) finishes all of them within
/// one frame; one that gives each stage a frame (UHCI) needs about 2 to 3 ms. Measured with
/// emulated devices, a packet and its answer: 613 us on a controller of the first kind, 2080 us on
/// one of the second.
inline constexpr double good_round_trip_us = 1000;
inline constexpr double fair_round_trip_us = 3000;

/// Asks each of the devices on USB that this user may open for its status (a standard request that
/// changes nothing), a few hundred times, for at most one second for each device and five in all. A
/// device that does not answer is left out.
[[nodiscard]] std::vector<RoundTrips> measure_round_trips(const std::vector<FoundDevice>& devices);

/// Poor if a device may not be opened; unknown if no device that we drive is plugged in.
[[nodiscard]] Check judge_devices(const DeviceSearch& search);

/// By the slowest device's median; unknown if none answered.
[[nodiscard]] Check judge_round_trips(const std::vector<RoundTrips>& trips);

}  // namespace spm::servo
