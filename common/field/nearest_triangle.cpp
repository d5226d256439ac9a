// SPDX-License-Identifier: Apache-2.0
#include "common/field/nearest_triangle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/field/feature_sides.hpp"
#include "common/surface/closest_on_triangle.hpp"

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/field/nearest_triangle.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace spm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Products and sums are not fused, so that every processor gives the same bits.
using Lanes = hn::CappedTag<float, packet_size>;
using Floats = hn::Vec<Lanes>;

/// A vector in each lane.
struct Vectors {
  Floats x, y, z;
};

HWY_INLINE Floats dot(const Vectors& a, const Vectors& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

/// Whole lattice steps in each lane.
using WholeLanes = hn::RebindToSigned<Lanes>;
struct WholeVectors {
  hn::Vec<WholeLanes> x, y, z;
};

/// Exact: corners lie within 2^corner_bits steps of each other.
HWY_INLINE Vectors between(const WholeVectors& from, const WholeVectors& to) {
  const Lanes lanes;
  return {hn::ConvertTo(lanes, hn::Sub(to.x, from.x)), hn::ConvertTo(lanes, hn::Sub(to.y, from.y)),
          hn::ConvertTo(lanes, hn::Sub(to.z, from.z))};
}

/// A point in lattice steps: whole ones and the rest.
struct LatticePlace {
  std::array<std::int32_t, 3> whole{};
  std::array<float, 3> rest{};
};

HWY_INLINE LatticePlace lattice_place(const IndexedTriangles& mesh, const Vector3& point) {
  LatticePlace place;
  const double per_step = 1 / mesh.step;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<int>(axis);
    // Far outside all corners nothing depends on where; no number is too large to be whole.
    const double step = std::min(std::max((point[k] - mesh.origin[k]) * per_step, -1e8), 1e8);
    place.whole[axis] = static_cast<std::int32_t>(step);
    place.rest[axis] = static_cast<float>(step - place.whole[axis]);
  }
  return place;
}

/// The triangles of a packet: where the words of their corners are.
struct Packet {
  std::array<std::array<const std::uint32_t*, packet_size>, 3> corners;
  std::uint32_t thin = 0;  ///< a bit each
};

/// The triangle at a place of a list; any where there is none of that number.
HWY_INLINE std::uint32_t listed_triangle(const TriangleList& list, std::size_t place,
                                         std::uint32_t triangle_count) {
  const auto* numbers = reinterpret_cast<const char*>(list.words + 1);
  std::uint32_t number = 0;
  if (list.wide) {
    std::memcpy(&number, numbers + 4 * place, 4);
  } else {
    std::memcpy(&number, numbers + 2 * place, 2);
  }
  number += list.words[0] & list_first_mask;
  return number < triangle_count ? number : 0;
}

/// The triangles from the `first` of the list on; the last before `end` again and again where there
/// are fewer.
HWY_INLINE void load_packet(const IndexedTriangles& mesh, const TriangleList& list,
                            std::size_t first, std::size_t end, Packet& packet) {
  // By themselves, since the compiler cannot know that storing the packet leaves them as they are.
  const std::span<const std::uint32_t> triangles = mesh.triangles, corners = mesh.corners;
  const auto triangle_count = static_cast<std::uint32_t>(mesh.size());
  const auto corner_count = static_cast<std::uint32_t>(mesh.corner_count());
  std::uint32_t thin = 0;
  for (std::size_t k = 0; k < packet_size; ++k) {
    const std::size_t place = std::min(first + k, end - 1);
    const std::uint64_t three = long_word(triangles, listed_triangle(list, place, triangle_count));
    thin |= static_cast<std::uint32_t>(three >> 63U) << k;
    for (unsigned corner = 0; corner < 3; ++corner) {
      const std::uint32_t at = unpack_third(three, corner);
      packet.corners[corner][k] = corners.data() + 2 * std::size_t{std::min(at, corner_count - 1)};
    }
  }
  packet.thin = thin;
}

