// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/fan_angles.hpp"

#include <cmath>

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "baker/mesh/fan_angles.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace spm::baker::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Products and sums are not fused, so that every processor gives the same bits.
using Tag = hn::CappedTag<double, edge_lanes>;
using Doubles = hn::Vec<Tag>;

/// A vector in each lane.
struct Vectors {
  Doubles x, y, z;
};

HWY_INLINE Doubles dot(const Vectors& a, const Vectors& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Vectors set(const Vector3& v) {
  const Tag tag;
  return {hn::Set(tag, v.x()), hn::Set(tag, v.y()), hn::Set(tag, v.z())};
}
HWY_INLINE Vectors seen(const EdgeBlock::Coordinates& ends, std::size_t k, const Vectors& point) {
  const Tag tag;
  return {hn::Sub(hn::Load(tag, ends[0].data() + k), point.x),
          hn::Sub(hn::Load(tag, ends[1].data() + k), point.y),
          hn::Sub(hn::Load(tag, ends[2].data() + k), point.z)};
}

/// Complex numbers; x is the real part.
struct Complex {
  Doubles x, y;
};

/// Small enough to be multiplied with one more: no more than 45 degrees, and of middling size.
HWY_INLINE bool small(const Complex& number) {
  const Tag tag;
  const auto turned = hn::Le(hn::Abs(number.y), number.x);
  const auto sized =
      hn::And(hn::Gt(number.x, hn::Set(tag, 1e-50)), hn::Lt(number.x, hn::Set(tag, 1e50)));
  return hn::AllTrue(tag, hn::And(turned, sized));
}

/// Corners of triangles, seen from the point. Where a triangle is seen small, x is about four
/// lengths cubed, and `scale` times that about 1; in a corner it is 0.
struct Apexes {
  Vectors at;
  Doubles length, scale;

  HWY_INLINE explicit Apexes(const Vectors& seen_apex)
      : at(seen_apex), length(hn::Sqrt(dot(at, at))) {
    const Doubles cube = hn::Mul(length, hn::Mul(length, length));
    scale = hn::Div(hn::Set(Tag(), 0.25), hn::Max(cube, hn::Set(Tag(), 1e-300)));
  }
};

/// Half the solid angles of the triangles from the apexes to the edges are those of x + i y.
HWY_INLINE Complex half_angles(const Apexes& apex, const EdgeBlock& edges, std::size_t k,
                               const Vectors& point) {
  const Vectors b = seen(edges.from, k, point), c = seen(edges.to, k, point);
  const Doubles length_b = hn::Sqrt(dot(b, b)), length_c = hn::Sqrt(dot(c, c));
  const Doubles x =
      hn::Add(hn::Add(hn::Mul(hn::Mul(apex.length, length_b), length_c),
                      hn::Mul(dot(apex.at, b), length_c)),
              hn::Add(hn::Mul(dot(b, c), apex.length), hn::Mul(dot(c, apex.at), length_b)));
  return {hn::Mul(x, apex.scale), hn::Mul(dot(apex.at, cross(b, c)), apex.scale)};
}

/// Multiplies angles into a product, all lanes before any decision, so that the number of lanes of
/// the processor changes nothing. Returns what was added to the sum instead.
template <class AnglesFrom>
HWY_INLINE double multiply(AngleSum::Lanes& product, const AnglesFrom& angles_from) {
  const Tag tag;
  AngleSum::Lanes angles, both;
  bool small_angles = true, small_both = true;
  for (std::size_t k = 0; k < edge_lanes; k += hn::Lanes(tag)) {
    const Complex angle = angles_from(k);
    const Doubles x = hn::Load(tag, product.x.data() + k), y = hn::Load(tag, product.y.data() + k);
    const Complex turned{hn::Sub(hn::Mul(x, angle.x), hn::Mul(y, angle.y)),
                         hn::Add(hn::Mul(x, angle.y), hn::Mul(y, angle.x))};
    hn::Store(angle.x, tag, angles.x.data() + k);
    hn::Store(angle.y, tag, angles.y.data() + k);
    hn::Store(turned.x, tag, both.x.data() + k);
    hn::Store(turned.y, tag, both.y.data() + k);
    small_angles = small_angles && small(angle);
    small_both = small_both && small(turned);
  }
  if (!small_angles) return angles.angle();
  if (!small_both) {
    product = {};
    return both.angle();
  }
  product = both;
  return 0;
}

double add_fan(std::span<const EdgeBlock> edges, const Vector3& apex, const Vector3& point,
               AngleSum::Lanes& product) {
  const Vectors from = set(point);
  const Apexes apexes(set(apex - point));
  double sum = 0;
  for (const EdgeBlock& block : edges) {
    sum += multiply(product,
                    [&](std::size_t k) HWY_ATTR { return half_angles(apexes, block, k, from); });
  }
  return sum;
}

double add_triangles(std::span<const TriangleBlock> triangles, const Vector3& point,
                     AngleSum::Lanes& product) {
  const Vectors from = set(point);
  double sum = 0;
  for (const TriangleBlock& block : triangles) {
    sum += multiply(product, [&](std::size_t k) HWY_ATTR {
      return half_angles(Apexes(seen(block.apex, k, from)), block.base, k, from);
    });
  }
  return sum;
}

}  // namespace spm::baker::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm::baker {

