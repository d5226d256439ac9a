// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trees/bvh_build.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "baker/base/bake_error.hpp"
#include "common/asset/bvh.hpp"

namespace spm::baker {

namespace {

/// Boxes are widened by this share of the whole box, so that rounding to floats loses nothing.
constexpr double slack_share = 1e-6;
/// How many nodes of the file one visit by every query is worth. So to open few boxes comes before
/// few bytes near the root only.
constexpr double area_weight = 4;
/// After this many halvings, the middle one of the elements divides them, so that the tree ends.
constexpr int surface_levels = 32;

double half_area(const Box& box) {
  const Vector3 size = (box.high - box.low).cwiseMax(0.0);
  return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
}

Box joined(Box a, const Box& b) {
  a.include(b.low);
  a.include(b.high);
  return a;
}

/// A binary node: elements [first, first + count) of the order, or two children.
struct Half {
  Box box;
  std::uint32_t first = 0, count = 0;
  std::uint32_t left = 0, right = 0;  ///< 0: a leaf
  /// Costs as at most 1, 2, 3 or 4 nodes of the file: the number of nodes below, and the share of
  /// visits.
  std::array<double, bvh_children> cost{};
};

class BvhBuilder {
 public:
  explicit BvhBuilder(const std::vector<BvhElement>& elements)
      : elements_(elements), order_(elements.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    if (elements.empty()) return;
    for (const BvhElement& element : elements) all_ = joined(all_, element.box);
    halve(0, static_cast<std::uint32_t>(elements.size()), 0);
  }

  BuiltBvh build() {
    BuiltBvh bvh;
    if (elements_.empty()) return bvh;
    number_elements(bvh);
    const double slack = slack_share * (all_.high - all_.low).maxCoeff();
    slack_ = slack;
    bvh.data.origin = all_.low - Vector3::Constant(2 * slack);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int k = static_cast<int>(axis);
      bvh.data.size[axis] = static_cast<float>(all_.high[k] - all_.low[k] + 4 * slack);
    }
    write(bvh, {{}, bvh.data.size}, 0);
    return bvh;
  }

 private:
  const std::vector<BvhElement>& elements_;
  std::vector<std::uint32_t> order_;
  Box all_;
  std::vector<Half> halves_;
  std::vector<std::uint32_t> place_;  ///< new number of each tile, or of a fan's first corner
  double slack_ = 0;

  /// Sorts a range along an axis, by the middles of the boxes.
  void sort(std::uint32_t first, std::uint32_t count, int axis) {
    std::sort(order_.begin() + first, order_.begin() + first + count,
              [&](std::uint32_t a, std::uint32_t b) {
                const double x = elements_[a].box.low[axis] + elements_[a].box.high[axis];
                const double y = elements_[b].box.low[axis] + elements_[b].box.high[axis];
                return x != y ? x < y : a < b;
              });
  }

  /// The number of elements before the best cut of a sorted range, and the cost of that cut.
  [[nodiscard]] std::pair<std::uint32_t, double> best_cut(std::uint32_t first,
                                                          std::uint32_t count) const {
    std::vector<double> behind(count);
    Box box;
    for (std::uint32_t i = count; i-- > 1;) {
      box = joined(box, elements_[order_[first + i]].box);
      behind[i] = half_area(box) * (count - i);
    }
    box = {};
    std::pair<std::uint32_t, double> best{count / 2, std::numeric_limits<double>::infinity()};
    for (std::uint32_t i = 1; i < count; ++i) {
      box = joined(box, elements_[order_[first + i - 1]].box);
      const double cost = half_area(box) * i + behind[i];
      if (cost < best.second) best = {i, cost};
    }
    return best;
  }

  std::uint32_t halve(std::uint32_t first, std::uint32_t count, int level) {
    const auto number = static_cast<std::uint32_t>(halves_.size());
    halves_.emplace_back();
    Half half{.box = {}, .first = first, .count = count};
    for (std::uint32_t i = first; i < first + count; ++i) {
      half.box = joined(half.box, elements_[order_[i]].box);
    }
    if (count > 1) {
      int axis = 0;
      std::uint32_t cut = count / 2;
      if (level < surface_levels) {
        double least = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k) {
          sort(first, count, k);
          const auto [before, cost] = best_cut(first, count);
          if (cost < least) {
            least = cost;
            cut = before;
            axis = k;
          }
        }
      } else {
        (half.box.high - half.box.low).maxCoeff(&axis);
      }
      sort(first, count, axis);
      half.left = halve(first, cut, level + 1);
      half.right = halve(first + cut, count - cut, level + 1);
    }
    add_costs(half);
    halves_[number] = half;
    return number;
  }

  /// Numbers tiles and the corners of fans in the order of the leaves; those of caps come last.
  void number_elements(BuiltBvh& bvh) {
    place_.resize(elements_.size());
    std::uint64_t corners = 0;
    for (const bool caps : {false, true}) {
      if (caps) bvh.first_cap = static_cast<std::uint32_t>(corners);
      for (const std::uint32_t i : order_) {
        const BvhElement& element = elements_[i];
        if (element.cap != caps) continue;
        if (element.triangles == 0) {
          place_[i] = static_cast<std::uint32_t>(bvh.tiles.size());
          bvh.tiles.push_back(element.number);
          continue;
        }
        place_[i] = static_cast<std::uint32_t>(corners);
        bvh.fans.push_back(element.number);
        corners += element.triangles + 2;
      }
    }
    if (bvh.tiles.size() >= max_bvh_elements || corners >= max_bvh_elements) {
      throw BakeError(ExitCode::invalid_input,
                      "the surface needs more than 16 million tiles or corners of triangles; "
                      "simplify the mesh, or ask for a coarser --tolerance");
    }
  }

