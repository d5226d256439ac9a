// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/geometry/triangle_packets.hpp"

#include <limits>

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/geometry/triangle_packets.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace spm::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<float, packet_triangles>;
using Whole = hn::RebindToSigned<Lanes>;
using Floats = hn::Vec<Lanes>;

HWY_INLINE Floats row(const TriangleLanes::Row& from, std::size_t k) {
  return hn::Load(Lanes(), from.data() + k);
}

HWY_INLINE Floats dot(Floats ax, Floats ay, Floats az, Floats bx, Floats by, Floats bz) {
  return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, hn::Mul(az, bz)));
}

HWY_INLINE Floats unit_clamp(Floats value) {
  return hn::Min(hn::Max(value, hn::Zero(Lanes())), hn::Set(Lanes(), 1.0F));
}

/// Squares of what is left of a vector less a share of a side.
HWY_INLINE Floats rest(Floats x, Floats y, Floats z, Floats share, Floats sx, Floats sy,
                       Floats sz) {
  const Floats rx = hn::NegMulAdd(share, sx, x), ry = hn::NegMulAdd(share, sy, y),
               rz = hn::NegMulAdd(share, sz, z);
  return dot(rx, ry, rz, rx, ry, rz);
}

/// Squared distances from the triangles of a packet, from lane k on: the least from its sides, and
/// from its plane where the foot is in the triangle.
HWY_INLINE Floats squares_of(const TriangleLanes& packet, Floats px, Floats py, Floats pz,
                             std::size_t k) {
  const Floats ax = hn::Sub(px, row(packet.corner[0], k)),
               ay = hn::Sub(py, row(packet.corner[1], k)),
               az = hn::Sub(pz, row(packet.corner[2], k));
  const Floats sx = row(packet.side[0], k), sy = row(packet.side[1], k),
               sz = row(packet.side[2], k);
  const Floats ox = row(packet.other[0], k), oy = row(packet.other[1], k),
               oz = row(packet.other[2], k);
  const Floats on_side = dot(ax, ay, az, sx, sy, sz), on_other = dot(ax, ay, az, ox, oy, oz);
  const Floats first =
      rest(ax, ay, az, unit_clamp(hn::Mul(on_side, row(packet.per_side, k))), sx, sy, sz);
  const Floats second =
      rest(ax, ay, az, unit_clamp(hn::Mul(on_other, row(packet.per_other, k))), ox, oy, oz);
  const Floats bx = hn::Sub(ax, sx), by = hn::Sub(ay, sy), bz = hn::Sub(az, sz);
  const Floats tx = hn::Sub(ox, sx), ty = hn::Sub(oy, sy), tz = hn::Sub(oz, sz);
  const Floats on_third = dot(bx, by, bz, tx, ty, tz);
  const Floats third =
      rest(bx, by, bz, unit_clamp(hn::Mul(on_third, row(packet.per_third, k))), tx, ty, tz);
  const Floats mixed = row(packet.side_other, k);
  const Floats u = hn::MulAdd(on_side, row(packet.side_side, k), hn::Mul(on_other, mixed));
  const Floats v = hn::MulAdd(on_other, row(packet.other_other, k), hn::Mul(on_side, mixed));
  const Floats left = hn::Sub(hn::Set(Lanes(), 1.0F), hn::Add(u, v));
  const auto inside = hn::Ge(hn::Min(hn::Min(u, v), left), hn::Zero(Lanes()));
  const Floats plane = rest(hn::NegMulAdd(u, sx, ax), hn::NegMulAdd(u, sy, ay),
                            hn::NegMulAdd(u, sz, az), v, ox, oy, oz);
  const Floats sides = hn::Min(hn::Min(first, second), third);
  return hn::Min(sides, hn::IfThenElse(inside, plane, sides));
}