HWY_EXPORT(add_fan);
HWY_EXPORT(add_triangles);

namespace {

/// Writes a place into a lane.
void put(const Vector3& place, std::size_t lane, EdgeBlock::Coordinates& coordinates) {
  for (int axis = 0; axis < 3; ++axis) {
    coordinates[static_cast<std::size_t>(axis)][lane] = place[axis];
  }
}

}  // namespace

double AngleSum::Lanes::angle() const {
  double sum = 0;
  for (std::size_t k = 0; k < edge_lanes; ++k) {
    if (y[k] != 0 || x[k] < 0) sum += std::atan2(y[k], x[k]);
  }
  return sum;
}

double AngleSum::total() const { return sum_ + product_.angle(); }

void AngleSum::add_fan(std::span<const EdgeBlock> edges, const Vector3& apex,
                       const Vector3& point) {
  sum_ += HWY_DYNAMIC_DISPATCH(add_fan)(edges, apex, point, product_);
}

void AngleSum::add_triangles(std::span<const TriangleBlock> triangles, const Vector3& point) {
  sum_ += HWY_DYNAMIC_DISPATCH(add_triangles)(triangles, point, product_);
}

std::vector<EdgeBlock> edge_blocks(std::span<const DirectedEdge> edges) {
  std::vector<EdgeBlock> blocks((edges.size() + edge_lanes - 1) / edge_lanes);
  for (std::size_t i = 0; i < edge_lanes * blocks.size(); ++i) {
    const bool is_edge = i < edges.size();
    const DirectedEdge& edge = is_edge ? edges[i] : edges.back();
    EdgeBlock& block = blocks[i / edge_lanes];
    put(edge[0], i % edge_lanes, block.from);
    put(edge[is_edge ? 1 : 0], i % edge_lanes, block.to);
  }
  return blocks;
}

std::vector<TriangleBlock> triangle_blocks(std::span<const std::array<Vector3, 3>> triangles) {
  std::vector<TriangleBlock> blocks((triangles.size() + edge_lanes - 1) / edge_lanes);
  for (std::size_t i = 0; i < edge_lanes * blocks.size(); ++i) {
    const bool is_triangle = i < triangles.size();
    const std::array<Vector3, 3>& corners = is_triangle ? triangles[i] : triangles.back();
    TriangleBlock& block = blocks[i / edge_lanes];
    put(corners[0], i % edge_lanes, block.apex);
    put(corners[1], i % edge_lanes, block.base.from);
    put(corners[is_triangle ? 2 : 1], i % edge_lanes, block.base.to);
  }
  return blocks;
}

}  // namespace spm::baker
#endif
