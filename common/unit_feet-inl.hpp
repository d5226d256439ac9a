// SPDX-License-Identifier: Apache-2.0
// The feet of a place on the units of groups, several at once. Highway compiles it once for each
// kind of processor: it may be included again, once a target.
#if defined(SPM_UNIT_FEET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SPM_UNIT_FEET_INL
#undef SPM_UNIT_FEET_INL
#else
#define SPM_UNIT_FEET_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "common/unit_groups.hpp"

HWY_BEFORE_NAMESPACE();
namespace spm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Products and sums are not fused, so that every processor gives the same bits.
using Lanes = hn::CappedTag<float, group_units>;

/// Square of the sine between a triangle's sides below which rounding tells its normal.
constexpr float thin_sine_squared = 1e-8F;

/// A group, or where lanes are fewer some of its units, from the k-th.
template <class Kind>
struct One {
  using Tag = Lanes;
  using Group = Kind;
  const Group* group;
  std::size_t k;

  template <class Part>
  [[nodiscard]] HWY_INLINE hn::Vec<Tag> load(Part part) const {
    return hn::Load(Tag(), part(*group).data() + k);
  }
  template <class Part>
  [[nodiscard]] HWY_INLINE hn::Vec<Tag> set(Part part) const {
    return hn::Set(Tag(), part(*group));
  }
};

template <class Tag>
HWY_INLINE hn::Vec<Tag> constant(Tag tag, float value) {
  return hn::Set(tag, value);
}