/// `packet_at(i)` gives the i-th of `count` packets.
template <class PacketAt>
HWY_INLINE std::uint32_t nearest_of(const PacketAt& packet_at, std::size_t count,
                                    const std::array<float, 3>& place) {
  const Lanes lanes;
  const Whole whole;
  const Floats px = hn::Set(lanes, place[0]), py = hn::Set(lanes, place[1]),
               pz = hn::Set(lanes, place[2]);
  Floats least = hn::Set(lanes, std::numeric_limits<float>::infinity());
  auto where = hn::Zero(whole), here = hn::Iota(whole, 0);
  const auto step = hn::Set(whole, static_cast<std::int32_t>(hn::Lanes(lanes)));
  for (std::size_t i = 0; i < count; ++i) {
    const TriangleLanes& packet = packet_at(i);
    for (std::size_t k = 0; k < packet_triangles; k += hn::Lanes(lanes)) {
      const Floats squares = squares_of(packet, px, py, pz, k);
      const auto nearer = hn::Lt(squares, least);
      least = hn::Min(squares, least);
      where = hn::IfThenElse(hn::RebindMask(whole, nearer), here, where);
      here = hn::Add(here, step);
    }
  }
  const auto nearest = hn::Eq(least, hn::MinOfLanes(lanes, least));
  const auto none = hn::Set(whole, std::numeric_limits<std::int32_t>::max());
  const auto first =
      hn::MinOfLanes(whole, hn::IfThenElse(hn::RebindMask(whole, nearest), where, none));
  const auto found = static_cast<std::size_t>(hn::GetLane(first));
  return packet_at(found / packet_triangles).id[found % packet_triangles];
}

std::uint32_t find_in_row(const TriangleLanes* packets, std::size_t count,
                          const std::array<float, 3>& place) {
  return nearest_of(
      [packets](std::size_t i) -> auto& { return packets[i]; }, count, place);
}

std::uint32_t find_named(const TriangleLanes* packets, std::span<const std::uint32_t> numbers,
                         const std::array<float, 3>& place) {
  return nearest_of(
      [ packets, numbers ](std::size_t i) -> auto& { return packets[numbers[i]]; }, numbers.size(),
      place);
}

}  // namespace spm::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm::bench {

HWY_EXPORT(find_in_row);
HWY_EXPORT(find_named);

TriangleLanes make_packet(const FloatMesh& mesh, std::span<const std::uint32_t> triangles) {
  TriangleLanes packet{};
  for (auto& axis : packet.corner) axis.fill(1e18F);
  for (std::size_t lane = 0; lane < triangles.size(); ++lane) {
    const std::array<Vector3, 3> corners = mesh.corners(triangles[lane]);
    const Vector3 side = corners[1] - corners[0], other = corners[2] - corners[0];
    const auto enter = [lane](std::array<TriangleLanes::Row, 3>& rows, const Vector3& vector) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        rows[axis][lane] = static_cast<float>(vector[static_cast<int>(axis)]);
      }
    };
    const auto per = [](double value) { return value > 0 ? static_cast<float>(1 / value) : 0.0F; };
    enter(packet.corner, corners[0]);
    enter(packet.side, side);
    enter(packet.other, other);
    packet.per_side[lane] = per(side.squaredNorm());
    packet.per_other[lane] = per(other.squaredNorm());
    packet.per_third[lane] = per((other - side).squaredNorm());
    // Where the triangle has no plane all are 0, and so the corner stands for it, and its sides.
    const double scale = per(side.cross(other).squaredNorm());
    packet.side_side[lane] = static_cast<float>(other.squaredNorm() * scale);
    packet.other_other[lane] = static_cast<float>(side.squaredNorm() * scale);
    packet.side_other[lane] = static_cast<float>(-side.dot(other) * scale);
    packet.id[lane] = triangles[lane];
  }
  return packet;
}

std::uint32_t nearest_in_packets(std::span<const TriangleLanes> packets,
                                 const std::array<float, 3>& place) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_in_row)(packets.data(), packets.size(), place);
}

std::uint32_t nearest_in_packets(const TriangleLanes* packets,
                                 std::span<const std::uint32_t> numbers,
                                 const std::array<float, 3>& place) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_named)(packets, numbers, place);
}

}  // namespace spm::bench
#endif