using Words = hn::RebindToUnsigned<Lanes>;
/// Low and high halves of long words.
struct Halves {
  hn::Vec<Words> low, high;
};

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Halves halves_of(const std::uint32_t* const* at) {
  return {hn::Set(Words(), (*at)[0]), hn::Set(Words(), (*at)[1])};
}
#else
/// The long words at some places, in as many lanes. By halves, since a vector that is loaded right
/// after its parts were stored waits for them.
template <std::size_t count>
HWY_INLINE auto long_words(const std::uint32_t* const* at) {
  const hn::Simd<std::uint64_t, count, 0> lanes;
  if constexpr (count == 1) {
    std::uint64_t word = 0;
    std::memcpy(&word, *at, sizeof word);
    return hn::Set(lanes, word);
  } else {
    return hn::Combine(lanes, long_words<count / 2>(at + count / 2), long_words<count / 2>(at));
  }
}

HWY_INLINE Halves halves_of(const std::uint32_t* const* at) {
  const Words words;
  constexpr std::size_t half = hn::MaxLanes(Words()) / 2;
  const auto first = hn::BitCast(words, long_words<half>(at)),
             second = hn::BitCast(words, long_words<half>(at + half));
  return {hn::ConcatEven(words, second, first), hn::ConcatOdd(words, second, first)};
}
#endif

/// The corners of a packet from its k-th triangle on.
HWY_INLINE WholeVectors corners_from(const Packet& packet, std::size_t corner, std::size_t k) {
  const WholeLanes whole;
  const auto [low, high] = halves_of(packet.corners[corner].data() + k);
  const auto mask = hn::Set(Words(), corner_mask);
  constexpr int rest = 32 - static_cast<int>(corner_bits);
  const auto y =
      hn::Or(hn::ShiftRight<static_cast<int>(corner_bits)>(low), hn::ShiftLeft<rest>(high));
  return {hn::BitCast(whole, hn::And(low, mask)), hn::BitCast(whole, hn::And(y, mask)),
          hn::BitCast(whole,
                      hn::And(hn::ShiftRight<2 * static_cast<int>(corner_bits) - 32>(high), mask))};
}

/// Triangles in lanes, seen from their first corners, in lattice steps.
struct Sides {
  Vectors ab, ac, bc, ap, normal;
  Floats area;  ///< square of twice the area
};

HWY_INLINE Sides sides_from(const Packet& packet, const LatticePlace& place, std::size_t k) {
  const WholeLanes whole;
  const Lanes lanes;
  const WholeVectors a = corners_from(packet, 0, k), b = corners_from(packet, 1, k),
                     c = corners_from(packet, 2, k);
  const Vectors toward = between({hn::Set(whole, place.whole[0]), hn::Set(whole, place.whole[1]),
                                  hn::Set(whole, place.whole[2])},
                                 a);
  Sides sides;
  sides.ab = between(a, b);
  sides.ac = between(a, c);
  // Exact too: whole steps.
  sides.bc = {hn::Sub(sides.ac.x, sides.ab.x), hn::Sub(sides.ac.y, sides.ab.y),
              hn::Sub(sides.ac.z, sides.ab.z)};
  sides.ap = {hn::Sub(hn::Set(lanes, place.rest[0]), toward.x),
              hn::Sub(hn::Set(lanes, place.rest[1]), toward.y),
              hn::Sub(hn::Set(lanes, place.rest[2]), toward.z)};
  sides.normal = cross(sides.ab, sides.ac);
  sides.area = dot(sides.normal, sides.normal);
  return sides;
}

/// Products that both sides and faces are measured by.
struct Products {
  Floats ab_ab, ac_ac, bc_bc, ab_ac, ab_ap, ac_ap;
};

/// The parts of a triangle on which its closest point may lie; `none` where that is not told.
enum Part : std::int32_t { on_ab, on_ac, on_bc, on_face, none };

/// Closest points in lanes.
struct Closest {
  Floats square;  ///< of the distance, steps^2
  Vectors away;   ///< from there to the place
  Floats share;   ///< of the side's way, where it lies on a side
  hn::Vec<WholeLanes> part;

