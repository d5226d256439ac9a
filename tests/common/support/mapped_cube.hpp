// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/surface/height_chart.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/octree_by_hand.hpp"

namespace spm::test {

/// A cube by hand that also has distance maps. Its octree is the one of triangles until a test
/// names the maps in it.
class MappedCube : public SparseCubeByHand {
 public:
  using SparseCubeByHand::SparseCubeByHand;

  /// How far a surface lies below a place of a support plane, m.
  using Depth = std::function<double(const Vector3& on_plane)>;

  std::vector<HeightChart> charts;

  /// Adds a map of a surface, as that plane sees all of the octree. Its number. A quadratic
  /// function of the place is told exactly: heights are its values less an eighth of both second
  /// differences.
  std::uint32_t add_map(
      std::uint32_t plane, const Depth& depth = [](const Vector3&) { return 0.0; }) {
    constexpr std::uint16_t side = 16;
    constexpr double first = -8;
    const SupportPlane& own = planes[plane];
    const double spacing = octree.edge / 8;
    const auto at = [&](int column, int row) {
      return depth(support_plane_point(own, spacing * (first + column), spacing * (first + row)));
    };
    std::vector<float>& made = heights_.emplace_back();
    // One more row, since one more height may be read behind the last.
    for (int row = 0; row < side + 1; ++row) {
      for (int column = 0; column < side; ++column) {
        const double around =
            at(column - 1, row) + at(column + 1, row) + at(column, row - 1) + at(column, row + 1);
        made.push_back(static_cast<float>(at(column, row) - (around - 4 * at(column, row)) / 8));
      }
    }
    HeightChart& chart = charts.emplace_back(chart_on(own, spacing, first, first));
    chart.heights = std::span<const float>(made);
    chart.stride = chart.columns = chart.rows = side;
    chart.plane = plane;
    return static_cast<std::uint32_t>(charts.size() - 1);
  }

  /// The same of the offset surface at that signed distance, m, of a plane as its own surface.
  std::uint32_t add_offset_map(std::uint32_t plane, float offset) {
    const std::uint32_t added =
        add_map(plane, [offset](const Vector3&) { return -static_cast<double>(offset); });
    charts[added].offset = offset;
    return added;
  }

  /// Makes all of the octree's space one leaf whose word names maps.
  void fill_with_maps(std::uint32_t word) {
    octree.root_words = {root_word(OctreeKind::map, 0)};
    octree.words = {word};
    show();
  }

  /// Points the view at the vectors again, after a test changed them.
  void show() {
    refresh();
    view.charts = charts;
  }

 private:
  std::vector<std::vector<float>> heights_;  ///< of each map; they stay where charts look for them
};

}  // namespace spm::test
