// SPDX-License-Identifier: Apache-2.0
#include "common/index/unit_reaches.hpp"

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/index/unit_reaches.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

#include "common/asset/unit_feet-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace spm::HWY_NAMESPACE {

/// How far units are, m, and unit vectors from their nearest places, in the tree's frame; 0 where a
/// place is on them.
struct UnitWays {
  hn::Vec<Lanes> distance;
  Vectors<Lanes> away;
};

/// A unit is not met nearer than so many m, or spacings: there directions are noise.
constexpr float noise = 1e-6F;

HWY_INLINE UnitWays ways_of(const UnitFeet<Lanes>& feet, float least) {
  const Lanes lanes;
  const auto distance = hn::Sqrt(feet.square);
  const auto close = hn::Lt(distance, hn::Set(lanes, least));
  const auto per_distance = hn::IfThenZeroElse(
      close, hn::Div(hn::Set(lanes, 1.0F), hn::Max(distance, hn::Set(lanes, 1e-20F))));
  return {hn::IfThenZeroElse(close, distance), scaled<Lanes>(feet.off, per_distance)};
}

/// A cell leaves its mean plane by no more than a quarter of its twist.
HWY_INLINE UnitWays cell_ways(const CellGroup& group, const std::array<float, 3>& place,
                              std::size_t k) {
  const Lanes lanes;
  const One<CellGroup> source{&group, k};
  const Cells<One<CellGroup>> cells(source, place);
  const UnitWays ways = ways_of(cells.template nearest<false>(), 100 * noise);
  const auto thick = hn::Mul(hn::Abs(cells.twist), hn::Set(lanes, 0.25F));
  const auto along = [&](std::size_t axis) {
    const auto part = [&](std::size_t own, hn::Vec<Lanes> way) {
      return hn::Mul(way, hn::Set(lanes, group.spacing * group.steps[axis][own]));
    };
    return hn::Add(hn::Add(part(0, ways.away.x), part(1, ways.away.y)), part(2, ways.away.z));
  };
  return {hn::Mul(hn::Max(hn::Sub(ways.distance, thick), hn::Zero(lanes)),
                  hn::Set(lanes, group.spacing)),
          {along(0), along(1), along(2)}};
}

/// A convex unit is no nearer to a corner than what its distance and direction at the middle tell,
/// and the difference of a convex bound and that is largest at a corner.
HWY_INLINE hn::Vec<Lanes> excess_of(const UnitWays& ways, const SurfaceCube& cube) {
  const Lanes lanes;
  const Vectors<Lanes> step = scaled<Lanes>(ways.away, hn::Set(lanes, cube.half));
  auto excess = hn::Set(lanes, -empty_lane);
  for (const std::array<float, 8>& known : cube.known) {
    auto least = hn::Set(lanes, empty_lane);
    for (unsigned corner = 0; corner < known.size(); ++corner) {
      const auto x = (corner & 1U) != 0 ? step.x : hn::Neg(step.x);
      const auto y = (corner & 2U) != 0 ? step.y : hn::Neg(step.y);
      const auto z = (corner & 4U) != 0 ? step.z : hn::Neg(step.z);
      const auto there = hn::Add(hn::Add(x, y), z);
      least = hn::Min(least, hn::Sub(there, hn::Set(lanes, known[corner])));
    }
    excess = hn::Max(excess, least);
  }
  return hn::Add(ways.distance, excess);
}

void find_reaches(const UnitGroups& groups, std::span<const std::uint32_t> numbers,
                  const SurfaceCube& cube, float slack, GroupReach* reaches) {
  const Lanes lanes;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t number = numbers[i], beyond = number - groups.cells.size();
    GroupReach reach{empty_lane, 0};
    for (std::size_t k = 0; k < group_units; k += hn::Lanes(lanes)) {
      auto found = hn::Set(lanes, empty_lane);
      if (number < groups.cells.size()) {
        found = excess_of(cell_ways(groups.cells[number], cube.middle, k), cube);
      } else if (beyond < groups.triangles.size()) {
        const One<TriangleGroup> source{&groups.triangles[beyond], k};
        const auto feet = triangle_feet<false>(source, cube.middle, 0, safe_rounding);
        found = excess_of(ways_of(feet, noise), cube);
      }
      reach.least = std::min(reach.least, hn::GetLane(hn::MinOfLanes(lanes, found)));
      std::array<std::uint8_t, 8> bits{};
      hn::StoreMaskBits(lanes, hn::Le(found, hn::Set(lanes, slack)), bits.data());
      reach.lanes |= std::uint32_t{bits[0]} << k;
    }
    reaches[i] = reach;
  }
}

}  // namespace spm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm {

HWY_EXPORT(find_reaches);

void group_reaches(const UnitGroups& groups, std::span<const std::uint32_t> numbers,
                   const SurfaceCube& cube, float slack, GroupReach* reaches) noexcept {
  HWY_DYNAMIC_DISPATCH(find_reaches)(groups, numbers, cube, slack, reaches);
}

}  // namespace spm
#endif
