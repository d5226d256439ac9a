// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "servo/devices/finder/device_finder.hpp"
#include "servo/doctor/verdict.hpp"
#include "servo/base/statistics.hpp"

namespace spm::servo {

/// Time from asking a USB device something to its answer.
struct RoundTrips {
  std::string usb;        ///< the device, by bus and ports
  std::size_t count = 0;  ///< answers
  Summary us;
};

/// Median of a round trip, us. A control transfer has two or three stages; a host controller that
/// need not wait for the next frame of 1 ms (xHCI) is done with all of them inside one, one that
/// gives each a frame (UHCI) needs about 2 to 3 ms. Measured with emulated devices, a packet and
/// its answer: 613 us on a controller of the first kind, 2080 us on one of the second.
inline constexpr double good_round_trip_us = 1000;
inline constexpr double fair_round_trip_us = 3000;

/// Asks each of the devices on USB that this user may open for its status (a standard request that
/// changes nothing), some hundred times, at most one second a device and five in all. One that does
/// not answer is left out.
[[nodiscard]] std::vector<RoundTrips> measure_round_trips(const std::vector<FoundDevice>& devices);

/// Poor where a device may not be opened; unknown where none is plugged in that we drive.
[[nodiscard]] Check judge_devices(const DeviceSearch& search);

/// By the slowest device's median; unknown where none answered.
[[nodiscard]] Check judge_round_trips(const std::vector<RoundTrips>& trips);

}  // namespace spm::servo
