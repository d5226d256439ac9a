// SPDX-License-Identifier: Apache-2.0
#include "common/field/nearest_triangle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

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

/// The triangles of a packet.
struct Packet {
  alignas(64) std::array<std::array<std::uint64_t, packet_size>, 3> corners;
  std::array<std::uint32_t, packet_size> numbers;
  std::uint32_t thin = 0;  ///< a bit each
};

/// The numbers of a packet's triangles from the `first` of the list on; the last of them again and
/// again where there are fewer before `end`.
HWY_INLINE void load_numbers(const TriangleList& list, std::size_t first, std::size_t end,
                             Packet& packet) {
  const auto* numbers = reinterpret_cast<const char*>(list.words + 1);
  for (std::size_t k = 0; k < packet_size; ++k) {
    const std::size_t place = std::min(first + k, end - 1);
    std::uint32_t number = 0;
    if (list.wide) {
      std::memcpy(&number, numbers + 4 * place, 4);
    } else {
      std::memcpy(&number, numbers + 2 * place, 2);
    }
    packet.numbers[k] = list.words[0] + number;
  }
}

HWY_INLINE void load_packet(const IndexedTriangles& mesh, Packet& packet) {
  // By themselves, since the compiler cannot know that storing the packet leaves them as they are.
  const std::span<const std::uint32_t> triangles = mesh.triangles, corners = mesh.corners;
  const auto triangle_count = static_cast<std::uint32_t>(mesh.size());
  const auto corner_count = static_cast<std::uint32_t>(mesh.corner_count());
  std::array<std::uint64_t, packet_size> threes;
  std::uint32_t thin = 0;
  for (std::size_t k = 0; k < packet_size; ++k) {
    const std::uint32_t number = packet.numbers[k] < triangle_count ? packet.numbers[k] : 0;
    packet.numbers[k] = number;
    threes[k] = long_word(triangles, number);
    thin |= static_cast<std::uint32_t>(threes[k] >> 63U) << k;
  }
  packet.thin = thin;
  for (unsigned corner = 0; corner < 3; ++corner) {
    for (std::size_t k = 0; k < packet_size; ++k) {
      const std::uint32_t at = unpack_third(threes[k], corner);
      packet.corners[corner][k] = long_word(corners, std::min(at, corner_count - 1));
    }
  }
}

