// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace spm {

/// Quantities that the command line takes and prints with their unit.
enum class Quantity {
  length,
  stiffness,
  force,
  speed,
  angle,
  damping,
  mass,
  per_length,
  angular_speed
};

/// Parses a number with its unit ("50um", "1.5N/mm", "10deg") into SI.
/// Independent of the locale. A bare number, an unknown unit, a non-finite value or trailing text
/// is an error of code `usage` whose message names the units that would do.
[[nodiscard]] Result<double> parse_quantity(std::string_view text, Quantity quantity);

/// Prints an SI value with the unit that reads best ("50 um", "2 mm", "1 N/mm").
[[nodiscard]] std::string format_quantity(double si_value, Quantity quantity);

/// Parses a probe: "point" gives 0, "sphere:0.5mm" its radius in metres. Errors as above.
[[nodiscard]] Result<double> parse_probe(std::string_view text);

/// Metres per unit of a mesh file: "m", "mm", "cm" or "in".
[[nodiscard]] Result<double> parse_mesh_unit(std::string_view text);

}  // namespace spm
