// SPDX-License-Identifier: Apache-2.0
#include "common/asset/primitive_packets.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/asset/primitive_packets.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

#include "common/asset/closest_on_primitives-inl.hpp"

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
  HWY_INLINE void add(const PrimitiveClosestPoints<Tag>& found) {
    const auto nearer = hn::Lt(found.square, least_);
    least_ = hn::IfThenElse(nearer, found.square, least_);
    x_ = hn::IfThenElse(nearer, found.x, x_);
    y_ = hn::IfThenElse(nearer, found.y, y_);
    off_ = chosen<Tag>(nearer, found.off, off_);
    first_ = hn::IfThenElse(hn::RebindMask(Whole(), nearer), here_, first_);
    here_ = hn::Add(here_, hn::Set(Whole(), static_cast<std::int32_t>(hn::Lanes(Tag()))));
  }

  /// Of equals the first, so that every processor tells the same.
  [[nodiscard]] HWY_INLINE NearestPrimitive found() const {
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
HWY_INLINE NearestPrimitive nearest_of(const PrimitivePackets& packets,
                                       const PackedNumbers& numbers,
                                       const std::array<float, 3>& place, float cosine) {
  Least<Lanes> least;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = 0; k < packet_width; k += hn::Lanes(Lanes())) {
      least.add(closest_on_packet<facing>(packets, numbers[i], place, cosine, exact_rounding, k));
    }
  }
  return least.found();
}

NearestPrimitive find_nearest(const PrimitivePackets& packets, const PackedNumbers& numbers,
                              const std::array<float, 3>& place) {
  return nearest_of<false>(packets, numbers, place, 0);
}

/// Asks memory for what will be looked at.
HWY_INLINE void fetch(const PrimitivePackets& packets, const PackedNumbers& numbers) {
  constexpr std::size_t line = 64;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::uint32_t number = numbers[i];
    if (number >= packets.cells.size()) continue;
    const auto* from = reinterpret_cast<const char*>(&packets.cells[number]);
    for (std::size_t k = 0; k < sizeof(CellPacket); k += line) __builtin_prefetch(from + k);
  }
}

void find_nearest_of_each(const PrimitivePackets& packets, std::span<const PackedNumbers> numbers,
                          std::span<const std::array<float, 3>> places,
                          std::span<NearestPrimitive> found) {
  constexpr std::size_t ahead = 3;
  for (std::size_t i = 0; i < std::min(ahead, numbers.size()); ++i) fetch(packets, numbers[i]);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i + ahead < numbers.size()) fetch(packets, numbers[i + ahead]);
    found[i] = nearest_of<false>(packets, numbers[i], places[i], 0);
  }
}

NearestPrimitive find_facing(const PrimitivePackets& packets, const PackedNumbers& numbers,
                             const std::array<float, 3>& place, float cosine) {
  return nearest_of<true>(packets, numbers, place, cosine);
}

NearestPrimitive find_of_packets(const PrimitivePackets& packets, const PackedNumbers& numbers,
                                 const std::array<float, 3>& place, float* squares) {
  NearestPrimitive least;
  for (std::uint32_t i = 0; i < numbers.size(); ++i) {
    std::uint32_t number = 0;
    NearestPrimitive found = find_nearest(packets, numbers.one(i, number), place);
    squares[i] = found.square;
    found.which += i * std::uint32_t{packet_width};
    if (found.square < least.square) least = found;
  }
  return least;
}

std::uint32_t find_squares(const PrimitivePackets& packets, const PackedNumbers& numbers,
                           const std::array<float, 3>& place, float* squares) {
  const Lanes lanes;
  Least<Lanes> least;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = 0; k < packet_width; k += hn::Lanes(lanes)) {
      const PrimitiveClosestPoints<Lanes> closest_points =
          closest_on_packet<false>(packets, numbers[i], place, 0, safe_rounding, k);
      hn::Store(closest_points.square, lanes, squares + i * packet_width + k);
      least.add(closest_points);
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
HWY_EXPORT(find_of_packets);
HWY_EXPORT(find_facing);
HWY_EXPORT(find_squares);
HWY_EXPORT(find_near);

NearestPrimitive nearest_primitive(const PrimitivePackets& packets, const PackedNumbers& numbers,
                                   const std::array<float, 3>& place) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_nearest)(packets, numbers, place);
}

void nearest_primitives(const PrimitivePackets& packets, std::span<const PackedNumbers> numbers,
                        std::span<const std::array<float, 3>> places,
                        std::span<NearestPrimitive> found) noexcept {
  HWY_DYNAMIC_DISPATCH(find_nearest_of_each)(packets, numbers, places, found);
}

NearestPrimitive nearest_of_packets(const PrimitivePackets& packets, const PackedNumbers& numbers,
                                    const std::array<float, 3>& place, float* squares) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_of_packets)(packets, numbers, place, squares);
}

NearestPrimitive nearest_facing(const PrimitivePackets& packets, const PackedNumbers& numbers,
                                const std::array<float, 3>& place, float cosine) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_facing)(packets, numbers, place, cosine);
}

std::uint32_t packet_squares(const PrimitivePackets& packets, const PackedNumbers& numbers,
                             const std::array<float, 3>& place, float* squares) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_squares)(packets, numbers, place, squares);
}

std::size_t near_lanes(const float* squares, std::size_t count, float farthest,
                       std::uint32_t* places) noexcept {
  return HWY_DYNAMIC_DISPATCH(find_near)(squares, count, farthest, places);
}

}  // namespace spm
#endif
