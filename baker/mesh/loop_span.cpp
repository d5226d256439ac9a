// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/loop_span.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "baker/mesh/triangle_height.hpp"

namespace spm::baker {
namespace {

/// Of longer loops the smallest corners are cut off first, since time grows by the third power.
constexpr std::size_t most_corners = 400;

[[nodiscard]] double area_of(std::span<const Vector3> points, std::uint32_t a, std::uint32_t b,
                             std::uint32_t c) {
  return triangle_area(points[a], points[b], points[c]);
}

/// Cuts off the corners of a loop whose triangles are smallest, until few enough are left.
void cut_corners(std::span<const Vector3> points, Loop& loop, std::vector<Triangle>& triangles) {
  while (loop.size() > most_corners) {
    // Every second corner that is smaller than most.
    std::vector<double> areas(loop.size());
    for (std::size_t i = 0; i < loop.size(); ++i) {
      areas[i] = area_of(points, loop[(i + loop.size() - 1) % loop.size()], loop[i],
                         loop[(i + 1) % loop.size()]);
    }
    std::vector<double> sorted = areas;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    std::size_t left = loop.size() - most_corners;
    Loop kept;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const bool after_kept = i > 0 && kept.back() == loop[i - 1];
      if (left == 0 || !after_kept || i + 1 == loop.size() || areas[i] > *middle) {
        kept.push_back(loop[i]);
        continue;
      }
      triangles.push_back({loop[i - 1], loop[i], loop[i + 1]});
      --left;
    }
    loop = std::move(kept);
  }
}

}  // namespace

void span_loop(std::span<const Vector3> points, Loop loop, std::vector<Triangle>& triangles) {
  cut_corners(points, loop, triangles);
  const std::size_t count = loop.size();
  const auto at = [count](std::size_t i, std::size_t k) { return i * count + k; };
  std::vector<double> least(count * count, 0);
  std::vector<std::size_t> between(count * count, 0);
  for (std::size_t way = 2; way < count; ++way) {
    for (std::size_t i = 0; i + way < count; ++i) {
      const std::size_t k = i + way;
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t m = i + 1; m < k; ++m) {
        const double area =
            least[at(i, m)] + least[at(m, k)] + area_of(points, loop[i], loop[m], loop[k]);
        if (area >= best) continue;
        best = area;
        between[at(i, k)] = m;
      }
      least[at(i, k)] = best;
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> left{{0, count - 1}};
  while (!left.empty()) {
    const auto [i, k] = left.back();
    left.pop_back();
    if (k < i + 2) continue;
    const std::size_t m = between[at(i, k)];
    triangles.push_back({loop[i], loop[m], loop[k]});
    left.emplace_back(i, m);
    left.emplace_back(m, k);
  }
}

}  // namespace spm::baker
