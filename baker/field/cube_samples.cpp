// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/cube_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "baker/field/corner_distances.hpp"
#include "common/base/octant.hpp"

namespace spm::baker {

namespace {

constexpr int nodes = 4;  ///< samples along each axis
/// Directions of two pieces are told apart in so many rounds.
constexpr int rounds = 6;
/// Of doubles, m.
constexpr double rounding = 1e-12;

/// Samples lie at the nodes of Chebyshev's polynomials, cos(pi / 8) and cos(3 pi / 8) from the
/// middle along each axis: at the corners of eight cubes, with middles and half edges of these.
const double sample_middle =
    (std::cos(std::numbers::pi / 8) + std::cos(3 * std::numbers::pi / 8)) / 2;
const double sample_half =
    (std::cos(std::numbers::pi / 8) - std::cos(3 * std::numbers::pi / 8)) / 2;

/// Of a place: the nearest triangle and another one that is as near, or the same; their numbers
/// among candidates.
struct Nearest {
  std::size_t first = 0, beside = 0;
};

/// Those of eight places, the corners of a cube about the middle `place` of another one, in halves
/// of its edge.
std::array<Nearest, 8> nearest_to_corners(const LatticeSurface& surface,
                                          const CandidatesOfKind& candidates, const Cube& cube,
                                          const Vector3& place) {
  const Vector3 offset = cube.half * place, middle = cube.middle + offset;
  const double half = cube.half * sample_half, way = offset.norm() + std::sqrt(3.0) * half;
  CornerValues least = CornerValues::Constant(std::numeric_limits<double>::infinity());
  double most = least[0];  // of these
  std::array<Nearest, 8> nearest{};
  for (std::size_t c = 0; c < candidates.triangles.size(); ++c) {
    const Candidate& candidate = candidates.triangles[c];
    // A distance changes by no more than the way from the middle; those that follow are farther.
    if (candidate.distance - way > most) break;
    // It is convex, so it lies above its tangent at the middle.
    const double tangent =
        candidate.distance + candidate.tangent.dot(offset) - half * candidate.tangent.lpNorm<1>();
    if (tangent > most) continue;
    const CornerValues distances =
        surface.triangles[candidate.triangle].corner_distances(middle, half);
    for (std::size_t k = 0; k < nearest.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      if (distances[at] > least[at] + rounding) continue;
      nearest[k].beside = c;
      if (distances[at] >= least[at]) continue;
      if (distances[at] < least[at] - rounding) {
        nearest[k].first = c;
      }
      least[at] = distances[at];
    }
    most = least.maxCoeff() + rounding;
  }
  return nearest;
}

}  // namespace

bool in_band(const CubeSample& sample, const Band& band, double beyond) {
  return sample.distance <= band.margin + beyond && sample.distance >= -band.max_depth - beyond;
}

std::vector<std::size_t> about_band(const std::vector<CubeSample>& samples, const Band& band,
                                    double beyond) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (in_band(samples[i], band, beyond)) numbers.push_back(i);
  }
  return numbers;
}

std::vector<bool> by_direction(const std::vector<CubeSample>& samples,
                               const std::vector<std::size_t>& chosen) {
  Vector3 first = samples[chosen.front()].gradient;
  Vector3 second = first;
  const auto farthest = [&](const Vector3& from) {
    return samples[*std::min_element(chosen.begin(), chosen.end(),
                                     [&](auto a, auto b) {
                                       return samples[a].gradient.dot(from) <
                                              samples[b].gradient.dot(from);
                                     })]
        .gradient;
  };
  second = farthest(first);
  first = farthest(second);
  std::vector<bool> is_second(samples.size(), false);
  for (int round = 0; round < rounds; ++round) {
    Vector3 sums[2] = {Vector3::Zero(), Vector3::Zero()};
    for (const std::size_t i : chosen) {
      is_second[i] = samples[i].gradient.dot(second) > samples[i].gradient.dot(first);
      sums[is_second[i] ? 1 : 0] += samples[i].gradient;
    }
    if (sums[0].norm() > 0) first = sums[0].normalized();
    if (sums[1].norm() > 0) second = sums[1].normalized();
  }
  return is_second;
}

bool SampleJudge::meets(const CubeSample& sample, double value) const {
  const double told = std::clamp(value, -band_.max_depth, band_.margin);
  const double truth = std::clamp(sample.distance, -band_.max_depth, band_.margin);
  return std::abs(told - truth) <= max_error_;
}

void SampleJudge::add(const CubeSample& sample, const Vector3& slope) {
  if (!in_band(sample, band_, 0)) return;
  const double length = slope.norm() * sample.gradient.norm();
  const double cosine = length > 0 ? slope.dot(sample.gradient) / length : 0;
  angles_ += std::acos(std::clamp(cosine, -1.0, 1.0));
  ++judged_;
}

std::vector<CubeSample> sample_cube(const LatticeSurface& surface, const Candidates& all,
                                    const Cube& cube, std::optional<bool> inside) {
  const CandidatesOfKind& candidates = all.only_kind();
  const double felt = felt_nearer(surface, all);
  std::vector<CubeSample> samples(std::size_t{nodes} * nodes * nodes);
  for (std::size_t block = 0; block < 8; ++block) {
    const Vector3 middle = sample_middle * octant_direction(block);
    const auto nearest = nearest_to_corners(surface, candidates, cube, middle);
    for (std::size_t k = 0; k < nearest.size(); ++k) {
      std::size_t number = 0;
      for (const std::size_t axis : {2U, 1U, 0U}) {
        number = nodes * number + (is_upper(block, axis) ? 2U : 0U) + (is_upper(k, axis) ? 1U : 0U);
      }
      CubeSample& sample = samples[number];
      sample.place = middle + sample_half * octant_direction(k);
      const Vector3 point = cube.middle + cube.half * sample.place;
      NearestPart part;
      if (!candidates.triangles.empty()) {
        sample.triangle = candidates.triangles[nearest[k].first].triangle;
        sample.beside = candidates.triangles[nearest[k].beside].triangle;
        part.meet(surface.triangles[sample.triangle], point);
      }
      const bool within = inside ? *inside : part.is_inside(surface, point);
      const double distance = within ? -part.distance : part.distance;
      sample.distance = distance - felt;
      if (part.distance > 0) {
        sample.gradient = (point - part.closest.point) / distance;
      } else if (part.triangle != nullptr) {
        sample.gradient = part.triangle->normal;
      }
    }
  }
  return samples;
}

}  // namespace spm::baker
