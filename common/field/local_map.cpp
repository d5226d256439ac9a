// SPDX-License-Identifier: Apache-2.0
#include "common/field/local_map.hpp"

#include <algorithm>
#include <limits>

namespace spm {

namespace {

template <class Number>
bool rounded(double value, double unit, Number& number) noexcept {
  const double parts = std::round(value / unit);
  if (!(std::abs(parts) <= std::numeric_limits<Number>::max())) return false;
  number = static_cast<Number>(parts);
  return true;
}

}  // namespace

bool pack_local_map(const LocalMap& map, double value_unit, PackedLocalMap& packed) noexcept {
  std::array<std::int16_t, 4> wide{};
  std::array<std::int8_t, 6> narrow{};
  std::array<std::uint8_t, 2> last{};
  if (map.plane > 255 || !rounded(map.value, value_unit, wide[0])) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!rounded(map.slope[static_cast<int>(i)], slope_unit, wide[i + 1])) return false;
  }
  double most = 0;
  for (const double bend : map.bend) most = std::max(most, std::abs(bend));
  // The finest unit, a power of two, in which the largest number fits.
  int exponent = most > 0 ? std::ilogb(most) - 6 : -bend_exponent_bias;
  while (std::round(most / std::ldexp(1.0, exponent)) > 127) ++exponent;
  exponent = std::max(exponent, -bend_exponent_bias);
  if (exponent + bend_exponent_bias > 60) return false;
  for (std::size_t i = 0; i < 6; ++i) {
    if (!rounded(map.bend[i], std::ldexp(1.0, exponent), narrow[i])) return false;
  }
  last = {static_cast<std::uint8_t>(exponent + bend_exponent_bias),
          static_cast<std::uint8_t>(map.plane)};
  std::memcpy(packed.words.data(), wide.data(), 8);
  std::memcpy(packed.words.data() + 2, narrow.data(), 6);
  std::memcpy(reinterpret_cast<char*>(packed.words.data() + 2) + 6, last.data(), 2);
  return true;
}

}  // namespace spm
