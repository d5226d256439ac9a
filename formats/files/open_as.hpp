// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace spm {

/// What an open surface of a mesh is taken for.
enum class OpenAs : std::uint8_t {
  automatic,  ///< a solid where lids take little of its area, else a sheet
  solid,      ///< a solid, whatever lids it takes
  sheet,      ///< a sheet, however small its holes are
};
/// The words of `--open`, of scenes and of baked files, in that order.
inline constexpr std::array<const char*, 3> open_as_words{"auto", "solid", "sheet"};

}  // namespace spm
