// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/fan_angles.hpp"

#include <cmath>

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "baker/verify/fan_angles.cpp"
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

/// Triangles from an apex to edges; all are seen from the point.
struct Fan {
  Vectors point, apex;
  Doubles length, scale;

  HWY_INLINE Fan(const Vector3& seen_apex, const Vector3& from)
      : point(set(from)), apex(set(seen_apex)), length(hn::Set(Tag(), seen_apex.norm())) {
    // Of a triangle that is seen small, x is about four lengths cubed.
    scale = hn::Div(hn::Set(Tag(), 0.25), hn::Mul(length, hn::Mul(length, length)));
  }
  /// Half the solid angle is that of x + i y.
  HWY_INLINE Complex half_angles(const EdgeBlock& edges, std::size_t k) const {
    const Vectors b = seen(edges.from, k, point), c = seen(edges.to, k, point);
    const Doubles length_b = hn::Sqrt(dot(b, b)), length_c = hn::Sqrt(dot(c, c));
    const Doubles x = hn::Add(
        hn::Add(hn::Mul(hn::Mul(length, length_b), length_c), hn::Mul(dot(apex, b), length_c)),
        hn::Add(hn::Mul(dot(b, c), length), hn::Mul(dot(c, apex), length_b)));
    return {hn::Mul(x, scale), hn::Mul(dot(apex, cross(b, c)), scale)};
  }
};

double add_fan(std::span<const EdgeBlock> edges, const Vector3& apex, const Vector3& point,
               AngleSum::Lanes& product) {
  const Tag tag;
  const Fan fan(apex - point, point);
  double sum = 0;
  for (const EdgeBlock& block : edges) {
    // All lanes before any decision, so that the number of lanes of the processor changes nothing.
    AngleSum::Lanes angles, both;
    bool small_angles = true, small_both = true;
    for (std::size_t k = 0; k < edge_lanes; k += hn::Lanes(tag)) {
      const Complex angle = fan.half_angles(block, k);
      const Doubles x = hn::Load(tag, product.x.data() + k),
                    y = hn::Load(tag, product.y.data() + k);
      const Complex turned{hn::Sub(hn::Mul(x, angle.x), hn::Mul(y, angle.y)),
                           hn::Add(hn::Mul(x, angle.y), hn::Mul(y, angle.x))};
      hn::Store(angle.x, tag, angles.x.data() + k);
      hn::Store(angle.y, tag, angles.y.data() + k);
      hn::Store(turned.x, tag, both.x.data() + k);
      hn::Store(turned.y, tag, both.y.data() + k);
      small_angles = small_angles && small(angle);
      small_both = small_both && small(turned);
    }
    if (!small_angles) {
      sum += angles.angle();
    } else if (!small_both) {
      sum += both.angle();
      product = {};
    } else {
      product = both;
    }
  }
  return sum;
}

}  // namespace spm::baker::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm::baker {

HWY_EXPORT(add_fan);

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

std::vector<EdgeBlock> edge_blocks(std::span<const DirectedEdge> edges) {
  std::vector<EdgeBlock> blocks((edges.size() + edge_lanes - 1) / edge_lanes);
  for (std::size_t lane = 0; lane < edge_lanes * blocks.size(); ++lane) {
    const bool is_edge = lane < edges.size();
    const DirectedEdge& edge = is_edge ? edges[lane] : edges.back();
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      EdgeBlock& block = blocks[lane / edge_lanes];
      block.from[a][lane % edge_lanes] = edge[0][axis];
      block.to[a][lane % edge_lanes] = edge[is_edge ? 1 : 0][axis];
    }
  }
  return blocks;
}

}  // namespace spm::baker
#endif
