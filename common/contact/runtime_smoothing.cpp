// SPDX-License-Identifier: Apache-2.0
#include "common/contact/runtime_smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/query/query.hpp"

namespace spm {

namespace {

/// Offsets of a kernel's samples in sigmas: the middle, then pairs of opposite points that follow
/// the golden angle around the sphere, so that their mean is 0. Their radii divide the weight
/// evenly.
Vector3 offset(std::uint32_t sample, std::uint32_t samples) noexcept {
  if (sample == 0) return Vector3::Zero();
  const std::uint32_t pair = (sample - 1) / 2, pairs = samples / 2;
  const double share = (pair + 0.5) / pairs;
  const double height =
      1 - share;  // one half of the sphere; the other point of the pair is opposite
  const double around = 2 * std::numbers::pi * (2 - std::numbers::phi) * pair;
  const double width = std::sqrt(std::max(1 - height * height, 0.0));
  const double side = (sample & 1U) != 0 ? 1 : -1;
  // The mean square of the radius of a Gaussian in space is 3; the radii are spread around its
  // root.
  const double radius = std::sqrt(3.0) * (0.6 + 0.8 * ((pair * 7U % pairs) + 0.5) / pairs);
  return side * radius * Vector3(width * std::cos(around), width * std::sin(around), height);
}

}  // namespace

SmoothedAnswer smoothed_query(const AssetView& asset, const RuntimeSmoothing& smoothing,
                              const Vector3& point) noexcept {
  // Pairs, and the sample in the middle.
  const std::uint32_t samples = std::clamp(smoothing.samples, 1U, max_smoothing_samples) | 1U;
  SmoothedAnswer result;
  double known = 0;
  for (std::uint32_t k = 0; k < samples; ++k) {
    const Answer answer = query_point(asset, point + smoothing.sigma * offset(k, samples));
    double distance = asset.band.margin;
    if (is_known(answer.status)) {
      distance = answer.distance;
      result.known = true;
    } else if (k == 0 && answer.status == Status::pruned) {
      return {};
    }
    result.deep = result.deep || (k == 0 && answer.status == Status::deep);
    result.distance += distance;
    result.gradient += answer.normal;
    ++known;
  }
  result.distance /= known;
  result.gradient /= known;
  return result;
}

}  // namespace spm
