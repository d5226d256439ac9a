// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/base/half.hpp"

namespace spm {

/// Heights of distance maps, m, as a file has them: FLOAT samples, or HALF ones (half.hpp). A view
/// that owns nothing.
struct StoredHeights {
  const void* first = nullptr;
  std::uint32_t count = 0;
  bool halves = false;

  StoredHeights() = default;
  StoredHeights(std::span<const float> floats) noexcept
      : first(floats.data()), count(static_cast<std::uint32_t>(floats.size())) {}
  StoredHeights(std::span<const std::uint16_t> samples) noexcept
      : first(samples.data()), count(static_cast<std::uint32_t>(samples.size())), halves(true) {}

  /// Those from one on.
  [[nodiscard]] StoredHeights from(std::uint32_t place) const noexcept {
    StoredHeights rest = *this;
    rest.first = halves ? static_cast<const void*>(half_at(place)) : float_at(place);
    rest.count -= place;
    return rest;
  }
  [[nodiscard]] float at(std::size_t place) const noexcept {
    return halves ? float_of_half(*half_at(place)) : *float_at(place);
  }
  /// Where a height lies that is a FLOAT, or a HALF.
  [[nodiscard]] const float* float_at(std::size_t place) const noexcept {
    return static_cast<const float*>(first) + place;
  }
  [[nodiscard]] const std::uint16_t* half_at(std::size_t place) const noexcept {
    return static_cast<const std::uint16_t*>(first) + place;
  }
};

}  // namespace spm
