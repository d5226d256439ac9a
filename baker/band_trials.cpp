// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/band_trials.hpp"

#include <algorithm>
#include <cstddef>

#include "baker/random.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t numbers = 6;  ///< random ones, a point
/// How far from the surface the places close to it lie, in tolerances.
constexpr double near_tolerances = 2;
constexpr double edge_tolerances = 4;

/// The entry of a list of sums that a share of the whole falls into.
std::size_t fall_into(const std::vector<double>& sums, double share) {
  const auto place = std::upper_bound(sums.begin(), sums.end(), share * sums.back());
  return std::min(static_cast<std::size_t>(place - sums.begin()), sums.size() - 1);
}

}  // namespace

BandTrials::BandTrials(const Caster& caster, const Band& band, double tolerance, std::uint64_t seed)
    : caster_(caster), band_(band), tolerance_(tolerance), seed_(seed) {
  double area = 0, length = 0;
  for (std::uint32_t i = 0; i < caster.surface_count(); ++i) {
    const Vector3& a = caster.corner(i, 0);
    area += (caster.corner(i, 1) - a).cross(caster.corner(i, 2) - a).norm();
    areas_.push_back(area);
    for (int k = 0; k < 3; ++k) {
      length += (caster.corner(i, (k + 1) % 3) - caster.corner(i, k)).norm();
      edges_.push_back(length);
    }
  }
}

Vector3 BandTrials::near_edge(std::uint64_t index) const {
  const auto random = [&](std::uint64_t k) { return random_unit(seed_, numbers * index + k); };
  const std::size_t edge = fall_into(edges_, random(0));
  const auto triangle = static_cast<std::uint32_t>(edge / 3);
  const int corner = static_cast<int>(edge % 3);
  const Vector3& from = caster_.corner(triangle, corner);
  const Vector3& to = caster_.corner(triangle, (corner + 1) % 3);
  // A third of them at corners.
  const double along = std::clamp(1.5 * random(1) - 0.25, 0.0, 1.0);
  const Vector3 off(random(2) - 0.5, random(3) - 0.5, random(4) - 0.5);
  return from + along * (to - from) + 2 * edge_tolerances * tolerance_ * off;
}

Vector3 BandTrials::near_corner(std::uint64_t index) const {
  const auto random = [&](std::uint64_t k) { return random_unit(seed_, numbers * index + k); };
  const std::size_t corner = fall_into(edges_, random(0));
  const Vector3 off(random(1) - 0.5, random(2) - 0.5, random(3) - 0.5);
  return caster_.corner(static_cast<std::uint32_t>(corner / 3), static_cast<int>(corner % 3)) +
         2 * random(4) * band_.max_depth * off;
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
