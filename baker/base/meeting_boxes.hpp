// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/box_intersection_d.h>
#include <tbb/enumerable_thread_specific.h>

#include <vector>

namespace spm::baker {

/// What `take(a, b, found)` adds to `found` for each pair of boxes that meet, in no order. It is
/// called for several pairs at once. Boxes have explicit identities (CGAL's ID_EXPLICIT).
template <class Found, class Box, class Take>
[[nodiscard]] std::vector<Found> of_meeting_boxes(std::vector<Box> boxes, const Take& take) {
  tbb::enumerable_thread_specific<std::vector<Found>> found;
  CGAL::box_self_intersection_d<CGAL::Parallel_tag>(
      boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) { take(a, b, found.local()); });
  std::vector<Found> all;
  for (const std::vector<Found>& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace spm::baker
