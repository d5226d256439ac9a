// SPDX-License-Identifier: Apache-2.0
// The closest points of a place on the primitives of packets, several at once. Highway compiles it
// once for each kind of processor: it may be included again, once a target.
#if defined(SPM_CLOSEST_ON_PRIMITIVES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SPM_CLOSEST_ON_PRIMITIVES_INL
#undef SPM_CLOSEST_ON_PRIMITIVES_INL
#else
#define SPM_CLOSEST_ON_PRIMITIVES_INL
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/asset/primitive_packets.hpp"

HWY_BEFORE_NAMESPACE();
namespace spm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Products and sums are not fused, so that every processor gives the same bits.
using Lanes = hn::CappedTag<float, packet_width>;

/// A packet, or where lanes are fewer some of its primitives, from the k-th.
template <class Kind>
struct One {
  using Tag = Lanes;
  using Packet = Kind;
  const Packet* packet;
  std::size_t k;

  template <class Part>
  [[nodiscard]] HWY_INLINE hn::Vec<Tag> load(Part part) const {
    return hn::Load(Tag(), part(*packet).data() + k);
  }
  template <class Part>
  [[nodiscard]] HWY_INLINE hn::Vec<Tag> set(Part part) const {
    return hn::Set(Tag(), part(*packet));
  }
};

template <class Tag>
HWY_INLINE hn::Vec<Tag> constant(Tag tag, float value) {
  return hn::Set(tag, value);
}

/// A vector in each lane. Copied part by part: as a block it goes through memory, and is waited
/// for.
template <class Tag>
struct Vectors {
  HWY_INLINE Vectors(hn::Vec<Tag> x_, hn::Vec<Tag> y_, hn::Vec<Tag> z_) : x(x_), y(y_), z(z_) {}
  // NOLINTNEXTLINE(modernize-use-equals-default): as said.
  HWY_INLINE Vectors(const Vectors& from) : x(from.x), y(from.y), z(from.z) {}
  HWY_INLINE Vectors& operator=(const Vectors& from) {
    x = from.x;
    y = from.y;
    z = from.z;
    return *this;
  }
  hn::Vec<Tag> x, y, z;
};

