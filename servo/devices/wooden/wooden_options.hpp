// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "servo/devices/wooden/motor_heat.hpp"
#include "servo/devices/wooden/wooden_kinematics.hpp"
#include "servo/devices/wooden/wooden_reports.hpp"

namespace spm::servo {

/// Whether the user confirms that the arm stood in its home pose when its board got power. The
/// counters begin there, and the board cannot know.
enum class WoodenHome : std::uint8_t {
  unconfirmed,  ///< not confirmed: V2 and V3 wait for the calibration button, V1 gives no force
  once,         ///< it did before this start; not valid any more after it was unplugged
  always,       ///< it does whenever it is plugged in, for example on a rest that holds it there
};

[[nodiscard]] const char* to_string(WoodenHome home) noexcept;

/// Options of a WoodenHaptics: `woodenhaptics:model=NAME,protocol=auto|v1|v2|v3,serial=TEXT,
/// signs=+-+,motor_signs=+-+,keep_signs=on|off,home=A:B:C,home_confirmed=no|once|always,imax=CURRENT,
/// current_limit=CURRENT,gravity=on|off,force_cap=FORCE`, and the motors' data together:
/// `motor_resistance=R,thermal_resistance=R,thermal_time=TIME,winding_limit=T,motor_source=TEXT`,
/// with `ambient=T` if it is not 25C.
struct WoodenOptions {
  const WoodenModel* model = find_wooden_model("woodenhaptics2016");
  std::optional<WoodenProtocol> protocol;  ///< empty: detected from the device
  std::string serial;                      ///< empty: any
  std::string path;                        ///< its node, for who knows it already; empty: any

  /// Whether they mean one board, or a protocol whose boards have the ids of others too.
  [[nodiscard]] bool name_a_board() const noexcept {
    return !serial.empty() || !path.empty() || protocol == WoodenProtocol::v3;
  }

  /// +1 or -1, encoders A to F; who names them confirms them, and without that there is no force
  std::optional<std::array<double, 6>> count_signs;
  std::optional<std::array<double, 3>> motor_signs;  ///< +1 or -1, motors A to C
  bool keep_signs = false;  ///< whether the signs are kept as confirmed for the board
  std::optional<std::array<double, 3>> home;  ///< counts; empty: the model's
  WoodenHome home_confirmed = WoodenHome::unconfirmed;
  double full_scale_current = model->full_scale_current;  ///< A, as the board's drives are set
  double current_limit = 2;  ///< A, for one motor, at most full_scale_current
  bool gravity = false;      ///< whether the motors hold the arm's weight
  MotorData motor;           ///< without it the motors' heat is not estimated
  double force_cap = 0;      ///< N, above 0, at most the profile's and the model's
};

/// Parses the text after `woodenhaptics:`; the empty text gives the defaults. Errors: usage, for an
/// unknown key or word, with the valid ones, and for a value out of range.
[[nodiscard]] Result<WoodenOptions> parse_wooden_options(std::string_view text);

/// Largest force that may be sent to a model, N: the smaller of the profile's and the model's.
[[nodiscard]] double wooden_force_cap(const WoodenModel& model) noexcept;

/// Signs and home for a protocol: those of the options, or else those that public hosts use with
/// the model. A current that turns a motor forwards makes its counter grow with V2 and V3, and fall
/// with V1, whose firmware counts the other way; where the options name signs of encoders alone,
/// the motors' follow from that [U].
[[nodiscard]] WoodenCalibration wooden_calibration(const WoodenOptions& options,
                                                   WoodenProtocol protocol) noexcept;

/// Text such as "+-+" for messages and reports.
[[nodiscard]] std::string signs_text(const double* signs, std::size_t count);

}  // namespace spm::servo
