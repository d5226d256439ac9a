// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "baker/field/cube_candidates.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// A place of a cube, its signed distance (m) and the gradient of that.
struct CubeSample {
  Vector3 place = Vector3::Zero();  ///< from the middle, in halves of the edge
  double distance = 0;
  Vector3 gradient = Vector3::Zero();
  std::uint32_t triangle = 0;  ///< the nearest
  std::uint32_t beside = 0;    ///< another one that is as near, or the same
};

/// Samples of the signed distance over a cube, from its candidates. `inside` is the side of the
/// whole cube; where it is empty the surface passes, and each sample finds its own.
[[nodiscard]] std::vector<CubeSample> sample_cube(const LatticeSurface& surface,
                                                  const Candidates& candidates, const Cube& cube,
                                                  std::optional<bool> inside);

/// Whether a sample lies in the band, or no more than `beyond` metres outside it.
[[nodiscard]] bool in_band(const CubeSample& sample, const Band& band, double beyond);

/// The numbers of the samples that do.
[[nodiscard]] std::vector<std::size_t> about_band(const std::vector<CubeSample>& samples,
                                                  const Band& band, double beyond);

/// Judges what is told of samples: the error of each in the band, and directions in the mean.
class SampleJudge {
 public:
  /// `max_error` in m, `max_mean_angle` in rad.
  SampleJudge(const Band& band, double max_error, double max_mean_angle)
      : band_(band), max_error_(max_error), max_mean_angle_(max_mean_angle) {}

  /// Whether a value, m, meets a sample.
  [[nodiscard]] bool meets(const CubeSample& sample, double value) const;
  /// Takes a slope there, of any length, into the mean.
  void add(const CubeSample& sample, const Vector3& slope);
  /// Whether the slopes of all samples do in the mean.
  [[nodiscard]] bool meets_directions() const {
    return judged_ == 0 || angles_ <= max_mean_angle_ * static_cast<double>(judged_);
  }

 private:
  Band band_;
  double max_error_, max_mean_angle_;
  double angles_ = 0;
  std::size_t judged_ = 0;
};

/// Tells the chosen samples apart by their directions: for each sample, to which of two it belongs.
[[nodiscard]] std::vector<bool> by_direction(const std::vector<CubeSample>& samples,
                                             const std::vector<std::size_t>& chosen);

}  // namespace spm::baker
