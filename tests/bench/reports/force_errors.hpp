// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::bench {

/// The ground truth at a probe's centre at a tick, from the exact mesh.
struct ExactTick {
  double distance = 0;                ///< signed, m, negative inside
  Vector3 outward = Vector3::Zero();  ///< unit: gradient of the distance
  bool contested = false;             ///< another feature is nearly as near: see ExactSurface
  bool sliding = true;                ///< neither being lifted nor pressed
  bool fresh = false;                 ///< the path restarts here: no step leads here
};

/// Force of the exact penalty, N: stiffness (N/m) times depth along the normal, for a ball of
/// `radius`, m, 0 for a point; zero if the ball does not reach the surface.
[[nodiscard]] Vector3 exact_penalty(const ExactTick& tick, double stiffness, double radius);

/// Nearest-rank quantiles of the counted values; all 0 if there are none.
struct Quantiles {
  double p50 = 0, p99 = 0, p999 = 0, max = 0;
  std::uint64_t count = 0;
};
[[nodiscard]] Quantiles quantiles_of(std::vector<double> values);

/// A hand feels exact steps below this, N, as smooth.
inline constexpr double smooth_step = 0.05;

/// Counts of the ticks in contact by the exact mesh: those compared, and why others are left out.
struct JudgedTicks {
  std::uint64_t contacts = 0;  ///< inside, or the ball reaches in
  // Counts of the contacts by the first cause that applies.
  std::uint64_t deep = 0;       ///< deeper than the band
  std::uint64_t contested = 0;  ///< near the medial axis
  std::uint64_t judged = 0;     ///< the rest
};
[[nodiscard]] JudgedTicks count_judged(std::span<const ExactTick> ticks, double max_depth,
                                       double radius);

/// How a method's forces differ from the exact ones.
struct ForceErrors {
  double exact_rms = 0;        ///< N, of the exact forces over the judged ticks
  double difference_rms = 0;   ///< N, of the difference (a vector's length), same ticks
  Quantiles direction;         ///< rad between the two, where both push
  std::uint64_t missing = 0;   ///< judged ticks without a force
  std::uint64_t spurious = 0;  ///< ticks with a force though farther outside than `slack`
  Quantiles step;              ///< N, |F_t - F_(t-1)| of the method, while sliding
  Quantiles excess;        ///< N, step minus the exact step, if the exact one is below smooth_step
  Quantiles clear_excess;  ///< the part of these where both ticks are judged

  [[nodiscard]] double relative() const noexcept {
    return exact_rms > 0 ? difference_rms / exact_rms : 0;
  }
};

/// The parameters of the force comparison.
struct ForceRules {
  double stiffness = 1e3;   ///< N/m
  double radius = 0;        ///< m, of the probe
  double max_depth = 2e-3;  ///< m, of the band
  double slack = 1e-4;      ///< m: the asset's tolerance
};

/// Compares the forces of a method, one per tick, with those of the exact penalty.
[[nodiscard]] ForceErrors force_errors(std::span<const ExactTick> ticks,
                                       std::span<const Vector3> forces, const ForceRules& rules);

}  // namespace spm::bench
