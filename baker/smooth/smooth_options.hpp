// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/base/error.hpp"

namespace spm::baker {

/// Operators of section 4.1. `gaussian` is eq. 16. `crease` is the same, but stops at sharp edges.
enum class Smoothing { none, gaussian, crease };

/// How a surface is smoothed before it is baked, SI.
struct SmoothOptions {
  Smoothing kind = Smoothing::none;
  double sigma = 0;  ///< of the kernel, m; with `crease` it is 0 until the object's size is known
  double angle = 0;  ///< with `crease`: edges that turn by more stay, rad
};

/// How far a smoothed surface lies from the unsmoothed one, m. Measured in both directions all over
/// both surfaces, weighted by area.
struct SmoothReport {
  SmoothOptions options;  ///< fitted to the object
  double rms = 0, p99 = 0, max = 0;
  std::size_t hidden = 0;  ///< pieces of surface that lie inside other parts and were left out
};

/// The kernel's sigma as a share of the diagonal, where only a crease angle was given.
inline constexpr double crease_sigma_share = 0.01;

/// Reads none, gaussian:SIGMA or crease:ANGLE, with their units. Errors: usage, for anything else,
/// for a sigma that is not above 0, and for an angle that is not between 0 and 180 deg.
[[nodiscard]] Result<SmoothOptions> parse_smoothing(const std::string& text);

/// The options as an asset records them, SI; null without smoothing.
[[nodiscard]] nlohmann::ordered_json smoothing_json(const SmoothOptions& options);

/// The smoothing that an asset's options, a JSON object, record. Errors: invalid_input.
[[nodiscard]] Result<SmoothOptions> recorded_smoothing(const std::string& options);

}  // namespace spm::baker
