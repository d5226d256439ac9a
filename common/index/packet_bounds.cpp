// SPDX-License-Identifier: Apache-2.0
#include "common/index/packet_bounds.hpp"

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/index/packet_bounds.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

#include "common/asset/closest_on_primitives-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace spm::HWY_NAMESPACE {

/// How far primitives are, m, and unit vectors from their nearest places, in the tree's frame; 0
/// where a place is on them.
struct PrimitiveDirections {
  hn::Vec<Lanes> distance;
  Vectors<Lanes> away;
};

/// A primitive is not met nearer than so many m, or spacings: there directions are noise.
constexpr float noise = 1e-6F;

HWY_INLINE PrimitiveDirections directions_of(const PrimitiveClosestPoints<Lanes>& closest_points,
                                             float least) {
  const Lanes lanes;
  const auto distance = hn::Sqrt(closest_points.square);
  const auto close = hn::Lt(distance, hn::Set(lanes, least));
  const auto per_distance = hn::IfThenZeroElse(
      close, hn::Div(hn::Set(lanes, 1.0F), hn::Max(distance, hn::Set(lanes, 1e-20F))));
  return {hn::IfThenZeroElse(close, distance), scaled<Lanes>(closest_points.off, per_distance)};
}

/// A cell leaves its mean plane by no more than a quarter of its twist.
HWY_INLINE PrimitiveDirections cell_directions(const CellPacket& packet,
                                               const std::array<float, 3>& place, std::size_t k) {
  const Lanes lanes;
  const One<CellPacket> source{&packet, k};
  const Cells<One<CellPacket>> cells(source, place);
  const PrimitiveDirections directions =
      directions_of(cells.template nearest<false>(), 100 * noise);
  const auto thick = hn::Mul(hn::Abs(cells.twist), hn::Set(lanes, 0.25F));
  const auto along = [&](std::size_t axis) {
    const auto part = [&](std::size_t own, hn::Vec<Lanes> way) {
      return hn::Mul(way, hn::Set(lanes, packet.spacing * packet.steps[axis][own]));
    };
    return hn::Add(hn::Add(part(0, directions.away.x), part(1, directions.away.y)),
                   part(2, directions.away.z));
  };
  return {hn::Mul(hn::Max(hn::Sub(directions.distance, thick), hn::Zero(lanes)),
                  hn::Set(lanes, packet.spacing)),
          {along(0), along(1), along(2)}};
}

/// A convex primitive is no nearer to a corner than what its distance and direction at the middle
/// tell, and the difference of a convex bound and that is largest at a corner.
HWY_INLINE hn::Vec<Lanes> excess_of(const PrimitiveDirections& directions,
                                    const SurfaceCube& cube) {
  const Lanes lanes;
  const Vectors<Lanes> step = scaled<Lanes>(directions.away, hn::Set(lanes, cube.half));
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
  return hn::Add(directions.distance, excess);
}

void find_bounds(const PrimitivePackets& packets, std::span<const std::uint32_t> numbers,
                 const SurfaceCube& cube, float slack, PacketBounds* bounds) {
  const Lanes lanes;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t number = numbers[i], beyond = number - packets.cells.size();
    PacketBounds bound{empty_lane, 0};
    for (std::size_t k = 0; k < packet_width; k += hn::Lanes(lanes)) {
      auto found = hn::Set(lanes, empty_lane);
      if (number < packets.cells.size()) {
        found = excess_of(cell_directions(packets.cells[number], cube.middle, k), cube);
      } else if (beyond < packets.triangles.size()) {
        const One<TrianglePacket> source{&packets.triangles[beyond], k};
        const auto closest_points =
            closest_on_triangles<false>(source, cube.middle, 0, safe_rounding);
        found = excess_of(directions_of(closest_points, noise), cube);
      }
      bound.lower_bound = std::min(bound.lower_bound, hn::GetLane(hn::MinOfLanes(lanes, found)));
      std::array<std::uint8_t, 8> bits{};
      hn::StoreMaskBits(lanes, hn::Le(found, hn::Set(lanes, slack)), bits.data());
      bound.lanes |= std::uint32_t{bits[0]} << k;
    }
    bounds[i] = bound;
  }
}

}  // namespace spm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm {

HWY_EXPORT(find_bounds);

void packet_bounds(const PrimitivePackets& packets, std::span<const std::uint32_t> numbers,
                   const SurfaceCube& cube, float slack, PacketBounds* bounds) noexcept {
  HWY_DYNAMIC_DISPATCH(find_bounds)(packets, numbers, cube, slack, bounds);
}

}  // namespace spm
#endif