/// A vector in each lane.
template <class Tag>
struct Vectors {
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
HWY_INLINE Vectors<Tag> cross(const Vectors<Tag>& a, const Vectors<Tag>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
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

/// What a place is from units, and the squares of how far; on cells, from their middles, spacings.
template <class Tag>
struct UnitFeet {
  Vectors<Tag> off;
  hn::Vec<Tag> square;
  hn::Vec<Tag> x, y;  ///< the feet, of cells
};

template <class Tag>
HWY_INLINE UnitFeet<Tag> nearer_of(const UnitFeet<Tag>& a, const UnitFeet<Tag>& b) {
  const auto first = hn::Le(a.square, b.square);
  return {chosen<Tag>(first, a.off, b.off), hn::Min(a.square, b.square),
          hn::IfThenElse(first, a.x, b.x), hn::IfThenElse(first, a.y, b.y)};
}

/// Cells, and a place from their middles; spacings.
template <class Source>
struct Cells {
  using Tag = typename Source::Tag;
  using Floats = hn::Vec<Tag>;
  Vectors<Tag> from;
  Floats slope_x, slope_y, twist;

  HWY_INLINE Cells(const Source& source, const std::array<float, 3>& place)
      : from(from_middles(source, place)),
        slope_x(source.load([](const CellGroup& group) -> auto& { return group.slope_eta; })),
        slope_y(source.load([](const CellGroup& group) -> auto& { return group.slope_omega; })),
        twist(source.load([](const CellGroup& group) -> auto& { return group.twist; })) {}

  /// Feet, which are `twisted` above their planes.
  [[nodiscard]] HWY_INLINE UnitFeet<Tag> feet(Floats x, Floats y, Floats twisted) const {
    const Vectors<Tag> off{
        hn::Sub(from.x, x), hn::Sub(from.y, y),
        hn::Sub(hn::Sub(hn::Sub(from.z, hn::Mul(slope_x, x)), hn::Mul(slope_y, y)), twisted)};
    return {off, dot<Tag>(off, off), x, y};
  }
  [[nodiscard]] HWY_INLINE Floats twisted(Floats x, Floats y) const {
    return hn::Mul(hn::Mul(twist, x), y);
  }

  /// The nearest on the mean planes, and if `on_patch` the patches over them, of whole cells. Where
  /// the free foot is beyond two sides that meet it is near the nearest: closest_on_patch tries
  /// both ways.
  template <bool on_patch>
  [[nodiscard]] HWY_INLINE UnitFeet<Tag> nearest() const {
    const Tag tag;
    const Floats half = constant(tag, 0.5F), low = constant(tag, -0.5F), one = constant(tag, 1.0F);
    // Divisions first, which hang on the group alone: nothing waits for them.
    const Floats level_x = hn::Add(hn::Mul(slope_x, slope_x), one);
    const Floats square_y = hn::Mul(slope_y, slope_y);
    const Floats per_level = hn::Div(one, hn::Add(level_x, square_y));
    const Floats per_y = hn::Div(one, hn::Add(square_y, one)), per_x = hn::Div(one, level_x);
    const Floats above = hn::Sub(from.z, hn::Mul(slope_x, from.x));
    const Floats along = hn::Mul(hn::Sub(above, hn::Mul(slope_y, from.y)), per_level);
    const auto clamp = [&](Floats value) { return hn::Min(hn::Max(value, low), half); };
    const Floats first = clamp(hn::Add(from.x, hn::Mul(along, slope_x)));
    const Floats y = clamp(hn::Mul(
        hn::Add(from.y, hn::Mul(slope_y, hn::Sub(from.z, hn::Mul(slope_x, first)))), per_y));
    const Floats x = clamp(
        hn::Mul(hn::Add(from.x, hn::Mul(slope_x, hn::Sub(from.z, hn::Mul(slope_y, y)))), per_x));
    return feet(x, y, on_patch ? twisted(x, y) : hn::Zero(tag));
  }

 private:
  /// A place in the frame of a group of cells, spacings from its first sample.
  [[nodiscard]] static HWY_INLINE float along(const CellGroup& group,
                                              const std::array<float, 3>& place, std::size_t axis) {
    const float x = place[0] - group.origin[0], y = place[1] - group.origin[1],
                z = place[2] - group.origin[2];
    return group.axes[axis][0] * x + group.axes[axis][1] * y + group.axes[axis][2] * z;
  }
  [[nodiscard]] static HWY_INLINE Vectors<Tag> from_middles(const Source& source,
                                                            const std::array<float, 3>& place) {
    alignas(64) static constexpr GroupLanes middles_x{0.5F, 1.5F, 2.5F, 3.5F,
                                                      0.5F, 1.5F, 2.5F, 3.5F};
    alignas(64) static constexpr GroupLanes middles_y{0.5F, 0.5F, 0.5F, 0.5F,
                                                      1.5F, 1.5F, 1.5F, 1.5F};
    const auto at = [&](std::size_t axis) {
      return source.set([&](const CellGroup& group) { return along(group, place, axis); });
    };
    return {
        hn::Sub(at(0), source.load([](const CellGroup&) -> auto& { return middles_x; })),
        hn::Sub(at(1), source.load([](const CellGroup&) -> auto& { return middles_y; })),
        hn::Sub(at(2), source.load([](const CellGroup& group) -> auto& { return group.depth; }))};
  }
};

/// Moves feet that clip lines leave out to the lines, as clip_foot does.
HWY_INLINE UnitFeet<Lanes> clipped_feet(const ClipGroup& clips, std::size_t k,
                                        const Cells<One<CellGroup>>& cells,
                                        const UnitFeet<Lanes>& whole) {
  const Lanes lanes;
  const auto part = [&](const GroupLanes& from) { return hn::Load(lanes, from.data() + k); };
  const auto kept = hn::Le(
      hn::Add(hn::Mul(part(clips.a), whole.x), hn::Mul(part(clips.b), whole.y)), part(clips.c));
  const auto x0 = part(clips.x), y0 = part(clips.y);
  const Vectors<Lanes> to{
      part(clips.to_x), part(clips.to_y),
      hn::Add(hn::Mul(cells.slope_x, part(clips.to_x)), hn::Mul(cells.slope_y, part(clips.to_y)))};
  const auto length = hn::Max(dot<Lanes>(to, to), hn::Set(lanes, 1e-30F));
  const auto along = hn::Div(dot<Lanes>(cells.feet(x0, y0, hn::Zero(lanes)).off, to), length);
  const auto share = hn::Min(hn::Max(along, hn::Zero(lanes)), hn::Set(lanes, 1.0F));
  const auto x = hn::Add(x0, hn::Mul(share, to.x)), y = hn::Add(y0, hn::Mul(share, to.y));
  const UnitFeet<Lanes> clipped = cells.feet(x, y, cells.twisted(x, y));
  return {chosen<Lanes>(kept, whole.off, clipped.off),
          hn::IfThenElse(kept, whole.square, clipped.square), hn::IfThenElse(kept, whole.x, x),
          hn::IfThenElse(kept, whole.y, y)};
}

/// The feet on whole cells, squares in m^2. `facing`: out of all reach are feet whose own normals
/// meet the place not to within a cosine.
template <bool facing, class Source>
HWY_INLINE UnitFeet<typename Source::Tag> in_metres(const Source& source,
                                                    const Cells<Source>& cells,
                                                    UnitFeet<typename Source::Tag> feet,
                                                    float cosine) {
  const typename Source::Tag tag;
  const auto square = feet.square;
  feet.square = hn::Mul(
      square, source.set([](const CellGroup& group) { return group.spacing * group.spacing; }));
  if constexpr (facing) {
    const auto slope_x = hn::Add(cells.slope_x, hn::Mul(cells.twist, feet.y));
    const auto slope_y = hn::Add(cells.slope_y, hn::Mul(cells.twist, feet.x));
    const auto level =
        hn::Add(hn::Add(hn::Mul(slope_x, slope_x), hn::Mul(slope_y, slope_y)), constant(tag, 1.0F));
    const auto below =
        hn::Sub(hn::Sub(feet.off.z, hn::Mul(slope_x, feet.off.x)), hn::Mul(slope_y, feet.off.y));
    const auto meets = hn::Ge(hn::Mul(below, below),
                              hn::Mul(hn::Mul(square, level), constant(tag, cosine * cosine)));
    feet.square = hn::IfThenElse(meets, feet.square, constant(tag, empty_square));
  }
  return feet;
}

template <bool facing>
HWY_INLINE UnitFeet<Lanes> cell_feet(const UnitGroups& groups, const CellGroup& group,
                                     const std::array<float, 3>& place, float cosine,
                                     std::size_t k) {
  const One<CellGroup> source{&group, k};
  const Cells<One<CellGroup>> cells(source, place);
  UnitFeet<Lanes> feet = cells.template nearest<true>();
  if (group.clips != 0) feet = clipped_feet(groups.clips[group.clips - 1], k, cells, feet);
  return in_metres<facing>(source, cells, feet, cosine);
}

/// Triangles, and a place from their first corners.
template <class Source>
struct Triangles {
  using Tag = typename Source::Tag;
  using Floats = hn::Vec<Tag>;
  Vectors<Tag> away, side, other, normal;

  HWY_INLINE Triangles(const Source& source, const std::array<float, 3>& place)
      : away(minus<Tag>(vectors<Tag>(place),
                        load(
                            source, [](const TriangleGroup& g) -> auto& { return g.corner; }))),
        side(load(
            source, [](const TriangleGroup& g) -> auto& { return g.side; })),
        other(load(
            source, [](const TriangleGroup& g) -> auto& { return g.other; })),
        normal(cross<Tag>(side, other)) {}

  /// Where the foot on the plane is in the triangle or close to it, the height above the plane:
  /// never more than the distance. Elsewhere, and where it is too thin to have a plane, the nearest
  /// of the sides. Close: by a share of its size.
  [[nodiscard]] HWY_INLINE UnitFeet<Tag> nearest(float rounding) const {
    const Tag tag;
    const Floats zero = hn::Zero(tag);
    const Floats ss = dot<Tag>(side, side), so = dot<Tag>(side, other), oo = dot<Tag>(other, other);
    const Floats as = dot<Tag>(away, side), ao = dot<Tag>(away, other);
    const Floats area = dot<Tag>(normal, normal);
    const Floats size = hn::Max(area, constant(tag, 1e-37F));
    const Floats height = dot<Tag>(normal, away);
    const Floats per_size = hn::Div(height, size);
    const UnitFeet<Tag> level{scaled<Tag>(normal, per_size), hn::Mul(height, per_size), zero, zero};
    const Floats u = hn::Sub(hn::Mul(oo, as), hn::Mul(so, ao));
    const Floats v = hn::Sub(hn::Mul(ss, ao), hn::Mul(so, as));
    // Rounding must not take a foot out of a triangle.
    const Floats slack = hn::Mul(size, constant(tag, rounding));
    const auto inside =
        hn::And(hn::And(hn::Ge(hn::Add(u, slack), zero), hn::Ge(hn::Add(v, slack), zero)),
                hn::Le(hn::Add(u, v), hn::Add(size, slack)));
    const auto thin = hn::Le(area, hn::Mul(hn::Mul(ss, oo), constant(tag, thin_sine_squared)));
    const UnitFeet<Tag> first = on_segment(away, side, as, ss);
    const UnitFeet<Tag> second = on_segment(away, other, ao, oo);
    const Vectors<Tag> across = minus<Tag>(other, side), from = minus<Tag>(away, side);
    const UnitFeet<Tag> third =
        on_segment(from, across, dot<Tag>(from, across), dot<Tag>(across, across));
    const UnitFeet<Tag> sides = nearer_of<Tag>(nearer_of<Tag>(first, second), third);
    const UnitFeet<Tag> flat = nearer_of<Tag>(level, sides);
    const auto is_flat = hn::AndNot(thin, inside);
    return {chosen<Tag>(is_flat, flat.off, sides.off),
            hn::IfThenElse(is_flat, flat.square, sides.square), zero, zero};
  }

 private:
  template <class Part>
  [[nodiscard]] static HWY_INLINE Vectors<Tag> load(const Source& source, Part part) {
    const auto axis = [&](std::size_t which) {
      return source.load([&](const TriangleGroup& group) -> auto& { return part(group)[which]; });
    };
    return {axis(0), axis(1), axis(2)};
  }
  /// From the segment that begins at a corner, of which `off` is the place.
  [[nodiscard]] static HWY_INLINE UnitFeet<Tag> on_segment(const Vectors<Tag>& off,
                                                           const Vectors<Tag>& side, Floats along,
                                                           Floats length) {
    const Tag tag;
    const Floats zero = hn::Zero(tag);
    // A side without a length is its corner.
    const Floats share = hn::Div(along, hn::Max(length, constant(tag, 1e-30F)));
    const Vectors<Tag> left =
        minus<Tag>(off, scaled<Tag>(side, hn::Min(hn::Max(share, zero), constant(tag, 1.0F))));
    return {left, dot<Tag>(left, left), zero, zero};
  }
};

template <bool facing, class Source>
HWY_INLINE UnitFeet<typename Source::Tag> triangle_feet(const Source& source,
                                                        const std::array<float, 3>& place,
                                                        float cosine, float rounding) {
  using Tag = typename Source::Tag;
  const Tag tag;
  const Triangles<Source> triangles(source, place);
  UnitFeet<Tag> feet = triangles.nearest(rounding);
  if constexpr (facing) {
    const auto height = dot<Tag>(triangles.normal, feet.off);
    const auto size = hn::Mul(feet.square, dot<Tag>(triangles.normal, triangles.normal));
    const auto meets =
        hn::Ge(hn::Mul(height, height), hn::Mul(size, constant(tag, cosine * cosine)));
    feet.square = hn::IfThenElse(meets, feet.square, constant(tag, empty_square));
  }
  return feet;
}

/// The least of what is found lane by lane, and where it is.
template <class Tag>
class Least {
 public:
  HWY_INLINE Least()
      : least_(constant(Tag(), std::numeric_limits<float>::infinity())),
        x_(hn::Zero(Tag())),
        y_(hn::Zero(Tag())),
        first_(hn::Zero(Whole())) {}

  /// `first`: the number of the first lane.
  HWY_INLINE void add(const UnitFeet<Tag>& found, std::uint32_t first) {
    // Counted from a constant: an Iota that begins elsewhere is stored number by number.
    const auto here =
        hn::Add(hn::Iota(Whole(), 0), hn::Set(Whole(), static_cast<std::int32_t>(first)));
    const auto nearer = hn::Lt(found.square, least_);
    least_ = hn::IfThenElse(nearer, found.square, least_);
    x_ = hn::IfThenElse(nearer, found.x, x_);
    y_ = hn::IfThenElse(nearer, found.y, y_);
    first_ = hn::IfThenElse(hn::RebindMask(Whole(), nearer), here, first_);
  }

  [[nodiscard]] HWY_INLINE NearestUnit found() const {
    const Tag tag;
    const auto least = hn::MinOfLanes(tag, least_);
    // Of equals the first, so that every processor tells the same.
    const auto none = hn::Set(Whole(), std::numeric_limits<std::int32_t>::max());
    const auto numbers =
        hn::IfThenElse(hn::RebindMask(Whole(), hn::Eq(least_, least)), first_, none);
    const auto own = hn::RebindMask(tag, hn::Eq(numbers, hn::MinOfLanes(Whole(), numbers)));
    const auto lane = static_cast<std::size_t>(
        std::max<std::intptr_t>(0, static_cast<std::intptr_t>(hn::FindFirstTrue(tag, own))));
    alignas(64) std::array<float, 2 * group_units> x, y;
    alignas(64) std::array<std::int32_t, 2 * group_units> first;
    hn::Store(x_, tag, x.data());
    hn::Store(y_, tag, y.data());
    hn::Store(first_, Whole(), first.data());
    return {static_cast<std::uint32_t>(first[lane]), hn::GetLane(least), x[lane], y[lane]};
  }

 private:
  using Whole = hn::RebindToSigned<Tag>;
  hn::Vec<Tag> least_, x_, y_;
  hn::Vec<Whole> first_;
};

template <bool facing>
HWY_INLINE UnitFeet<Lanes> feet_of(const UnitGroups& groups, std::uint32_t number,
                                   const std::array<float, 3>& place, float cosine, float rounding,
                                   std::size_t k) {
  const Lanes lanes;
  const auto zero = hn::Zero(lanes);
  const std::size_t beyond = number - groups.cells.size();
  if (number < groups.cells.size()) {
    return cell_feet<facing>(groups, groups.cells[number], place, cosine, k);
  }
  if (beyond < groups.triangles.size()) {
    const One<TriangleGroup> source{&groups.triangles[beyond], k};
    return triangle_feet<facing>(source, place, cosine, rounding);
  }
  return {{zero, zero, zero}, hn::Set(lanes, empty_square), zero, zero};
}

/// How near to a triangle's border its plane counts: where the distance is meant, and where it must
/// not be more.
constexpr float exact_rounding = 1e-4F, safe_rounding = 0.01F;

}  // namespace spm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
