// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

namespace spm::bench {

/// The bytes and the error of one setting of a method.
struct SizeAndError {
  double bytes = 0;
  double error = 0;  ///< m
};

enum class Estimate {
  measured,      ///< one setting is within the error, and none with fewer bytes is known
  interpolated,  ///< between two settings, on a straight line in log-log scale
  extrapolated,  ///< beyond the settings, along the slope of the nearest two
};

struct SizeAtError {
  double bytes = 0;
  Estimate estimate = Estimate::measured;
  double slope = 0;  ///< d log(bytes) / d log(error); 0 where measured
};

/// The bytes that a method would need for an error of at most `error` metres. Errors below
/// `exact` metres count as none: the smallest such setting of a method is taken. No value if the
/// settings are not enough: fewer than two, or an error that does not fall as the bytes grow.
[[nodiscard]] std::optional<SizeAtError> size_at_error(std::vector<SizeAndError> settings,
                                                       double error, double exact);

[[nodiscard]] const char* to_string(Estimate estimate) noexcept;

}  // namespace spm::bench
