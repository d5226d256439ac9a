// SPDX-License-Identifier: Apache-2.0
#include "common/surface_clearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/closest_element.hpp"
#include "common/listed_feet.hpp"

namespace spm {

namespace {

/// What the roundings of boxes of floats may add to a distance, of its size and of the box's.
constexpr double rounding_share = 2e-6;

struct Pending {
  float square;
  std::uint32_t node;
  TreeBox box;
};

}  // namespace

double box_clearance(const AssetView& asset, const Vector3& point) noexcept {
  const ElementTree& tree = asset.tree;
  const std::size_t nodes = tree.words.size() / tree_node_words;
  if (nodes == 0) return std::numeric_limits<double>::infinity();
  const std::array<float, 3> place = from_origin(tree, point);
  std::array<Pending, static_cast<std::size_t>(most_clearance_nodes) * tree_children> open;
  open[0] = {0, 0, {{}, tree.size}};
  std::size_t pending = 1;
  float least = std::numeric_limits<float>::infinity();
  for (int opened = 0; opened < most_clearance_nodes && pending > 0; ++opened) {
    // The nearest is opened: what is left then bounds everything.
    const auto nearest =
        std::min_element(open.begin(), open.begin() + static_cast<std::ptrdiff_t>(pending),
                         [](const Pending& a, const Pending& b) { return a.square < b.square; });
    const Pending next = *nearest;
    if (next.square >= least) break;
    *nearest = open[--pending];
    const std::uint32_t* node = tree.words.data() + std::size_t{next.node} * tree_node_words;
    for (std::size_t k = 0; k < tree_children; ++k) {
      const TreeChild child = unpack_child(node[k]);
      if (child.kind == ElementKind::none) continue;
      const TreeBox box = child_box(next.box, node, k);
      const float square = squared_distance(box, place);
      if (child.kind == ElementKind::node && child.first < nodes) {
        open[pending++] = {square, child.first, box};
      } else {
        least = std::min(least, square);
      }
    }
  }
  for (std::size_t k = 0; k < pending; ++k) least = std::min(least, open[k].square);
  if (!(least >= 0)) return 0;
  const double distance = std::sqrt(static_cast<double>(least));
  const float size = std::max({tree.size[0], tree.size[1], tree.size[2]});
  return std::max(0.0, distance - rounding_share * (distance + static_cast<double>(size)));
}

double surface_clearance(const AssetView& asset, const Vector3& point) noexcept {
  if (!point.allFinite()) return 0;
  // Asked as if inside, nothing is too far away to be found; what is found beyond the band may be a
  // quarter farther than the nearest.
  const IndexList list = list_at(asset.index, point);
  const double found = list.numbers != nullptr
                           ? listed_nearest(asset, list, point).distance
                           : read_elements(asset, point, CubeKind::inside).nearest.distance;
  return std::max(0.0, 0.8 * found - asset.tolerance);
}

}  // namespace spm
