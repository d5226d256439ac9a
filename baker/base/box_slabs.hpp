// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/box_intersection_d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <vector>

namespace spm::baker {

/// Slabs of space across the longest axis of all boxes, in each of which about as many boxes begin,
/// so that pairs of boxes that meet can be looked for in each slab by itself. They are the same for
/// any number of threads. A box has `min_coord(axis)` and `max_coord(axis)`.
template <class Box>
class BoxSlabs {
 public:
  explicit BoxSlabs(const std::vector<Box>& boxes) {
    constexpr std::size_t boxes_each = 8192, most = 64;
    if (boxes.empty()) return;
    double longest = -1;
    for (int axis = 0; axis < 3; ++axis) {
      double low = infinity, high = -infinity;
      for (const Box& box : boxes) {
        low = std::min(low, box.min_coord(axis));
        high = std::max(high, box.max_coord(axis));
      }
      if (high - low <= longest) continue;
      longest = high - low;
      axis_ = axis;
    }
    std::vector<double> starts;
    starts.reserve(boxes.size());
    for (const Box& box : boxes) starts.push_back(box.min_coord(axis_));
    std::sort(starts.begin(), starts.end());
    const std::size_t count = std::clamp(boxes.size() / boxes_each, std::size_t{1}, most);
    for (std::size_t i = 1; i < count; ++i) {
      borders_.insert(borders_.end() - 1, starts[i * boxes.size() / count]);
    }
  }

  [[nodiscard]] std::size_t count() const { return borders_.size() - 1; }
  /// Whether a box reaches into a slab.
  [[nodiscard]] bool has(std::size_t slab, const Box& box) const {
    return box.min_coord(axis_) < borders_[slab + 1] && box.max_coord(axis_) >= borders_[slab];
  }
  /// Whether it is in this slab that two boxes, which meet, begin to. Of all it is so in one.
  [[nodiscard]] bool meet_in(std::size_t slab, const Box& a, const Box& b) const {
    const double start = std::max(a.min_coord(axis_), b.min_coord(axis_));
    return start >= borders_[slab] && start < borders_[slab + 1];
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  int axis_ = 0;
  std::vector<double> borders_{-infinity, infinity};
};

/// What `take(a, b, found)` adds to `found` for each pair of boxes that meet, in no order. It is
/// called for several pairs at once.
template <class Found, class Box, class Take>
[[nodiscard]] std::vector<Found> of_meeting_boxes(const std::vector<Box>& boxes, const Take& take) {
  const BoxSlabs<Box> slabs(boxes);
  std::vector<std::vector<Found>> found(slabs.count());
  tbb::parallel_for(std::size_t{0}, slabs.count(), [&](std::size_t slab) {
    std::vector<Box> own;
    std::copy_if(boxes.begin(), boxes.end(), std::back_inserter(own),
                 [&](const Box& box) { return slabs.has(slab, box); });
    CGAL::box_self_intersection_d(own.begin(), own.end(), [&](const Box& a, const Box& b) {
      if (slabs.meet_in(slab, a, b)) take(a, b, found[slab]);
    });
  });
  std::vector<Found> all;
  for (auto& of_slab : found) {
    all.insert(all.end(), of_slab.begin(), of_slab.end());
    of_slab = {};
  }
  return all;
}

}  // namespace spm::baker
