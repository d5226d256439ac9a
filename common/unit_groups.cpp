// SPDX-License-Identifier: Apache-2.0
#include "common/unit_groups.hpp"

#include <limits>

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/unit_groups.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace spm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Products and sums are not fused, so that every processor gives the same bits.
using Lanes = hn::CappedTag<float, group_units>;
using Floats = hn::Vec<Lanes>;

/// Square of the sine between a triangle's sides below which rounding tells its normal.
constexpr float thin_sine_squared = 1e-8F;

/// A vector in each lane.
struct Floats3 {
  Floats x, y, z;
};

HWY_INLINE Floats3 load(const std::array<GroupLanes, 3>& from, std::size_t k) {
  const Lanes lanes;
  return {hn::Load(lanes, from[0].data() + k), hn::Load(lanes, from[1].data() + k),
          hn::Load(lanes, from[2].data() + k)};
}

HWY_INLINE Floats3 operator-(const Floats3& a, const Floats3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

HWY_INLINE Floats3 scaled(const Floats3& a, Floats by) {
  return {hn::Mul(a.x, by), hn::Mul(a.y, by), hn::Mul(a.z, by)};
}

HWY_INLINE Floats dot(const Floats3& a, const Floats3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE Floats3 cross(const Floats3& a, const Floats3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

HWY_INLINE Floats box_squares(const BoxGroup& group, const Floats3& place, std::size_t k) {
  const Lanes lanes;
  Floats square = hn::Zero(lanes);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Floats at = hn::Add(dot(load(group.axes[axis], k), place),
                              hn::Load(lanes, group.offset[axis].data() + k));
    const Floats half = hn::Load(lanes, group.half[axis].data() + k);
    const Floats beyond = hn::Max(hn::Sub(hn::Abs(at), half), hn::Zero(lanes));
    square = hn::Add(square, hn::Mul(beyond, beyond));
  }
  return square;
}

/// The square of the distance to the segment from a corner, of which `away` is the place.
HWY_INLINE Floats segment_square(const Floats3& away, const Floats3& side, Floats along,
                                 Floats length) {
  const Lanes lanes;
  // A side without a length is its corner.
  const Floats share = hn::Div(along, hn::Max(length, hn::Set(lanes, 1e-30F)));
  const Floats3 off =
      away - scaled(side, hn::Min(hn::Max(share, hn::Zero(lanes)), hn::Set(lanes, 1.0F)));
  return dot(off, off);
}

/// Where the foot on the plane is in the triangle or close to it, the height above the plane:
/// never more than the distance. Elsewhere, and where it is too thin to have a plane, the nearest
/// of the sides.
HWY_INLINE Floats triangle_squares(const TriangleGroup& group, const Floats3& place,
                                   std::size_t k) {
  const Lanes lanes;
  const Floats3 away = place - load(group.corner, k);
  const Floats3 side = load(group.side, k), other = load(group.other, k);
  const Floats3 normal = cross(side, other);
  const Floats ss = dot(side, side), so = dot(side, other), oo = dot(other, other);
  const Floats as = dot(away, side), ao = dot(away, other);
  const Floats area = dot(normal, normal), size = hn::Max(area, hn::Set(lanes, 1e-37F));
  const Floats height = dot(normal, away);
  const Floats level = hn::Div(hn::Mul(height, height), size);
  const Floats u = hn::Sub(hn::Mul(oo, as), hn::Mul(so, ao));
  const Floats v = hn::Sub(hn::Mul(ss, ao), hn::Mul(so, as));
  // Rounding must not take a foot out of a triangle.
  const Floats slack = hn::Mul(size, hn::Set(lanes, 0.01F));
  const auto inside = hn::And(hn::And(hn::Ge(hn::Add(u, slack), hn::Zero(lanes)),
                                      hn::Ge(hn::Add(v, slack), hn::Zero(lanes))),
                              hn::Le(hn::Add(u, v), hn::Add(size, slack)));
  const auto thin = hn::Le(area, hn::Mul(hn::Mul(ss, oo), hn::Set(lanes, thin_sine_squared)));
  const Floats first = segment_square(away, side, as, ss);
  const Floats second = segment_square(away, other, ao, oo);
  const Floats3 across = other - side, from = away - side;
  const Floats third = segment_square(from, across, dot(from, across), dot(across, across));
  const Floats sides = hn::Min(hn::Min(first, second), third);
  return hn::IfThenElse(hn::AndNot(thin, inside), hn::Min(level, sides), sides);
}

std::uint32_t find_squares(std::span<const BoxGroup> boxes,
                           std::span<const TriangleGroup> triangles,
                           std::span<const std::uint32_t> numbers,
                           const std::array<float, 3>& place, float* squares) {
  const Lanes lanes;
  const hn::RebindToSigned<Lanes> whole;
  const Floats3 at{hn::Set(lanes, place[0]), hn::Set(lanes, place[1]), hn::Set(lanes, place[2])};
  Floats least = hn::Set(lanes, std::numeric_limits<float>::infinity());
  auto first = hn::Zero(whole), here = hn::Iota(whole, 0);
  const auto step = hn::Set(whole, static_cast<std::int32_t>(hn::Lanes(lanes)));
  for (const std::uint32_t number : numbers) {
    const std::size_t beyond = number - boxes.size();
    for (std::size_t k = 0; k < group_units; k += hn::Lanes(lanes)) {
      const Floats found = number < boxes.size()       ? box_squares(boxes[number], at, k)
                           : beyond < triangles.size() ? triangle_squares(triangles[beyond], at, k)
                                                       : hn::Set(lanes, empty_square);
      hn::Store(found, lanes, squares + k);
      const auto nearer = hn::Lt(found, least);
      least = hn::IfThenElse(nearer, found, least);
      first = hn::IfThenElse(hn::RebindMask(whole, nearer), here, first);
      here = hn::Add(here, step);
    }
    squares += group_units;
  }
  // Of equals the first, so that every processor tells the same.
  const auto ties = hn::RebindMask(whole, hn::Eq(least, hn::MinOfLanes(lanes, least)));
  const auto none = hn::Set(whole, std::numeric_limits<std::int32_t>::max());
  return static_cast<std::uint32_t>(
      hn::GetLane(hn::MinOfLanes(whole, hn::IfThenElse(ties, first, none))));
}

std::size_t find_near(const float* squares, std::size_t count, float farthest,
                      std::uint32_t* places) {
  const Lanes lanes;
  const hn::RebindToUnsigned<Lanes> whole;
  const Floats most = hn::Set(lanes, farthest);
  auto here = hn::Iota(whole, 0);
  const auto step = hn::Set(whole, static_cast<std::uint32_t>(hn::Lanes(lanes)));
  std::size_t found = 0;
  for (std::size_t k = 0; k < count; k += hn::Lanes(lanes)) {
    const auto near = hn::RebindMask(whole, hn::Le(hn::Load(lanes, squares + k), most));
    found += hn::CompressStore(here, near, whole, places + found);
    here = hn::Add(here, step);
  }
  return found;
}

}  // namespace spm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm {

HWY_EXPORT(find_squares);
HWY_EXPORT(find_near);

std::uint32_t group_squares(std::span<const BoxGroup> boxes,
                            std::span<const TriangleGroup> triangles,
                            std::span<const std::uint32_t> numbers,
                            const std::array<float, 3>& place, float* squares) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_squares)(boxes, triangles, numbers, place, squares);
}

std::size_t near_lanes(const float* squares, std::size_t count, float farthest,
                       std::uint32_t* places) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_near)(squares, count, farthest, places);
}

}  // namespace spm
#endif
