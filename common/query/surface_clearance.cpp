// SPDX-License-Identifier: Apache-2.0
#include "common/query/surface_clearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/query/closest_element.hpp"
#include "common/query/listed_closest_points.hpp"

namespace spm {

namespace {

/// Bound of the error that rounding boxes to floats may add to a distance, relative to the distance
/// and to the box.
constexpr double rounding_share = 2e-6;

/// Nodes that were not opened yet, and the squares of their distances, m^2.
struct OpenNodes {
  static constexpr std::size_t most =
      static_cast<std::size_t>(max_clearance_nodes) * (bvh_children - 1) + 1;
  struct Node {
    std::uint32_t number;
    BvhBox box;
  };
  // Left uninitialised: only entries that were put are read.
  std::array<float, most> squares;
  std::array<Node, most> nodes;
  std::size_t count = 0;

  [[nodiscard]] std::size_t nearest() const noexcept {
    std::size_t best = 0;
    for (std::size_t k = 1; k < count; ++k) best = squares[k] < squares[best] ? k : best;
    return best;
  }
  void put(std::size_t at, float square, std::uint32_t number, const BvhBox& box) noexcept {
    squares[at] = square;
    nodes[at].number = number;
    nodes[at].box = box;
  }
};

}  // namespace

double box_clearance(const AssetView& asset, const Vector3& point) noexcept {
  const Bvh& bvh = asset.bvh;
  const std::size_t nodes = bvh.words.size() / bvh_node_words;
  if (nodes == 0) return std::numeric_limits<double>::infinity();
  const std::array<float, 3> place = from_origin(bvh, point);
  OpenNodes open;
  open.put(open.count++, 0, 0, {{}, bvh.size});
  float least = std::numeric_limits<float>::infinity();
  NodeBoxes boxes;
  for (int opened = 0; opened < max_clearance_nodes && open.count > 0; ++opened) {
    // The nearest node is opened; the remaining ones then bound everything.
    const std::size_t at = open.nearest();
    if (open.squares[at] >= least) break;
    const std::uint32_t* node =
        bvh.words.data() + std::size_t{open.nodes[at].number} * bvh_node_words;
    find_node_boxes(open.nodes[at].box, node, place, boxes);
    const std::size_t last = --open.count;
    if (at != last) open.put(at, open.squares[last], open.nodes[last].number, open.nodes[last].box);
    for (std::size_t k = 0; k < bvh_children; ++k) {
      const BvhChild child = unpack_child(node[k]);
      if (child.kind == ElementKind::none) continue;
      if (child.kind == ElementKind::node && child.first < nodes) {
        open.put(open.count++, boxes.squares[k], child.first, boxes.box(k));
      } else {
        least = std::min(least, boxes.squares[k]);
      }
    }
  }
  for (std::size_t k = 0; k < open.count; ++k) least = std::min(least, open.squares[k]);
  if (!(least >= 0)) return 0;
  const double distance = std::sqrt(static_cast<double>(least));
  const float size = std::max({bvh.size[0], bvh.size[1], bvh.size[2]});
  return std::max(0.0, distance - rounding_share * (distance + static_cast<double>(size)));
}

double surface_clearance(const AssetView& asset, const Vector3& point) noexcept {
  if (!point.allFinite()) return 0;
  // For a query as if from inside, nothing is too far away to be found. A result beyond the band
  // may be a quarter farther away than the nearest.
  const IndexList list = list_at(asset.index, point);
  const double found = list.numbers != nullptr
                           ? listed_nearest(asset, list, point).distance
                           : read_elements(asset, point, CubeKind::inside).nearest.distance;
  return std::max(0.0, 0.8 * found - asset.tolerance);
}

}  // namespace spm