  template <class Mask>
  HWY_INLINE void take(const Mask& mask, const Closest& other) {
    square = hn::IfThenElse(mask, other.square, square);
    away = {hn::IfThenElse(mask, other.away.x, away.x), hn::IfThenElse(mask, other.away.y, away.y),
            hn::IfThenElse(mask, other.away.z, away.z)};
    share = hn::IfThenElse(mask, other.share, share);
    part = hn::IfThenElse(hn::RebindMask(WholeLanes(), mask), other.part, part);
  }
  HWY_INLINE void take_nearer(const Closest& other) { take(hn::Lt(other.square, square), other); }
};

/// On a side. `point` and `along` lead from its first end; `product` is their product, `length` the
/// square of the side's length.
HWY_INLINE Closest closest_beside(const Vectors& point, const Vectors& along, Floats product,
                                  Floats length, Part part) {
  const Lanes lanes;
  const Floats share =
      hn::Min(hn::Max(hn::Div(product, hn::Max(length, hn::Set(lanes, 1.0F))), hn::Zero(lanes)),
              hn::Set(lanes, 1.0F));
  const Vectors off{hn::Sub(point.x, hn::Mul(share, along.x)),
                    hn::Sub(point.y, hn::Mul(share, along.y)),
                    hn::Sub(point.z, hn::Mul(share, along.z))};
  return {dot(off, off), off, share, hn::Set(WholeLanes(), part)};
}

HWY_INLINE Products products_of(const Sides& s) {
  return {dot(s.ab, s.ab), dot(s.ac, s.ac), dot(s.bc, s.bc),
          dot(s.ab, s.ac), dot(s.ab, s.ap), dot(s.ac, s.ap)};
}

/// On the sides alone.
HWY_INLINE Closest closest_on_sides(const Sides& s, const Products& p) {
  const Vectors bp{hn::Sub(s.ap.x, s.ab.x), hn::Sub(s.ap.y, s.ab.y), hn::Sub(s.ap.z, s.ab.z)};
  Closest closest = closest_beside(s.ap, s.ab, p.ab_ap, p.ab_ab, on_ab);
  closest.take_nearer(closest_beside(s.ap, s.ac, p.ac_ap, p.ac_ac, on_ac));
  closest.take_nearer(closest_beside(bp, s.bc, dot(s.bc, bp), p.bc_bc, on_bc));
  return closest;
}

/// Takes the face where the place is over it.
HWY_INLINE void take_face(const Sides& s, const Products& p, Closest& closest) {
  const Lanes lanes;
  const Floats zero = hn::Zero(lanes);
  // Barycentric coordinates times `area`: over the face none is negative.
  const Floats c = hn::Sub(hn::Mul(p.ab_ab, p.ac_ap), hn::Mul(p.ab_ac, p.ab_ap));
  const Floats b = hn::Sub(hn::Mul(p.ac_ac, p.ab_ap), hn::Mul(p.ab_ac, p.ac_ap));
  const auto over = hn::And(hn::Ge(hn::Min(b, c), zero), hn::Le(hn::Add(b, c), s.area));
  const Floats height = dot(s.normal, s.ap);
  const Floats rise = hn::Div(height, hn::Max(s.area, hn::Set(lanes, 1.0F)));
  const Vectors away{hn::Mul(rise, s.normal.x), hn::Mul(rise, s.normal.y),
                     hn::Mul(rise, s.normal.z)};
  closest.take(hn::And(over, hn::Gt(s.area, zero)),
               {hn::Mul(rise, height), away, zero, hn::Set(WholeLanes(), on_face)});
}

/// Of the way from the closest point, what is along the normal; 0 where that tells no side.
HWY_INLINE Floats along_normal(const Sides& s, const Closest& closest) {
  const Lanes lanes;
  const Floats along = dot(s.normal, closest.away);
  const Floats least = hn::Set(lanes, static_cast<float>(least_along_square));
  const auto slanted =
      hn::Lt(hn::Mul(along, along), hn::Mul(hn::Mul(least, s.area), closest.square));
  return hn::IfThenZeroElse(slanted, along);
}

