// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace spm {

/// Quantities that the command line reads and prints with a unit.
enum class Quantity {
  length,
  stiffness,
  force,
  speed,
  angle,
  damping,
  mass,
  per_length,
  angular_speed,
  rate,
  torque,
  turning_stiffness,
  duration
};

/// Parses a number with its unit ("50um", "1.5N/mm", "10deg") into SI. Independent of the locale.
/// The micro sign and the Greek mu are read as `u`. A bare number, an unknown unit, a non-finite
/// value or trailing text is an error of code `usage`, whose message lists the units that are
/// allowed.
[[nodiscard]] Result<double> parse_quantity(std::string_view text, Quantity quantity);

/// Prints an SI value with the unit that is easiest to read ("50 um", "2 mm", "1 N/mm").
[[nodiscard]] std::string format_quantity(double in_si, Quantity quantity);

/// Parses a probe: "point" gives 0, "sphere:0.5mm" gives the radius in metres. Errors as above.
[[nodiscard]] Result<double> parse_probe(std::string_view text);

/// Metres per unit of a mesh file: "m", "mm", "cm" or "in".
[[nodiscard]] Result<double> parse_mesh_unit(std::string_view text);

}  // namespace spm
