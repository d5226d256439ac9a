// SPDX-License-Identifier: Apache-2.0
#include "common/asset/unit_groups.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/asset/unit_groups.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

#include "common/asset/unit_feet-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace spm::HWY_NAMESPACE {

/// The least of what is found lane by lane, and where it is.
template <class Tag>
class Least {
 public:
  HWY_INLINE Least()
      : least_(constant(Tag(), std::numeric_limits<float>::infinity())),
        x_(hn::Zero(Tag())),
        y_(hn::Zero(Tag())),
        off_{hn::Zero(Tag()), hn::Zero(Tag()), hn::Zero(Tag())},
        first_(hn::Zero(Whole())),
        here_(hn::Iota(Whole(), 0)) {}

  /// Lanes count from where those before end.
  HWY_INLINE void add(const UnitFeet<Tag>& found) {
    const auto nearer = hn::Lt(found.square, least_);
    least_ = hn::IfThenElse(nearer, found.square, least_);
    x_ = hn::IfThenElse(nearer, found.x, x_);
    y_ = hn::IfThenElse(nearer, found.y, y_);
    off_ = chosen<Tag>(nearer, found.off, off_);
    first_ = hn::IfThenElse(hn::RebindMask(Whole(), nearer), here_, first_);
    here_ = hn::Add(here_, hn::Set(Whole(), static_cast<std::int32_t>(hn::Lanes(Tag()))));
  }

  /// Of equals the first, so that every processor tells the same.
  [[nodiscard]] HWY_INLINE NearestUnit found() const {
    const Tag tag;
    const auto least = hn::MinOfLanes(tag, least_);
    const auto none = hn::Set(Whole(), std::numeric_limits<std::int32_t>::max());
    const auto numbers =
        hn::IfThenElse(hn::RebindMask(Whole(), hn::Eq(least_, least)), first_, none);
    const auto which = static_cast<std::size_t>(hn::GetLane(hn::MinOfLanes(Whole(), numbers)));
    if (!(hn::GetLane(least) < nothing_square)) return {};
    const std::size_t lane = which % hn::Lanes(tag);
    const auto at = [lane](hn::Vec<Tag> lanes) { return hn::ExtractLane(lanes, lane); };
    return {static_cast<std::uint32_t>(which),
            hn::GetLane(least),
            at(x_),
            at(y_),
            {at(off_.x), at(off_.y), at(off_.z)}};
  }

  [[nodiscard]] HWY_INLINE std::uint32_t which() const { return found().which; }

 private:
  using Whole = hn::RebindToSigned<Tag>;
  hn::Vec<Tag> least_, x_, y_;
  Vectors<Tag> off_;
  hn::Vec<Whole> first_, here_;
};

// Nothing is stored on the way: what is loaded next would wait where its address looks alike.
template <bool facing>
HWY_INLINE NearestUnit nearest_of(const UnitGroups& groups, const GroupNames& numbers,
                                  const std::array<float, 3>& place, float cosine) {
  Least<Lanes> least;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = 0; k < group_units; k += hn::Lanes(Lanes())) {
      least.add(feet_of<facing>(groups, numbers[i], place, cosine, exact_rounding, k));
    }
  }
  return least.found();
}

NearestUnit find_nearest(const UnitGroups& groups, const GroupNames& numbers,
                         const std::array<float, 3>& place) {
  return nearest_of<false>(groups, numbers, place, 0);
}

/// Asks memory for what will be looked at.
HWY_INLINE void fetch(const UnitGroups& groups, const GroupNames& numbers) {
  constexpr std::size_t line = 64;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::uint32_t number = numbers[i];
    if (number >= groups.cells.size()) continue;
    const auto* from = reinterpret_cast<const char*>(&groups.cells[number]);
    for (std::size_t k = 0; k < sizeof(CellGroup); k += line) __builtin_prefetch(from + k);
  }
}

void find_nearest_of_each(const UnitGroups& groups, std::span<const GroupNames> numbers,
                          std::span<const std::array<float, 3>> places,
                          std::span<NearestUnit> found) {
  constexpr std::size_t ahead = 3;
  for (std::size_t i = 0; i < std::min(ahead, numbers.size()); ++i) fetch(groups, numbers[i]);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i + ahead < numbers.size()) fetch(groups, numbers[i + ahead]);
    found[i] = nearest_of<false>(groups, numbers[i], places[i], 0);
  }
}

NearestUnit find_facing(const UnitGroups& groups, const GroupNames& numbers,
                        const std::array<float, 3>& place, float cosine) {
  return nearest_of<true>(groups, numbers, place, cosine);
}

NearestUnit find_of_groups(const UnitGroups& groups, const GroupNames& numbers,
                           const std::array<float, 3>& place, float* squares) {
  NearestUnit least;
  for (std::uint32_t i = 0; i < numbers.size(); ++i) {
    std::uint32_t number = 0;
    NearestUnit found = find_nearest(groups, numbers.one(i, number), place);
    squares[i] = found.square;
    found.which += i * std::uint32_t{group_units};
    if (found.square < least.square) least = found;
  }
  return least;
}

std::uint32_t find_squares(const UnitGroups& groups, const GroupNames& numbers,
                           const std::array<float, 3>& place, float* squares) {
  const Lanes lanes;
  Least<Lanes> least;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = 0; k < group_units; k += hn::Lanes(lanes)) {
      const UnitFeet<Lanes> feet = feet_of<false>(groups, numbers[i], place, 0, safe_rounding, k);
      hn::Store(feet.square, lanes, squares + i * group_units + k);
      least.add(feet);
    }
  }
  return least.which();
}

std::size_t find_near(const float* squares, std::size_t count, float farthest,
                      std::uint32_t* places) {
  const Lanes lanes;
  const hn::RebindToUnsigned<Lanes> whole;
  const auto most = hn::Set(lanes, farthest);
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

HWY_EXPORT(find_nearest);
HWY_EXPORT(find_nearest_of_each);
HWY_EXPORT(find_of_groups);
HWY_EXPORT(find_facing);
HWY_EXPORT(find_squares);
HWY_EXPORT(find_near);

NearestUnit nearest_unit(const UnitGroups& groups, const GroupNames& numbers,
                         const std::array<float, 3>& place) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_nearest)(groups, numbers, place);
}

void nearest_units(const UnitGroups& groups, std::span<const GroupNames> numbers,
                   std::span<const std::array<float, 3>> places,
                   std::span<NearestUnit> found) noexcept {
  HWY_DYNAMIC_DISPATCH(find_nearest_of_each)(groups, numbers, places, found);
}

NearestUnit nearest_of_groups(const UnitGroups& groups, const GroupNames& numbers,
                              const std::array<float, 3>& place, float* squares) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_of_groups)(groups, numbers, place, squares);
}

NearestUnit nearest_facing(const UnitGroups& groups, const GroupNames& numbers,
                           const std::array<float, 3>& place, float cosine) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_facing)(groups, numbers, place, cosine);
}

std::uint32_t group_squares(const UnitGroups& groups, const GroupNames& numbers,
                            const std::array<float, 3>& place, float* squares) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_squares)(groups, numbers, place, squares);
}

std::size_t near_lanes(const float* squares, std::size_t count, float farthest,
                       std::uint32_t* places) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_near)(squares, count, farthest, places);
}

}  // namespace spm
#endif
