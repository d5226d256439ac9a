// SPDX-License-Identifier: Apache-2.0
#include "common/unit_groups.hpp"

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/unit_groups.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

#include "common/unit_feet-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace spm::HWY_NAMESPACE {

NearestUnit find_nearest(const UnitGroups& groups, std::span<const std::uint32_t> numbers,
                         const std::array<float, 3>& place, float* squares) {
  const Lanes lanes;
  Least<Lanes> least;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = 0; k < group_units; k += hn::Lanes(lanes)) {
      const auto feet = feet_of<false>(groups, numbers[i], place, 0, exact_rounding, k);
      hn::Store(feet.square, lanes, squares + i * group_units + k);
      least.add(feet, static_cast<std::uint32_t>(i * group_units + k));
    }
  }
  return least.found();
}

NearestUnit find_facing(const UnitGroups& groups, std::span<const std::uint32_t> numbers,
                        const std::array<float, 3>& place, const FacingQuery& query) {
  const Lanes lanes;
  const auto most = hn::Set(lanes, query.square);
  Least<Lanes> least;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = 0; k < group_units; k += hn::Lanes(lanes)) {
      if (i < query.known) {
        const auto known = hn::Load(lanes, query.squares + i * group_units + k);
        if (hn::AllFalse(lanes, hn::Le(known, most))) continue;
      }
      least.add(feet_of<true>(groups, numbers[i], place, query.cosine, exact_rounding, k),
                static_cast<std::uint32_t>(i * group_units + k));
    }
  }
  return least.found();
}

NearestUnit find_of_groups(const UnitGroups& groups, std::span<const std::uint32_t> numbers,
                           const std::array<float, 3>& place, float* squares) {
  alignas(64) GroupLanes own;
  NearestUnit least;
  for (std::uint32_t i = 0; i < numbers.size(); ++i) {
    NearestUnit found = find_nearest(groups, numbers.subspan(i, 1), place, own.data());
    squares[i] = found.square;
    found.which += i * std::uint32_t{group_units};
    if (found.square < least.square) least = found;
  }
  return least;
}

std::uint32_t find_squares(const UnitGroups& groups, std::span<const std::uint32_t> numbers,
                           const std::array<float, 3>& place, float* squares) {
  const Lanes lanes;
  Least<Lanes> least;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = 0; k < group_units; k += hn::Lanes(lanes)) {
      const UnitFeet<Lanes> feet = feet_of<false>(groups, numbers[i], place, 0, safe_rounding, k);
      hn::Store(feet.square, lanes, squares + i * group_units + k);
      least.add(feet, static_cast<std::uint32_t>(i * group_units + k));
    }
  }
  return least.found().which;
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
HWY_EXPORT(find_of_groups);
HWY_EXPORT(find_facing);
HWY_EXPORT(find_squares);
HWY_EXPORT(find_near);

NearestUnit nearest_unit(const UnitGroups& groups, std::span<const std::uint32_t> numbers,
                         const std::array<float, 3>& place, float* squares) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_nearest)(groups, numbers, place, squares);
}

NearestUnit nearest_of_groups(const UnitGroups& groups, std::span<const std::uint32_t> numbers,
                              const std::array<float, 3>& place, float* squares) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_of_groups)(groups, numbers, place, squares);
}

NearestUnit nearest_facing(const UnitGroups& groups, std::span<const std::uint32_t> numbers,
                           const std::array<float, 3>& place, const FacingQuery& query) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_facing)(groups, numbers, place, query);
}

std::uint32_t group_squares(const UnitGroups& groups, std::span<const std::uint32_t> numbers,
                            const std::array<float, 3>& place, float* squares) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_squares)(groups, numbers, place, squares);
}

std::size_t near_lanes(const float* squares, std::size_t count, float farthest,
                       std::uint32_t* places) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_near)(squares, count, farthest, places);
}

}  // namespace spm
#endif