/// What the squares are at least, of triangles too thin for the above: over a face the nearest side
/// is at most half the triangle's height away. With room for the rounding of all of this.
HWY_INLINE Floats least_squares(const Sides& s, const Products& p, Floats beside) {
  const Lanes lanes;
  const Floats longest = hn::Max(hn::Max(p.ab_ab, p.ac_ac), hn::Max(p.bc_bc, hn::Set(lanes, 1.0F)));
  const Floats slack = hn::Add(hn::Div(s.area, longest), hn::Set(lanes, 1.0F));
  return hn::Sub(hn::Mul(beside, hn::Set(lanes, 0.999F)), slack);
}

/// Of thin triangles only those that may be nearer than `best` are looked at, in doubles.
HWY_INLINE void squares_of_thin(const IndexedTriangles& mesh, const TriangleList& list,
                                std::size_t first, std::size_t end, std::uint32_t thin,
                                const Vector3& point, float best, float* squares) {
  const double per_square = 1 / (mesh.step * mesh.step);
  const auto triangle_count = static_cast<std::uint32_t>(mesh.size());
  for (std::size_t k = 0; k < packet_size; ++k) {
    if ((thin >> k & 1U) == 0) continue;
    const float least = squares[k];
    squares[k] = std::numeric_limits<float>::infinity();
    if (!(least < best)) continue;
    const auto corners =
        corners_of(mesh, listed_triangle(list, std::min(first + k, end - 1), triangle_count));
    squares[k] = static_cast<float>(
        per_square *
        (closest_on_triangle(point, corners[0], corners[1], corners[2]) - point).squaredNorm());
    best = std::min(squares[k], best);
  }
}

/// The nearest triangles so far, one in each lane; of two that are as near the first in the list,
/// so that the number of lanes changes nothing.
struct NearestInLanes {
  Closest closest;
  Floats along;               ///< of the way from the closest point, along the triangle's normal
  hn::Vec<WholeLanes> place;  ///< in the list

  HWY_INLINE void meet(const Closest& other, Floats other_along, hn::Vec<WholeLanes> other_place) {
    const auto nearer = hn::Lt(other.square, closest.square);
    closest.take(nearer, other);
    along = hn::IfThenElse(nearer, other_along, along);
    place = hn::IfThenElse(hn::RebindMask(WholeLanes(), nearer), other_place, place);
  }
  [[nodiscard]] HWY_INLINE float least() const {
    return hn::GetLane(hn::MinOfLanes(Lanes(), closest.square));
  }
};

/// The feature of a triangle on which a closest point lies.
HWY_INLINE TriangleFeature feature_of(std::int32_t part, float share) {
  constexpr std::array<std::array<TriangleFeature, 3>, 3> on_sides{
      {{TriangleFeature::a, TriangleFeature::ab, TriangleFeature::b},
       {TriangleFeature::a, TriangleFeature::ca, TriangleFeature::c},
       {TriangleFeature::b, TriangleFeature::bc, TriangleFeature::c}}};
  if (part >= on_face) return TriangleFeature::face;
  const std::size_t where = (share > 0 ? 1U : 0U) + (share < 1 ? 0U : 1U);
  return on_sides[static_cast<std::size_t>(part)][where];
}

/// The nearest of all lanes; `first` is the place of the list at which they began.
HWY_INLINE NearestTriangle nearest_of(const NearestInLanes& lane, const TriangleList& list,
                                      std::size_t first, std::size_t end,
                                      std::uint32_t triangle_count) {
  const Lanes lanes;
  const WholeLanes whole;
  const Floats least = hn::MinOfLanes(lanes, lane.closest.square);
  const auto found = hn::RebindMask(whole, hn::Eq(lane.closest.square, least));
  const auto places =
      hn::IfThenElse(found, lane.place, hn::Set(whole, std::numeric_limits<std::int32_t>::max()));
  const auto place = static_cast<std::size_t>(hn::GetLane(hn::MinOfLanes(whole, places)));
  const std::size_t which = (place - first) % hn::Lanes(lanes);
  NearestTriangle nearest;
  nearest.square = hn::GetLane(least);
  nearest.triangle = listed_triangle(list, std::min(place, end - 1), triangle_count);
  const auto lane_of = [&](Floats values) {
    alignas(64) std::array<float, packet_size> stored;
    hn::Store(values, lanes, stored.data());
    return stored[which];
  };
  alignas(64) std::array<std::int32_t, packet_size> parts;
  hn::Store(lane.closest.part, whole, parts.data());
  nearest.has_closest = parts[which] != none;
  nearest.away = {lane_of(lane.closest.away.x), lane_of(lane.closest.away.y),
                  lane_of(lane.closest.away.z)};
  nearest.along = lane_of(lane.along);
  nearest.feature = feature_of(parts[which], lane_of(lane.closest.share));
  return nearest;
}

