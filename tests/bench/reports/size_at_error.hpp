// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

namespace spm::bench {

/// What one setting of a method came to.
struct SizeAndError {
  double bytes = 0;
  double error = 0;  ///< m
};

enum class Estimate {
  measured,      ///< one setting has no more error than asked for and no fewer bytes are known
  interpolated,  ///< between two settings, straight on two logarithmic scales
  extrapolated,  ///< beyond the settings, along the slope of the nearest two
};

struct SizeAtError {
  double bytes = 0;
  Estimate estimate = Estimate::measured;
  double slope = 0;  ///< d log(bytes) / d log(error); 0 where measured
};

/// The bytes that a method would need for an error of at most `error` metres. Errors below
/// `exact` metres count as none: such a method is taken at its smallest setting. Nothing where the
/// settings do not tell: fewer than two, or an error that does not fall with the bytes.
[[nodiscard]] std::optional<SizeAtError> size_at_error(std::vector<SizeAndError> settings,
                                                       double error, double exact);

[[nodiscard]] const char* to_string(Estimate estimate) noexcept;

}  // namespace spm::bench