template <class Tag>
HWY_INLINE Vectors<Tag> minus(const Vectors<Tag>& a, const Vectors<Tag>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

template <class Tag>
HWY_INLINE Vectors<Tag> scaled(const Vectors<Tag>& a, hn::Vec<Tag> by) {
  return {hn::Mul(a.x, by), hn::Mul(a.y, by), hn::Mul(a.z, by)};
}

template <class Tag>
HWY_INLINE hn::Vec<Tag> dot(const Vectors<Tag>& a, const Vectors<Tag>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

template <class Tag>
HWY_INLINE Vectors<Tag> chosen(hn::Mask<Tag> which, const Vectors<Tag>& yes,
                               const Vectors<Tag>& no) {
  return {hn::IfThenElse(which, yes.x, no.x), hn::IfThenElse(which, yes.y, no.y),
          hn::IfThenElse(which, yes.z, no.z)};
}

template <class Tag>
HWY_INLINE Vectors<Tag> vectors(const std::array<float, 3>& from) {
  return {hn::Set(Tag(), from[0]), hn::Set(Tag(), from[1]), hn::Set(Tag(), from[2])};
}

/// What a place is from primitives, and the squares of how far; on cells in spacings.
template <class Tag>
struct PrimitiveClosestPoints {
  HWY_INLINE PrimitiveClosestPoints(const Vectors<Tag>& off_, hn::Vec<Tag> square_, hn::Vec<Tag> x_,
                                    hn::Vec<Tag> y_)
      : off(off_), square(square_), x(x_), y(y_) {}
  // NOLINTNEXTLINE(modernize-use-equals-default): as Vectors.
  HWY_INLINE PrimitiveClosestPoints(const PrimitiveClosestPoints& from)
      : off(from.off), square(from.square), x(from.x), y(from.y) {}
  HWY_INLINE PrimitiveClosestPoints& operator=(const PrimitiveClosestPoints& from) {
    off = from.off;
    square = from.square;
    x = from.x;
    y = from.y;
    return *this;
  }
  Vectors<Tag> off;
  hn::Vec<Tag> square;
  hn::Vec<Tag> x, y;  ///< of cells, as NearestPrimitive
};

/// Cells, and a place from their middles; spacings.
template <class Source>
struct Cells {
  using Tag = typename Source::Tag;
  using Floats = hn::Vec<Tag>;
  Vectors<Tag> from;
  Floats slope_x, slope_y, twist, per_x, per_y, level_x;

  HWY_INLINE Cells(const Source& source, const std::array<float, 3>& place)
      : from(from_middles(source, place)),
        slope_x(source.load([](const CellPacket& packet) -> auto& { return packet.slope_eta; })),
        slope_y(source.load([](const CellPacket& packet) -> auto& { return packet.slope_omega; })),
        twist(source.load([](const CellPacket& packet) -> auto& { return packet.twist; })),
        per_x(source.load([](const CellPacket& packet) -> auto& { return packet.per_eta; })),
        per_y(source.load([](const CellPacket& packet) -> auto& { return packet.per_omega; })),
        level_x(source.load([](const CellPacket& packet) -> auto& { return packet.level_eta; })) {}

  /// Closest points; on the patches, or where `twist_` is 0 on their mean planes.
  [[nodiscard]] HWY_INLINE PrimitiveClosestPoints<Tag> closest_points(Floats x, Floats y,
                                                                      Floats twist_) const {
    const Floats steep = hn::Add(slope_x, hn::Mul(twist_, y));
    const Vectors<Tag> off{hn::Sub(from.x, x), hn::Sub(from.y, y),
                           hn::Sub(hn::Sub(from.z, hn::Mul(slope_y, y)), hn::Mul(steep, x))};
    return {off, dot<Tag>(off, off), x, y};
  }

  /// The nearest on the mean planes, and if `on_patch` the patches over them, of whole cells. Where
  /// the free closest point is beyond two sides that meet it is near the nearest: closest_on_patch
  /// tries both ways.
  template <bool on_patch>
  [[nodiscard]] HWY_INLINE PrimitiveClosestPoints<Tag> nearest() const {
    const Tag tag;
    const Floats half = constant(tag, 0.5F), low = constant(tag, -0.5F);
    // What waits for the step before is short: the rest of each is worked out beside it.
    const Floats across = hn::Mul(slope_x, slope_y);
    const Floats steep_x = hn::Mul(slope_x, from.x), steep_y = hn::Mul(slope_y, from.y);
    const Floats above = hn::Sub(from.z, hn::Add(steep_x, steep_y));
    const Floats free_y = hn::Mul(hn::Add(from.y, hn::Mul(slope_y, from.z)), per_y);
    const Floats free_x = hn::Mul(hn::Add(from.x, hn::Mul(slope_x, from.z)), per_x);
    const auto clamp = [&](Floats value) { return hn::Min(hn::Max(value, low), half); };
    const Floats first = clamp(hn::Add(from.x, hn::Mul(above, level_x)));
    const Floats y = clamp(hn::Sub(free_y, hn::Mul(hn::Mul(across, per_y), first)));
    const Floats x = clamp(hn::Sub(free_x, hn::Mul(hn::Mul(across, per_x), y)));
    return closest_points(x, y, on_patch ? twist : hn::Zero(tag));
  }

 private:
  /// A place from the tree's origin, the same in all lanes, in the packet's frame from its origin.
  [[nodiscard]] static HWY_INLINE Vectors<Tag> in_frame(const Source& source,
                                                        const Vectors<Tag>& place) {
    const auto& steps = source.packet->steps;
    const auto& base = source.packet->base;
    const Tag tag;
    if constexpr (hn::MaxLanes(Tag()) >= 4) {
      // All three at once, and then each to all lanes.
      const auto by = [&](std::size_t axis) { return hn::LoadDup128(tag, steps[axis].data()); };
      const Floats at =
          hn::Sub(dot<Tag>({by(0), by(1), by(2)}, place), hn::LoadDup128(tag, base.data()));
      return {hn::Broadcast<0>(at), hn::Broadcast<1>(at), hn::Broadcast<2>(at)};
    } else {
      const auto along = [&](std::size_t own) {
        return hn::Sub(dot<Tag>({hn::Set(tag, steps[0][own]), hn::Set(tag, steps[1][own]),
                                 hn::Set(tag, steps[2][own])},
                                place),
                       hn::Set(tag, base[own]));
      };
      return {along(0), along(1), along(2)};
    }
  }
  /// In the frame of a packet of cells, spacings from its first sample, less the middles.
  [[nodiscard]] static HWY_INLINE Vectors<Tag> from_middles(const Source& source,
                                                            const std::array<float, 3>& place) {
    alignas(64) static constexpr PacketLanes middles_x{0.5F, 1.5F, 2.5F, 3.5F,
                                                       0.5F, 1.5F, 2.5F, 3.5F};
    alignas(64) static constexpr PacketLanes middles_y{0.5F, 0.5F, 0.5F, 0.5F,
                                                       1.5F, 1.5F, 1.5F, 1.5F};
    const Vectors<Tag> at = in_frame(source, vectors<Tag>(place));
    return {
        hn::Sub(at.x, source.load([](const CellPacket&) -> auto& { return middles_x; })),
        hn::Sub(at.y, source.load([](const CellPacket&) -> auto& { return middles_y; })),
        hn::Sub(at.z, source.load([](const CellPacket& packet) -> auto& { return packet.depth; }))};
  }
};

/// Moves closest points that clip lines leave out to the lines, as clip_closest_point does.
HWY_INLINE PrimitiveClosestPoints<Lanes> clipped_closest_points(
    const ClipPacket& clips, std::size_t k, const Cells<One<CellPacket>>& cells,
    const PrimitiveClosestPoints<Lanes>& whole) {
  const Lanes lanes;
  const auto part = [&](const PacketLanes& from) { return hn::Load(lanes, from.data() + k); };
  const auto kept = hn::Le(
      hn::Add(hn::Mul(part(clips.a), whole.x), hn::Mul(part(clips.b), whole.y)), part(clips.c));
  const auto x0 = part(clips.x), y0 = part(clips.y);
  const Vectors<Lanes> to{
      part(clips.to_x), part(clips.to_y),
      hn::Add(hn::Mul(cells.slope_x, part(clips.to_x)), hn::Mul(cells.slope_y, part(clips.to_y)))};
  const auto length = hn::Max(dot<Lanes>(to, to), hn::Set(lanes, 1e-30F));
  const auto along =
      hn::Div(dot<Lanes>(cells.closest_points(x0, y0, hn::Zero(lanes)).off, to), length);
  const auto share = hn::Min(hn::Max(along, hn::Zero(lanes)), hn::Set(lanes, 1.0F));
  const auto x = hn::Add(x0, hn::Mul(share, to.x)), y = hn::Add(y0, hn::Mul(share, to.y));
  const PrimitiveClosestPoints<Lanes> clipped = cells.closest_points(x, y, cells.twist);
  return {chosen<Lanes>(kept, whole.off, clipped.off),
          hn::IfThenElse(kept, whole.square, clipped.square), hn::IfThenElse(kept, whole.x, x),
          hn::IfThenElse(kept, whole.y, y)};
}

/// The closest points on whole cells, squares in m^2. `facing`: out of all reach are closest points
/// whose own normals meet the place not to within a cosine.
template <bool facing, class Source>
HWY_INLINE PrimitiveClosestPoints<typename Source::Tag> in_metres(
    const Source& source, const Cells<Source>& cells,
    PrimitiveClosestPoints<typename Source::Tag> closest_points, float cosine) {
  const typename Source::Tag tag;
  const auto square = closest_points.square;
  closest_points.square = hn::Mul(
      square, source.set([](const CellPacket& packet) { return packet.spacing * packet.spacing; }));
  if constexpr (facing) {
    const auto slope_x = hn::Add(cells.slope_x, hn::Mul(cells.twist, closest_points.y));
    const auto slope_y = hn::Add(cells.slope_y, hn::Mul(cells.twist, closest_points.x));
    const auto level =
        hn::Add(hn::Add(hn::Mul(slope_x, slope_x), hn::Mul(slope_y, slope_y)), constant(tag, 1.0F));
    const auto below =
        hn::Sub(hn::Sub(closest_points.off.z, hn::Mul(slope_x, closest_points.off.x)),
                hn::Mul(slope_y, closest_points.off.y));
    const auto meets = hn::Ge(hn::Mul(below, below),
                              hn::Mul(hn::Mul(square, level), constant(tag, cosine * cosine)));
    closest_points.square =
        hn::IfThenElse(meets, closest_points.square, constant(tag, empty_square));
  }
  return closest_points;
}

template <bool facing>
HWY_INLINE PrimitiveClosestPoints<Lanes> closest_on_cells(const PrimitivePackets& packets,
                                                          const CellPacket& packet,
                                                          const std::array<float, 3>& place,
                                                          float cosine, std::size_t k) {
  const One<CellPacket> source{&packet, k};
  const Cells<One<CellPacket>> cells(source, place);
  PrimitiveClosestPoints<Lanes> closest_points = cells.template nearest<true>();
  if (packet.clips != 0)
    closest_points =
        clipped_closest_points(packets.clips[packet.clips - 1], k, cells, closest_points);
  return in_metres<facing>(source, cells, closest_points, cosine);
}

/// Triangles, and a place from their first corners.
template <class Source>
struct Triangles {
  using Tag = typename Source::Tag;
  using Floats = hn::Vec<Tag>;
  Vectors<Tag> away, side, other, normal, along_side, along_other;
  Floats per_side, per_other, per_third, min_share;

  HWY_INLINE Triangles(const Source& source, const std::array<float, 3>& place)
      : away(minus<Tag>(vectors<Tag>(place),
                        load(
                            source, [](const TrianglePacket& g) -> auto& { return g.corner; }))),
        side(load(
            source, [](const TrianglePacket& g) -> auto& { return g.side; })),
        other(load(
            source, [](const TrianglePacket& g) -> auto& { return g.other; })),
        normal(load(
            source, [](const TrianglePacket& g) -> auto& { return g.normal; })),
        along_side(load(
            source, [](const TrianglePacket& g) -> auto& { return g.along_side; })),
        along_other(load(
            source, [](const TrianglePacket& g) -> auto& { return g.along_other; })),
        per_side(source.load([](const TrianglePacket& g) -> auto& { return g.per_side; })),
        per_other(source.load([](const TrianglePacket& g) -> auto& { return g.per_other; })),
        per_third(source.load([](const TrianglePacket& g) -> auto& { return g.per_third; })),
        min_share(source.load([](const TrianglePacket& g) -> auto& { return g.min_share; })) {}

  /// Where the closest point on the plane is in the triangle or close to it, the height above the
  /// plane: never more than the distance. Elsewhere, and where it is too thin to have a plane, the
  /// nearest of the sides. Close: by a share of its size.
  [[nodiscard]] HWY_INLINE PrimitiveClosestPoints<Tag> nearest(float rounding) const {
    const Tag tag;
    const Floats height = dot<Tag>(normal, away);
    const Floats u = dot<Tag>(along_side, away), v = dot<Tag>(along_other, away);
    const Floats left = hn::Sub(constant(tag, 1.0F), hn::Add(u, v));
    // Rounding must not take a closest point out of a triangle.
    const Floats least = hn::Sub(min_share, constant(tag, rounding));
    const auto is_flat = hn::Ge(hn::Min(hn::Min(u, v), left), least);
    const Vectors<Tag> level = scaled<Tag>(normal, height);
    const Vectors<Tag> first = on_segment(away, side, per_side);
    const Vectors<Tag> second = on_segment(away, other, per_other);
    const Vectors<Tag> third =
        on_segment(minus<Tag>(away, side), minus<Tag>(other, side), per_third);
    const Vectors<Tag> sides = nearer_of(nearer_of(first, second), third);
    const Vectors<Tag> off = chosen<Tag>(is_flat, level, sides);
    return {off, dot<Tag>(off, off), hn::Zero(tag), hn::Zero(tag)};
  }

 private:
  template <class Part>
  [[nodiscard]] static HWY_INLINE Vectors<Tag> load(const Source& source, Part part) {
    const auto axis = [&](std::size_t which) {
      return source.load([&](const TrianglePacket& packet) -> auto& {
        return part(packet)[which];
      });
    };
    return {axis(0), axis(1), axis(2)};
  }
  /// From the segment that begins at a corner, of which `off` is the place.
  [[nodiscard]] static HWY_INLINE Vectors<Tag> on_segment(const Vectors<Tag>& off,
                                                          const Vectors<Tag>& side,
                                                          Floats per_square) {
    const Tag tag;
    const Floats share = hn::Mul(dot<Tag>(off, side), per_square);
    return minus<Tag>(
        off, scaled<Tag>(side, hn::Min(hn::Max(share, hn::Zero(tag)), constant(tag, 1.0F))));
  }
  [[nodiscard]] static HWY_INLINE Vectors<Tag> nearer_of(const Vectors<Tag>& a,
                                                         const Vectors<Tag>& b) {
    return chosen<Tag>(hn::Le(dot<Tag>(a, a), dot<Tag>(b, b)), a, b);
  }
};

template <bool facing, class Source>
HWY_INLINE PrimitiveClosestPoints<typename Source::Tag> closest_on_triangles(
    const Source& source, const std::array<float, 3>& place, float cosine, float rounding) {
  using Tag = typename Source::Tag;
  const Tag tag;
  const Triangles<Source> triangles(source, place);
  PrimitiveClosestPoints<Tag> closest_points = triangles.nearest(rounding);
  if constexpr (facing) {
    const auto height = dot<Tag>(triangles.normal, closest_points.off);
    const auto has_normal = hn::Lt(triangles.min_share, constant(tag, no_share));
    const auto meets = hn::Ge(hn::Mul(height, height),
                              hn::Mul(closest_points.square, constant(tag, cosine * cosine)));
    closest_points.square = hn::IfThenElse(hn::And(has_normal, meets), closest_points.square,
                                           constant(tag, empty_square));
  }
  return closest_points;
}

template <bool facing>
HWY_INLINE PrimitiveClosestPoints<Lanes> closest_on_packet(const PrimitivePackets& packets,
                                                           std::uint32_t number,
                                                           const std::array<float, 3>& place,
                                                           float cosine, float rounding,
                                                           std::size_t k) {
  const Lanes lanes;
  const auto zero = hn::Zero(lanes);
  const std::size_t beyond = number - packets.cells.size();
  if (number < packets.cells.size()) {
    return closest_on_cells<facing>(packets, packets.cells[number], place, cosine, k);
  }
  if (beyond < packets.triangles.size()) {
    const One<TrianglePacket> source{&packets.triangles[beyond], k};
    return closest_on_triangles<facing>(source, place, cosine, rounding);
  }
  return {{zero, zero, zero}, hn::Set(lanes, empty_square), zero, zero};
}

/// How near to a triangle's border its plane counts: where the distance is meant, and where it must
/// not be more.
constexpr float exact_rounding = 1e-4F, safe_rounding = 0.01F;

}  // namespace spm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
