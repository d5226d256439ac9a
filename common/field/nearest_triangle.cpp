// SPDX-License-Identifier: Apache-2.0
#include "common/field/nearest_triangle.hpp"

#include <array>
#include <cmath>
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
using Lanes = hn::CappedTag<float, cluster_size>;
using Floats = hn::Vec<Lanes>;

/// A vector in each lane.
struct Vectors {
  Floats x, y, z;
};

HWY_INLINE Vectors minus(const Vectors& a, const Vectors& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Floats dot(const Vectors& a, const Vectors& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

/// Square of the distance of a point from a segment from 0 along `along`; of a corner where that
/// has no length.
HWY_INLINE Floats segment_square(const Vectors& point, const Vectors& along) {
  const Lanes lanes;
  const Floats length = hn::Max(dot(along, along), hn::Set(lanes, 1e-30F));
  const Floats share =
      hn::Min(hn::Max(hn::Div(dot(point, along), length), hn::Zero(lanes)), hn::Set(lanes, 1.0F));
  const Vectors off{hn::Sub(point.x, hn::Mul(share, along.x)),
                    hn::Sub(point.y, hn::Mul(share, along.y)),
                    hn::Sub(point.z, hn::Mul(share, along.z))};
  return dot(off, off);
}

/// A corner's coordinates from the box, in shifted lattice steps, from the k-th triangle on.
HWY_INLINE Vectors load_corner(const std::uint32_t* cluster, std::size_t corner, std::size_t k) {
  const hn::Rebind<std::uint16_t, Lanes> narrow;
  const hn::RebindToSigned<Lanes> whole;
  const auto* numbers = reinterpret_cast<const std::uint16_t*>(cluster + cluster_head) +
                        3 * corner * cluster_size + k;
  const auto axis = [&](std::size_t which) {
    return hn::ConvertTo(Lanes(),
                         hn::PromoteTo(whole, hn::LoadU(narrow, numbers + which * cluster_size)));
  };
  return {axis(0), axis(1), axis(2)};
}

/// A point from the cluster's box, in shifted lattice steps; the same in all lanes.
HWY_INLINE Vectors local_point(const TriangleClusters& clusters, const std::uint32_t* cluster,
                               const Vector3& point) {
  const double per_step =
      1 / (clusters.step * static_cast<double>(std::uint64_t{1} << shift_of(cluster)));
  const Vector3 local = (point - base_of(clusters, cluster)) * per_step;
  const Lanes lanes;
  return {hn::Set(lanes, static_cast<float>(local[0])),
          hn::Set(lanes, static_cast<float>(local[1])),
          hn::Set(lanes, static_cast<float>(local[2]))};
}

/// Triangles of a cluster in lanes, seen from their first corners.
struct Sides {
  Vectors ab, ac, bc, ap, bp, normal;
  Floats area;  ///< square of twice the area
};

HWY_INLINE Sides sides_from(const std::uint32_t* cluster, const Vectors& point, std::size_t k) {
  Sides sides;
  const Vectors a = load_corner(cluster, 0, k);
  sides.ab = minus(load_corner(cluster, 1, k), a);
  sides.ac = minus(load_corner(cluster, 2, k), a);
  sides.bc = minus(sides.ac, sides.ab);
  sides.ap = minus(point, a);
  sides.bp = minus(sides.ap, sides.ab);
  sides.normal = cross(sides.ab, sides.ac);
  sides.area = dot(sides.normal, sides.normal);
  return sides;
}

/// Squares of the distances to the sides alone, in shifted lattice steps.
HWY_INLINE Floats to_sides(const Sides& s) {
  return hn::Min(hn::Min(segment_square(s.ap, s.ab), segment_square(s.ap, s.ac)),
                 segment_square(s.bp, s.bc));
}

/// Squares of the distances to the triangles, in shifted lattice steps.
HWY_INLINE Floats to_triangles(const Sides& s) {
  const Lanes lanes;
  const Floats zero = hn::Zero(lanes);
  // Over the face where the point is inwards of all three sides.
  const auto over = hn::And(hn::And(hn::Ge(dot(cross(s.normal, s.ab), s.ap), zero),
                                    hn::Ge(dot(cross(s.ac, s.normal), s.ap), zero)),
                            hn::Ge(dot(cross(s.normal, s.bc), s.bp), zero));
  const Floats height = dot(s.normal, s.ap);
  const Floats face = hn::Div(hn::Mul(height, height), hn::Max(s.area, hn::Set(lanes, 1e-30F)));
  return hn::IfThenElse(hn::And(over, hn::Gt(s.area, zero)), face, to_sides(s));
}

/// What the squares are at least, of triangles too thin for the above: over a face the nearest side
/// is at most half the triangle's height away. With room for the rounding of all of this.
HWY_INLINE Floats least_squares(const Sides& s) {
  const Lanes lanes;
  const Floats longest = hn::Max(hn::Max(dot(s.ab, s.ab), dot(s.ac, s.ac)),
                                 hn::Max(dot(s.bc, s.bc), hn::Set(lanes, 1.0F)));
  const Floats square = hn::Mul(to_sides(s), hn::Set(lanes, 0.999F));
  const Floats slack = hn::Add(hn::Div(s.area, longest), hn::Set(lanes, 1.0F));
  return hn::Sub(square, slack);
}

/// Of thin triangles only those that may be nearer than `best` are looked at, in doubles.
HWY_INLINE void squares_of_thin(const TriangleClusters& clusters, const std::uint32_t* cluster,
                                const Vector3& point, float best, float* squares) {
  for (std::size_t i = 0; i < cluster_size; ++i) {
    const float least = squares[i];
    squares[i] = std::numeric_limits<float>::infinity();
    if (!(least < best)) continue;
    const auto corners = corners_of(clusters, cluster, i);
    squares[i] = static_cast<float>(
        (closest_on_triangle(point, corners[0], corners[1], corners[2]) - point).squaredNorm());
    best = squares[i] < best ? squares[i] : best;
  }
}

/// Squares of the distances to the triangles of a cluster, m^2; those above `best` may be more.
HWY_INLINE void squares_of_cluster(const TriangleClusters& clusters, const std::uint32_t* cluster,
                                   const Vector3& point, float best, float* squares) {
  const double scale = clusters.step * static_cast<double>(std::uint64_t{1} << shift_of(cluster));
  const bool thin = is_exact(cluster);
  const Lanes lanes;
  const Vectors local = local_point(clusters, cluster, point);
  const Floats square = hn::Set(lanes, static_cast<float>(scale * scale));
  for (std::size_t k = 0; k < cluster_size; k += hn::Lanes(lanes)) {
    const Sides sides = sides_from(cluster, local, k);
    const Floats found = thin ? least_squares(sides) : to_triangles(sides);
    hn::StoreU(hn::Mul(found, square), lanes, squares + k);
  }
  if (thin) squares_of_thin(clusters, cluster, point, best, squares);
}

ListedTriangle find_nearest_triangle(const TriangleClusters& clusters,
                                     std::span<const std::uint32_t> list, double reach,
                                     const Vector3& point) {
  ListedTriangle nearest;
  nearest.square = std::numeric_limits<float>::infinity();
  const Lanes lanes;
  const double bound_unit = reach / 255;
  for (std::size_t entry = 0; entry < list.size(); ++entry) {
    const double bound = bound_unit * static_cast<double>(list[entry] >> 24U);
    if (bound * bound > static_cast<double>(nearest.square)) break;
    const std::uint32_t* cluster = clusters.at(list[entry] & 0xFFFFFFU);
    if (cluster == nullptr) continue;
    alignas(32) std::array<float, cluster_size> squares;
    squares_of_cluster(clusters, cluster, point, nearest.square, squares.data());
    for (std::size_t k = 0; k < cluster_size; k += hn::Lanes(lanes)) {
      const Floats found = hn::Load(lanes, squares.data() + k);
      const Floats best = hn::Set(lanes, nearest.square);
      if (hn::AllFalse(lanes, hn::Lt(found, best))) continue;
      const Floats least = hn::MinOfLanes(lanes, found);
      nearest.square = hn::GetLane(least);
      nearest.entry = entry;
      nearest.triangle =
          k + static_cast<std::size_t>(hn::FindFirstTrue(lanes, hn::Eq(found, least)));
    }
  }
  return nearest;
}

}  // namespace spm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm {

HWY_EXPORT(find_nearest_triangle);

ListedTriangle nearest_triangle(const TriangleClusters& clusters,
                                std::span<const std::uint32_t> list, double reach,
                                const Vector3& point) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_nearest_triangle)(clusters, list, reach, point);
}

}  // namespace spm
#endif