/// The corners of a packet from its k-th triangle on.
HWY_INLINE WholeVectors corners_from(const Packet& packet, std::size_t corner, std::size_t k) {
  const hn::RebindToUnsigned<Lanes> words;
  const WholeLanes whole;
  hn::Vec<decltype(words)> low, high;
  hn::LoadInterleaved2(
      words, reinterpret_cast<const std::uint32_t*>(packet.corners[corner].data() + k), low, high);
  const auto mask = hn::Set(words, corner_mask);
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
  sides.bc = between(b, c);
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

/// Square of the distance from a side. `point` and `along` lead from its first end; `product` is
/// their product, `length` the square of the side's length.
HWY_INLINE Floats square_beside(const Vectors& point, const Vectors& along, Floats product,
                                Floats length) {
  const Lanes lanes;
  const Floats share =
      hn::Min(hn::Max(hn::Div(product, hn::Max(length, hn::Set(lanes, 1.0F))), hn::Zero(lanes)),
              hn::Set(lanes, 1.0F));
  const Vectors off{hn::Sub(point.x, hn::Mul(share, along.x)),
                    hn::Sub(point.y, hn::Mul(share, along.y)),
                    hn::Sub(point.z, hn::Mul(share, along.z))};
  return dot(off, off);
}

HWY_INLINE Products products_of(const Sides& s) {
  return {dot(s.ab, s.ab), dot(s.ac, s.ac), dot(s.bc, s.bc),
          dot(s.ab, s.ac), dot(s.ab, s.ap), dot(s.ac, s.ap)};
}

/// Squares of the distances to the sides alone.
HWY_INLINE Floats to_sides(const Sides& s, const Products& p) {
  const Vectors bp{hn::Sub(s.ap.x, s.ab.x), hn::Sub(s.ap.y, s.ab.y), hn::Sub(s.ap.z, s.ab.z)};
  return hn::Min(hn::Min(square_beside(s.ap, s.ab, p.ab_ap, p.ab_ab),
                         square_beside(s.ap, s.ac, p.ac_ap, p.ac_ac)),
                 square_beside(bp, s.bc, dot(s.bc, bp), p.bc_bc));
}

/// Squares of the distances to the triangles.
HWY_INLINE Floats to_triangles(const Sides& s, const Products& p, Floats beside) {
  const Lanes lanes;
  const Floats zero = hn::Zero(lanes);
  // Barycentric coordinates times `area`: over the face none is negative.
  const Floats c = hn::Sub(hn::Mul(p.ab_ab, p.ac_ap), hn::Mul(p.ab_ac, p.ab_ap));
  const Floats b = hn::Sub(hn::Mul(p.ac_ac, p.ab_ap), hn::Mul(p.ab_ac, p.ac_ap));
  const auto over = hn::And(hn::Ge(hn::Min(b, c), zero), hn::Le(hn::Add(b, c), s.area));
  const Floats height = dot(s.normal, s.ap);
  const Floats face = hn::Div(hn::Mul(height, height), hn::Max(s.area, hn::Set(lanes, 1.0F)));
  return hn::IfThenElse(hn::And(over, hn::Gt(s.area, zero)), face, beside);
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
HWY_INLINE void squares_of_thin(const IndexedTriangles& mesh, const Packet& packet,
                                const Vector3& point, float best, float* squares) {
  for (std::size_t k = 0; k < packet_size; ++k) {
    if ((packet.thin >> k & 1U) == 0) continue;
    const float least = squares[k];
    squares[k] = std::numeric_limits<float>::infinity();
    if (!(least < best)) continue;
    const auto corners = corners_of(mesh, packet.numbers[k]);
    squares[k] = static_cast<float>(
        (closest_on_triangle(point, corners[0], corners[1], corners[2]) - point).squaredNorm());
    best = std::min(squares[k], best);
  }
}

/// The nearest triangles so far, one in each lane; of two that are as near the lower number, so
/// that the number of lanes changes nothing.
struct NearestInLanes {
  Floats square;  ///< m^2
  hn::Vec<WholeLanes> number;

  HWY_INLINE void meet(Floats squares, hn::Vec<WholeLanes> numbers) {
    const Lanes lanes;
    const auto lower =
        hn::And(hn::Eq(squares, square), hn::RebindMask(lanes, hn::Lt(numbers, number)));
    const auto nearer = hn::Or(hn::Lt(squares, square), lower);
    number = hn::IfThenElse(hn::RebindMask(WholeLanes(), nearer), numbers, number);
    square = hn::Min(squares, square);
  }
  [[nodiscard]] HWY_INLINE float least() const {
    return hn::GetLane(hn::MinOfLanes(Lanes(), square));
  }
  [[nodiscard]] HWY_INLINE NearestTriangle nearest() const {
    const Lanes lanes;
    const WholeLanes whole;
    const Floats least = hn::MinOfLanes(lanes, square);
    const auto found = hn::RebindMask(whole, hn::Eq(square, least));
    const auto numbers =
        hn::IfThenElse(found, number, hn::Set(whole, std::numeric_limits<std::int32_t>::max()));
    return {.triangle = static_cast<std::uint32_t>(hn::GetLane(hn::MinOfLanes(whole, numbers))),
            .square = hn::GetLane(least)};
  }
};

/// Looks at the triangles of a packet.
HWY_INLINE void meet_packet(const IndexedTriangles& mesh, const Packet& packet,
                            const LatticePlace& place, const Vector3& point,
                            NearestInLanes& nearest) {
  const Lanes lanes;
  const WholeLanes whole;
  const Floats unit = hn::Set(lanes, static_cast<float>(mesh.step * mesh.step));
  const auto numbers_from = [&](std::size_t k) {
    return hn::LoadU(whole, reinterpret_cast<const std::int32_t*>(packet.numbers.data()) + k);
  };
  alignas(64) std::array<float, packet_size> squares;
  for (std::size_t k = 0; k < packet_size; k += hn::Lanes(lanes)) {
    const Sides sides = sides_from(packet, place, k);
    const Products products = products_of(sides);
    const Floats beside = to_sides(sides, products);
    Floats found = to_triangles(sides, products, beside);
    if (HWY_UNLIKELY(packet.thin != 0)) {
      const auto bit = hn::And(hn::Set(whole, static_cast<std::int32_t>(packet.thin >> k)),
                               hn::Shl(hn::Set(whole, 1), hn::Iota(whole, 0)));
      const auto thin = hn::RebindMask(lanes, hn::Ne(bit, hn::Zero(whole)));
      found = hn::IfThenElse(thin, least_squares(sides, products, beside), found);
      hn::Store(hn::Mul(found, unit), lanes, squares.data() + k);
    } else {
      nearest.meet(hn::Mul(found, unit), numbers_from(k));
    }
  }
  if (HWY_LIKELY(packet.thin == 0)) return;
  squares_of_thin(mesh, packet, point, nearest.least(), squares.data());
  for (std::size_t k = 0; k < packet_size; k += hn::Lanes(lanes)) {
    nearest.meet(hn::Load(lanes, squares.data() + k), numbers_from(k));
  }
}

NearestTriangle find_nearest_triangle(const IndexedTriangles& mesh, const TriangleList& list,
                                      ListPart part, double reach, const Vector3& point) {
  const bool caps = part == ListPart::caps;
  const std::size_t first = caps ? list.surface : 0;
  const std::size_t end = first + (caps ? list.caps : list.surface);
  if (mesh.corner_count() == 0 || mesh.size() == 0 || end == first) return {};
  const LatticePlace place = lattice_place(mesh, point);
  NearestInLanes nearest{hn::Set(Lanes(), std::numeric_limits<float>::infinity()),
                         hn::Zero(WholeLanes())};
  Packet packet;
  const double bound_unit = reach / 255;
  for (std::size_t k = first; k < end; k += packet_size) {
    if (list.has_bounds()) {
      const std::size_t before = caps ? packets_of(list.surface) : 0;
      const double bound = bound_unit * list.bound(before + (k - first) / packet_size);
      if (bound * bound > static_cast<double>(nearest.least())) break;
    }
    load_numbers(list, k, end, packet);
    load_packet(mesh, packet);
    meet_packet(mesh, packet, place, point, nearest);
  }
  return nearest.nearest();
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
