// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "baker/pictures/picture.hpp"

namespace spm::baker {

/// What the colours of ramp_at mean: the texts at 0, in the middle and at 1.
struct ColourBar {
  std::string low, middle, high;
};

/// What a reader needs beside a picture.
struct Legend {
  std::string caption;                               ///< what is seen, ASCII
  std::optional<ColourBar> bar;                      ///< of the ramp's colours
  std::vector<std::pair<Colour, std::string>> keys;  ///< other colours, and what they mean
  double pixel = 0;  ///< m, the edge of a pixel, for a bar that tells the scale; 0: none
};

/// The picture with its legend below it, on a ground of its own: nothing covers what is seen. The
/// same input gives the same bytes.
[[nodiscard]] Picture with_legend(const Picture& picture, const Legend& legend);

}  // namespace spm::baker
