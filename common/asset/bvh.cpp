// SPDX-License-Identifier: Apache-2.0
#include "common/asset/bvh.hpp"

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/asset/bvh.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace spm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, bvh_children>;

/// The bytes of a word, starting with number `first`.
HWY_INLINE hn::Vec<Floats> bytes_of(const std::uint32_t& word, std::size_t first) {
  static_assert(std::endian::native == std::endian::little);
  const hn::Rebind<std::uint8_t, Floats> bytes;
  const auto some = hn::LoadU(bytes, reinterpret_cast<const std::uint8_t*>(&word) + first);
  return hn::ConvertTo(Floats(), hn::PromoteTo(hn::RebindToSigned<Floats>(), some));
}

void find_boxes(const BvhBox& box, const std::uint32_t* node, const std::array<float, 3>& place,
                NodeBoxes& found) {
  const Floats lanes;
  for (std::size_t k = 0; k < bvh_children; k += hn::Lanes(lanes)) {
    auto square = hn::Zero(lanes);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto begin = hn::Set(lanes, box.low[axis]);
      const auto step = hn::Set(lanes, (box.high[axis] - box.low[axis]) * (1.0F / 255));
      const auto low = hn::Add(begin, hn::Mul(bytes_of(node[4 + 2 * axis], k), step));
      const auto high = hn::Add(begin, hn::Mul(bytes_of(node[5 + 2 * axis], k), step));
      const auto at = hn::Set(lanes, place[axis]);
      const auto off = hn::Max(hn::Sub(low, at), hn::Sub(at, high));
      const auto out = hn::IfThenElseZero(hn::Gt(off, hn::Zero(lanes)), off);
      square = hn::Add(square, hn::Mul(out, out));
      hn::Store(low, lanes, found.low[axis].data() + k);
      hn::Store(high, lanes, found.high[axis].data() + k);
    }
    hn::Store(square, lanes, found.squares.data() + k);
  }
}

}  // namespace spm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm {

HWY_EXPORT(find_boxes);

void find_node_boxes(const BvhBox& box, const std::uint32_t* node,
                     const std::array<float, 3>& place, NodeBoxes& found) noexcept {
  HWY_DYNAMIC_DISPATCH(find_boxes)(box, node, place, found);
}

}  // namespace spm
#endif