NearestTriangle find_nearest_triangle(const IndexedTriangles& mesh, const TriangleList& list,
                                      ListPart part, double reach, const Vector3& point) {
  const Lanes lanes;
  const WholeLanes whole;
  const Floats zero = hn::Zero(lanes);
  const bool sheets = part == ListPart::sheets;
  const std::size_t first = sheets ? list.solids : 0;
  const std::size_t end = first + (sheets ? list.sheets : list.solids);
  if (mesh.corner_count() == 0 || mesh.size() == 0 || end == first) return {};
  const LatticePlace place = lattice_place(mesh, point);
  NearestInLanes nearest{{hn::Set(lanes, std::numeric_limits<float>::infinity()),
                          {zero, zero, zero},
                          zero,
                          hn::Set(whole, none)},
                         zero,
                         hn::Zero(whole)};
  Packet packet;
  const double bound_unit = reach / 255 / mesh.step;
  for (std::size_t k = first; k < end; k += packet_size) {
    if (list.has_bounds()) {
      const std::size_t before = sheets ? packets_of(list.solids) : 0;
      const double bound = bound_unit * list.bound(before + (k - first) / packet_size);
      if (bound * bound > static_cast<double>(nearest.least())) break;
    }
    load_packet(mesh, list, k, end, packet);
    alignas(64) std::array<float, packet_size> squares;
    const auto places_from = [&](std::size_t lane) {
      return hn::Iota(whole, static_cast<std::int32_t>(k + lane));
    };
    for (std::size_t lane = 0; lane < packet_size; lane += hn::Lanes(lanes)) {
      const Sides sides = sides_from(packet, place, lane);
      const Products products = products_of(sides);
      Closest closest = closest_on_sides(sides, products);
      const Floats least = least_squares(sides, products, closest.square);
      take_face(sides, products, closest);
      if (HWY_LIKELY(packet.thin == 0)) {
        nearest.meet(closest, along_normal(sides, closest), places_from(lane));
        continue;
      }
      const auto bit = hn::And(hn::Set(whole, static_cast<std::int32_t>(packet.thin >> lane)),
                               hn::Shl(hn::Set(whole, 1), hn::Iota(whole, 0)));
      const auto thin = hn::RebindMask(lanes, hn::Ne(bit, hn::Zero(whole)));
      hn::Store(hn::IfThenElse(thin, least, closest.square), lanes, squares.data() + lane);
    }
    if (HWY_LIKELY(packet.thin == 0)) continue;
    squares_of_thin(mesh, list, k, end, packet.thin, point, nearest.least(), squares.data());
    for (std::size_t lane = 0; lane < packet_size; lane += hn::Lanes(lanes)) {
      nearest.meet(
          {hn::Load(lanes, squares.data() + lane), {zero, zero, zero}, zero, hn::Set(whole, none)},
          zero, places_from(lane));
    }
  }
  return nearest_of(nearest, list, first, end, static_cast<std::uint32_t>(mesh.size()));
}

}  // namespace spm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm {

HWY_EXPORT(find_nearest_triangle);

NearestTriangle nearest_triangle(const IndexedTriangles& mesh, const TriangleList& list,
                                 ListPart part, double reach, const Vector3& point) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_nearest_triangle)(mesh, list, part, reach, point);
}

}  // namespace spm
#endif
