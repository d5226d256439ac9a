// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/map_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace spm::baker {

namespace {

constexpr int unknowns = 10;
/// Weight with which slope and bend are drawn to 0 where samples do not tell them.
constexpr double ridge = 1e-6;

using Row = Eigen::Matrix<double, 1, unknowns>;
using Square = Eigen::Matrix<double, unknowns, unknowns>;
using Column = Eigen::Matrix<double, unknowns, 1>;

Row terms(const Vector3& z) {
  Row row;
  row << 1, z[0], z[1], z[2], z[0] * z[0], z[1] * z[1], z[2] * z[2], z[0] * z[1], z[0] * z[2],
      z[1] * z[2];
  return row;
}

/// The support plane that faces a direction most.
std::uint32_t facing_plane(std::span<const SupportPlane> planes, const Vector3& direction) {
  std::uint32_t best = 0;
  for (std::uint32_t k = 1; k < planes.size() && k < 256; ++k) {
    if (planes[k].n.dot(direction) > planes[best].n.dot(direction)) best = k;
  }
  return best;
}

/// A cubic function along the cube's axes in the frame of a plane.
LocalMap in_plane_frame(const Column& solution, std::uint32_t number, const SupportPlane& plane) {
  Eigen::Matrix3d turn;  // rows: the plane's axes
  turn << plane.u.transpose(), plane.v.transpose(), -plane.n.transpose();
  Eigen::Matrix3d bend;
  bend << solution[4], solution[7] / 2, solution[8] / 2, solution[7] / 2, solution[5],
      solution[9] / 2, solution[8] / 2, solution[9] / 2, solution[6];
  const Eigen::Matrix3d turned = turn * bend * turn.transpose();
  LocalMap map;
  map.plane = number;
  map.value = solution[0];
  map.slope = turn * Vector3(solution[1], solution[2], solution[3]);
  map.bend = {turned(0, 0),     turned(1, 1),     turned(2, 2),
              2 * turned(0, 1), 2 * turned(0, 2), 2 * turned(1, 2)};
  return map;
}

struct Packed {
  PackedLocalMap words;
  LocalMap map;
};

/// Fits the samples whose numbers are given; their residuals are balanced after rounding.
std::optional<Packed> fit(const std::vector<CubeSample>& samples,
                          const std::vector<std::size_t>& chosen, const Cube& cube,
                          const FitRules& rules) {
  Square normal = Square::Zero();
  Column right = Column::Zero();
  Vector3 direction = Vector3::Zero();
  for (const std::size_t i : chosen) {
    const Row row = terms(samples[i].place);
    normal += row.transpose() * row;
    right += row.transpose() * (samples[i].distance / cube.half);
    direction += samples[i].gradient;
  }
  const double weight = ridge * static_cast<double>(chosen.size());
  for (int k = 1; k < unknowns; ++k) normal(k, k) += weight;
  const Column solution = normal.ldlt().solve(right);
  if (!solution.allFinite()) return std::nullopt;
  const std::uint32_t plane = facing_plane(rules.planes, direction);
  Packed packed;
  LocalMap map = in_plane_frame(solution, plane, rules.planes[plane]);
  const double unit = rules.value_unit / cube.half;
  if (!pack_local_map(map, unit, packed.words)) return std::nullopt;
  packed.map = unpack_local_map(packed.words.words.data(), unit);
  double low = 0, high = 0;
  bool first = true;
  for (const std::size_t i : chosen) {
    const double off = samples[i].distance / cube.half -
                       packed.map.at(local_coordinates(rules.planes[plane], samples[i].place));
    low = first ? off : std::min(low, off);
    high = first ? off : std::max(high, off);
    first = false;
  }
  LocalMap balanced = packed.map;
  balanced.value += (low + high) / 2;
  if (!pack_local_map(balanced, unit, packed.words)) return std::nullopt;
  packed.map = unpack_local_map(packed.words.words.data(), unit);
  return packed;
}

/// Whether the maps meet the samples of the band.
bool meets(const FittedMaps& fitted, const std::vector<CubeSample>& samples, const Cube& cube,
           const FitRules& rules) {
  SampleJudge judge(rules.band, rules.max_error, rules.max_mean_angle);
  for (const CubeSample& sample : samples) {
    double value = 0;
    Vector3 slope = Vector3::Zero();
    for (std::size_t k = 0; k < fitted.maps.size(); ++k) {
      const LocalMap& map = fitted.maps[k];
      const SupportPlane& plane = rules.planes[map.plane];
      const Vector3 z = local_coordinates(plane, sample.place);
      const double here = map.at(z);
      if (k > 0 && (here < value) != (fitted.kind == OctreeKind::least)) continue;
      value = here;
      const Vector3 gradient = map.gradient(z);
      slope = from_plane_frame(plane, gradient[0], gradient[1], gradient[2]);
    }
    if (!judge.meets(sample, cube.half * value)) return false;
    judge.add(sample, slope);
  }
  return judge.meets_directions();
}

}  // namespace

std::optional<FittedMaps> fit_one(const std::vector<CubeSample>& samples, const Cube& cube,
                                  const FitRules& rules) {
  std::vector<std::size_t> chosen = about_band(samples, rules.band, cube.half);
  if (chosen.size() < unknowns) {
    chosen.clear();
    for (std::size_t i = 0; i < samples.size(); ++i) chosen.push_back(i);
  }
  const std::optional<Packed> packed = fit(samples, chosen, cube, rules);
  if (!packed) return std::nullopt;
  FittedMaps fitted{OctreeKind::polynomial, {packed->words}, {packed->map}};
  if (!meets(fitted, samples, cube, rules)) return std::nullopt;
  return fitted;
}

std::optional<FittedMaps> fit_two(const std::vector<CubeSample>& samples, const Cube& cube,
                                  const FitRules& rules) {
  const std::vector<std::size_t> chosen = about_band(samples, rules.band, cube.half);
  if (chosen.size() < 2) return std::nullopt;
  const std::vector<bool> is_second = by_direction(samples, chosen);
  std::array<std::vector<std::size_t>, 2> parts;
  for (const std::size_t i : chosen) parts[is_second[i] ? 1 : 0].push_back(i);
  FittedMaps fitted;
  for (const auto& part : parts) {
    if (part.size() < 4) return std::nullopt;
    const std::optional<Packed> packed = fit(samples, part, cube, rules);
    if (!packed) return std::nullopt;
    fitted.packed.push_back(packed->words);
    fitted.maps.push_back(packed->map);
  }
  for (const OctreeKind kind : {OctreeKind::least, OctreeKind::most}) {
    fitted.kind = kind;
    if (meets(fitted, samples, cube, rules)) return fitted;
  }
  return std::nullopt;
}

}  // namespace spm::baker