  /// Up to four nodes below one: the choice that leaves fewest nodes in the file, and among equal
  /// ones that with the smallest boxes.
  [[nodiscard]] std::vector<std::uint32_t> children_of(std::uint32_t number) const {
    std::vector<std::uint32_t> children;
    open(number, bvh_children, children);
    return children;
  }

  /// Appends the best nodes, at most `most`, for what lies below a half. It opens the half if it
  /// can.
  void open(std::uint32_t number, std::size_t most, std::vector<std::uint32_t>& children) const {
    const Half& half = halves_[number];
    if (half.left == 0) {
      children.push_back(number);
      return;
    }
    const std::size_t left = best_share(half, most).first;
    for (const auto& [side, share] : {std::pair(half.left, left), {half.right, most - left}}) {
      if (halves_[side].left == 0 || closed(side, share)) {
        children.push_back(side);
      } else {
        open(side, share, children);
      }
    }
  }

  /// Cost of a half as up to so many nodes: as one node, or opened.
  [[nodiscard]] bool closed(std::uint32_t number, std::size_t most) const {
    return most == 1 || halves_[number].cost[0] <= best_share(halves_[number], most).second;
  }

  /// How many of `most` nodes the left half gets in the best case, and what that costs.
  [[nodiscard]] std::pair<std::size_t, double> best_share(const Half& half,
                                                          std::size_t most) const {
    std::pair<std::size_t, double> best{1, std::numeric_limits<double>::infinity()};
    for (std::size_t left = 1; left < most; ++left) {
      const double cost =
          halves_[half.left].cost[left - 1] + halves_[half.right].cost[most - left - 1];
      if (cost < best.second) best = {left, cost};
    }
    return best;
  }

  /// Costs of a half, from the known costs of its own halves.
  void add_costs(Half& half) const {
    if (half.left == 0) return;
    const double area = half_area(half.box) / std::max(half_area(all_), 1e-300);
    half.cost[0] = best_share(half, bvh_children).second + 1 + area_weight * area;
    for (std::size_t most = 2; most <= bvh_children; ++most) {
      half.cost[most - 1] = std::min(half.cost[0], best_share(half, most).second);
    }
  }

  /// A side of a child's box in 255ths of its parent's box, rounded outwards as queries will see
  /// it.
  [[nodiscard]] static std::uint32_t steps(float low, float high, double side, bool down) {
    const float step = (high - low) * (1.0F / 255);
    const auto at = [&](int i) { return static_cast<double>(low + static_cast<float>(i) * step); };
    int i = step > 0 ? std::clamp(static_cast<int>((side - static_cast<double>(low)) /
                                                   static_cast<double>(step)),
                                  0, 255)
                     : (down ? 0 : 255);
    if (down) {
      while (i > 0 && at(i) > side) --i;
    } else {
      while (i < 255 && at(i) < side) ++i;
    }
    return static_cast<std::uint32_t>(i);
  }

  std::uint32_t write(BuiltBvh& bvh, const BvhBox& box, std::uint32_t number) {
    std::vector<std::uint32_t>& words = bvh.data.words;
    const auto node = static_cast<std::uint32_t>(words.size() / bvh_node_words);
    if (node >= max_bvh_elements) {
      throw BakeError(ExitCode::invalid_input,
                      "the surface needs more than 16 million boxes; "
                      "simplify the mesh, or ask for a coarser "
                      "--tolerance");
    }
    words.resize(words.size() + bvh_node_words, 0);
    const std::size_t first = std::size_t{node} * bvh_node_words;
    const std::vector<std::uint32_t> children = children_of(number);
    for (std::size_t k = 0; k < children.size(); ++k) {
      const Half& child = halves_[children[k]];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int i = static_cast<int>(axis);
        const double low = child.box.low[i] - slack_ - bvh.data.origin[i];
        const double high = child.box.high[i] + slack_ - bvh.data.origin[i];
        words[first + 4 + 2 * axis] |= steps(box.low[axis], box.high[axis], low, true) << (8 * k);
        words[first + 5 + 2 * axis] |= steps(box.low[axis], box.high[axis], high, false) << (8 * k);
      }
    }
    for (std::size_t k = 0; k < children.size(); ++k) {
      words[first + k] = pack_child(child_of(bvh, box, first, children[k], k));
    }
    return node;
  }

  BvhChild child_of(BuiltBvh& bvh, const BvhBox& box, std::size_t first, std::uint32_t number,
                    std::size_t k) {
    const Half& half = halves_[number];
    if (half.left == 0) {
      const std::uint32_t which = order_[half.first];
      const std::uint32_t triangles = elements_[which].triangles;
      if (triangles == 0) return {ElementKind::tile, place_[which], 1};
      return {ElementKind::fan, place_[which], triangles};
    }
    const BvhBox inner = child_box(box, bvh.data.words.data() + first, k);
    return {ElementKind::node, write(bvh, inner, number), 1};
  }
};

}  // namespace

BuiltBvh build_bvh(const std::vector<BvhElement>& elements) { return BvhBuilder(elements).build(); }

}  // namespace spm::baker
