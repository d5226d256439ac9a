// SPDX-License-Identifier: Apache-2.0
#include "common/quarter_feet.hpp"

#include <limits>

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/quarter_feet.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace spm::HWY_NAMESPACE {

/// Products and sums are not fused, so that every processor gives the same bits.
void find_feet(const TileQuarter& quarter, const QuarterPlace& place, QuarterFeet& feet) {
  namespace hn = hwy::HWY_NAMESPACE;
  alignas(64) static constexpr std::array<float, quarter_cells> middles_x{
      0.5F, 1.5F, 2.5F, 3.5F, 0.5F, 1.5F, 2.5F, 3.5F,
      0.5F, 1.5F, 2.5F, 3.5F, 0.5F, 1.5F, 2.5F, 3.5F};
  alignas(64) static constexpr std::array<float, quarter_cells> middles_y{
      0.5F, 0.5F, 0.5F, 0.5F, 1.5F, 1.5F, 1.5F, 1.5F,
      2.5F, 2.5F, 2.5F, 2.5F, 3.5F, 3.5F, 3.5F, 3.5F};
  const hn::CappedTag<float, quarter_cells> lanes;
  const auto half = hn::Set(lanes, 0.5F), low = hn::Set(lanes, -0.5F), one = hn::Set(lanes, 1.0F);
  const auto px = hn::Set(lanes, place.x), py = hn::Set(lanes, place.y),
             pz = hn::Set(lanes, place.z);
  auto least = hn::Set(lanes, std::numeric_limits<float>::infinity());
  for (std::size_t k = 0; k < quarter_cells; k += hn::Lanes(lanes)) {
    const auto sx = hn::Load(lanes, quarter.slope_eta.data() + k);
    const auto sy = hn::Load(lanes, quarter.slope_omega.data() + k);
    const auto twist = hn::Load(lanes, quarter.twist.data() + k);
    const auto dx = hn::Sub(px, hn::Load(lanes, middles_x.data() + k));
    const auto dy = hn::Sub(py, hn::Load(lanes, middles_y.data() + k));
    const auto dz = hn::Sub(pz, hn::Load(lanes, quarter.depth.data() + k));
    // Divisions first, which hang on the quarter alone: nothing waits for them.
    const auto square_x = hn::Mul(sx, sx), level_y = hn::Add(hn::Mul(sy, sy), one);
    const auto per_level = hn::Div(one, hn::Add(square_x, level_y));
    const auto per_y = hn::Div(one, level_y), per_x = hn::Div(one, hn::Add(square_x, one));
    const auto along = hn::Mul(hn::Sub(hn::Sub(dz, hn::Mul(sx, dx)), hn::Mul(sy, dy)), per_level);
    const auto clamp = [&](auto value) { return hn::Min(hn::Max(value, low), half); };
    // The least over a rectangle lies on a side that the free foot is beyond: one each is tried.
    const auto x1 = clamp(hn::Add(dx, hn::Mul(along, sx)));
    const auto y2 = clamp(hn::Add(dy, hn::Mul(along, sy)));
    const auto y1 = clamp(hn::Mul(hn::Add(dy, hn::Mul(sy, hn::Sub(dz, hn::Mul(sx, x1)))), per_y));
    const auto x2 = clamp(hn::Mul(hn::Add(dx, hn::Mul(sx, hn::Sub(dz, hn::Mul(sy, y2)))), per_x));
    const auto square = [&](auto x, auto y) {
      const auto below = hn::Sub(hn::Sub(hn::Sub(dz, hn::Mul(sx, x)), hn::Mul(sy, y)),
                                 hn::Mul(hn::Mul(twist, x), y));
      const auto off_x = hn::Sub(dx, x), off_y = hn::Sub(dy, y);
      return hn::Add(hn::Add(hn::Mul(off_x, off_x), hn::Mul(off_y, off_y)), hn::Mul(below, below));
    };
    const auto square1 = square(x1, y1), square2 = square(x2, y2);
    const auto first = hn::Le(square1, square2);
    hn::Store(hn::IfThenElse(first, x1, x2), lanes, feet.x.data() + k);
    hn::Store(hn::IfThenElse(first, y1, y2), lanes, feet.y.data() + k);
    const auto smaller = hn::Min(square1, square2);
    hn::Store(smaller, lanes, feet.square.data() + k);
    least = hn::Min(least, smaller);
  }
  least = hn::MinOfLanes(lanes, least);
  feet.least = hn::GetLane(least);
  feet.nearest = 0;
  for (std::size_t k = 0; k < quarter_cells; k += hn::Lanes(lanes)) {
    const auto found =
        hn::FindFirstTrue(lanes, hn::Eq(hn::Load(lanes, feet.square.data() + k), least));
    if (found < 0) continue;
    feet.nearest = static_cast<std::uint32_t>(k) + static_cast<std::uint32_t>(found);
    break;
  }
}

}  // namespace spm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm {

HWY_EXPORT(find_feet);

void quarter_feet(const TileQuarter& quarter, const QuarterPlace& place,
                  QuarterFeet& feet) noexcept {
  HWY_DYNAMIC_DISPATCH(find_feet)(quarter, place, feet);
}

}  // namespace spm
#endif
