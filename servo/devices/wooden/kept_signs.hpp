// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "servo/devices/wooden/wooden_kinematics.hpp"
#include "servo/devices/wooden/wooden_reports.hpp"

namespace spm::servo {

/// One board, whose signs its user has confirmed or not: they hold for a model and a protocol.
struct WoodenBoard {
  std::string serial;
  std::string_view model;
  WoodenProtocol protocol = WoodenProtocol::v1;
};

/// The signs that the user has confirmed for a board before, from a file of its serial number in
/// `folder`. Nothing if there is none, or it is of another model or protocol, or damaged.
[[nodiscard]] std::optional<WoodenSigns> kept_signs(const std::string& folder,
                                                    const WoodenBoard& board);

/// Keeps signs as confirmed for a board, in place of those from before. Errors: file_or_device, for
/// no folder (empty), a board without a serial number, and a file that cannot be written.
[[nodiscard]] Result<void> keep_signs(const std::string& folder, const WoodenBoard& board,
                                      const WoodenSigns& signs);

/// The signs of a calibration, and back.
[[nodiscard]] WoodenSigns signs_of(const WoodenCalibration& calibration) noexcept;
void take_signs(const WoodenSigns& signs, WoodenCalibration& calibration) noexcept;

}  // namespace spm::servo
