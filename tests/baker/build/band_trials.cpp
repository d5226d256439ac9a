// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/baker/build/band_trials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "common/base/random.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t numbers = 6;  ///< random numbers for each point
/// How far from the surface the places close to it lie, in tolerances.
constexpr double near_tolerances = 2;
/// The smallest distance of places about edges and corners, in tolerances. Their distances are
/// log-uniform.
constexpr double min_tolerances = 0.25;
/// Weight of an edge between triangles in one plane; an edge that turns all the way has weight 1.
constexpr double level_edge_weight = 0.02;

/// The entry of a list of running sums into which a share of the total falls.
std::size_t fall_into(const std::vector<double>& sums, double share) {
  const auto place = std::upper_bound(sums.begin(), sums.end(), share * sums.back());
  return std::min(static_cast<std::size_t>(place - sums.begin()), sums.size() - 1);
}

/// Weights of edges for the trials, by how much the surface turns at each: small for a flat edge,
/// largest for a sharp one. An edge that has not exactly two triangles counts as sharp.
std::vector<double> edge_weights(const Caster& caster) {
  using Ends = std::array<double, 6>;
  const auto ends_of = [&](std::uint32_t edge) {
    const Vector3& a = caster.corner(edge / 3, static_cast<int>(edge % 3));
    const Vector3& b = caster.corner(edge / 3, static_cast<int>((edge + 1) % 3));
    Ends from{a.x(), a.y(), a.z(), b.x(), b.y(), b.z()};
    const Ends to{b.x(), b.y(), b.z(), a.x(), a.y(), a.z()};
    return std::min(from, to);
  };
  const auto count = static_cast<std::uint32_t>(3 * caster.triangle_count());
  std::vector<std::pair<Ends, std::uint32_t>> sides;
  for (std::uint32_t edge = 0; edge < count; ++edge) sides.emplace_back(ends_of(edge), edge);
  std::sort(sides.begin(), sides.end());
  std::vector<double> weights(count);
  for (std::size_t first = 0, end = 0; first < count; first = end) {
    while (end < count && sides[end].first == sides[first].first) ++end;
    double turn = 1;
    if (end - first == 2) {
      const Vector3& normal = caster.normal(sides[first].second / 3);
      turn = (1 - normal.dot(caster.normal(sides[first + 1].second / 3))) / 2;
    }
    const Ends& ends = sides[first].first;
    const double length = Vector3(ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]).norm();
    for (std::size_t k = first; k < end; ++k) {
      weights[sides[k].second] = length * (level_edge_weight + turn);
    }
  }
  return weights;
}

}  // namespace

BandTrials::BandTrials(const Caster& caster, const Band& band, double tolerance, std::uint64_t seed)
    : caster_(caster), band_(band), tolerance_(tolerance), seed_(seed) {
  double area = 0, weight = 0;
  for (std::uint32_t i = 0; i < caster.triangle_count(); ++i) {
    const Vector3& a = caster.corner(i, 0);
    area += (caster.corner(i, 1) - a).cross(caster.corner(i, 2) - a).norm();
    areas_.push_back(area);
  }
  for (const double edge : edge_weights(caster)) edges_.push_back(weight += edge);
}

Vector3 BandTrials::near_edge(std::uint64_t index) const {
  const auto random = [&](std::uint64_t k) { return random_unit(seed_, numbers * index + k); };
  const std::size_t edge = fall_into(edges_, random(0));
  const auto triangle = static_cast<std::uint32_t>(edge / 3);
  const int corner = static_cast<int>(edge % 3);
  const Vector3& from = caster_.corner(triangle, corner);
  const Vector3& to = caster_.corner(triangle, (corner + 1) % 3);
  // A third of them are at corners.
  const double along = std::clamp(1.5 * random(1) - 0.25, 0.0, 1.0);
  return from + along * (to - from) + offset(index);
}

Vector3 BandTrials::near_corner(std::uint64_t index) const {
  const std::size_t corner = fall_into(edges_, random_unit(seed_, numbers * index));
  return caster_.corner(static_cast<std::uint32_t>(corner / 3), static_cast<int>(corner % 3)) +
         offset(index);
}

Vector3 BandTrials::offset(std::uint64_t index) const {
  const auto random = [&](std::uint64_t k) { return random_unit(seed_, numbers * index + k); };
  const double least = min_tolerances * tolerance_;
  const double longest = std::max(band_.max_depth, 2 * least);
  return least * std::pow(longest / least, random(4)) * direction_of(random(2), random(3));
}

Vector3 BandTrials::point(std::uint64_t index) const {
  if (index % 6 == 5) return near_corner(index);
  if (index % 3 == 2) return near_edge(index);
  const auto random = [&](std::uint64_t k) { return random_unit(seed_, numbers * index + k); };
  const auto triangle = static_cast<std::uint32_t>(fall_into(areas_, random(0)));
  double x = random(1), y = random(2);
  if (x + y > 1) {
    x = 1 - x;
    y = 1 - y;
  }
  const double height = index % 3 == 0
                            ? near_tolerances * tolerance_ * (2 * random(3) - 1)
                            : -band_.max_depth + (band_.max_depth + band_.margin) * random(3);
  const Vector3& a = caster_.corner(triangle, 0);
  return a + x * (caster_.corner(triangle, 1) - a) + y * (caster_.corner(triangle, 2) - a) +
         height * caster_.normal(triangle);
}

}  // namespace spm::baker
