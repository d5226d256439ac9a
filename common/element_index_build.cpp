// SPDX-License-Identifier: Apache-2.0
#include "common/element_index_build.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "common/closest_element.hpp"
#include "common/cube_reach.hpp"
#include "common/element_units.hpp"
#include "common/unit_groups_build.hpp"

namespace spm {

namespace {

/// Cubes of the grid along the longest side of the band's box.
constexpr double cells_along = 16;
/// A cube whose list names no more groups is not split.
constexpr std::size_t few_groups = 4;
/// A cube is not split that is smaller than so many times what is usual for a block, or a
/// triangle where there are no tiles.
constexpr double least_share = 0.8;

/// How much farther than the nearest a unit may be and matter, tolerances: where claims tell the
/// side, and where a foot is only sought that faces the point.
constexpr double claim_slack = 2;
constexpr double facing_slack = 0.75;

/// Normals within this cosine of each other look one way.
constexpr double one_sheet_cosine = 0.7;

/// Elements that may be looked at for all, and more for each: where they all lie in each other's
/// way an index is of no use, and takes minutes.
constexpr std::size_t most_visits = 2000000;
constexpr std::size_t most_visits_each = 600;

/// Rounding of groups' bounds, of the longest side of all.
constexpr double rounding_share = 1e-6;

class Builder {
 public:
  explicit Builder(const AssetView& asset) : asset_(asset) { asset_.index = {}; }

  ElementIndexData build() {
    if (asset_.full || asset_.tree.words.empty()) return {};
    gather_units();
    if (units_.empty()) return {};
    const Extent extent = extent_of(asset_);
    data_.origin = extent.low;
    data_.cell_size = extent.size.maxCoeff() / cells_along;
    std::size_t count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double cells = extent.size[static_cast<int>(axis)] / data_.cell_size;
      data_.cells[axis] = static_cast<std::uint32_t>(std::max(1.0, std::ceil(cells - 1e-9)));
      count *= data_.cells[axis];
    }
    data_.words.resize(count);
    fill({0, 0, 0}, data_.cells, all());
    return std::move(data_);
  }

 private:
  using Numbers = std::vector<std::uint32_t>;
  AssetView asset_;
  ElementIndexData data_;
  std::vector<ElementUnit> units_;
  std::size_t first_triangle_ = 0;
  std::map<Numbers, std::uint32_t> lists_;
  double least_edge_ = 0;
  std::size_t visits_ = 0;

  /// Units that lie near each other follow each other, tiles' blocks first.
  void gather_units() {
    const std::size_t nodes = asset_.tree.words.size() / tree_node_words;
    std::vector<ElementUnit> blocks, triangles;
    for (std::size_t node = 0; node < nodes; ++node) {
      for (std::size_t child = 0; child < tree_children; ++child) {
        const std::uint32_t word = asset_.tree.words[node * tree_node_words + child];
        for (ElementUnit& unit : units_of(asset_, unpack_child(word))) {
          const bool is_triangle = (unit.name.part & index_triangle) != 0;
          (is_triangle ? triangles : blocks).push_back(std::move(unit));
        }
      }
    }
    find_least_edge(blocks.empty() ? triangles : blocks);
    order_by_place(blocks);
    order_by_place(triangles);
    data_.boxes = box_groups(asset_, blocks);
    data_.triangles = triangle_groups(asset_, triangles);
    units_ = std::move(blocks);
    first_triangle_ = units_.size();
    units_.insert(units_.end(), std::make_move_iterator(triangles.begin()),
                  std::make_move_iterator(triangles.end()));
    for (const Tile& tile : asset_.tiles) {
      for (std::uint32_t part = 0; part < tile_quarters; ++part) {
        data_.quarters.push_back(
            tile_quarter(tile, asset_.height_unit, asset_.planes[tile.plane], part));
      }
    }
    const std::array<float, 3>& size = asset_.tree.size;
    data_.slack = rounding_share * static_cast<double>(*std::max_element(size.begin(), size.end()));
    // Groups and quarters are complete: the rest is found with them.
    asset_.index = data_.view();
  }

  void find_least_edge(const std::vector<ElementUnit>& units) {
    if (units.empty()) return;
    std::vector<double> widths;
    for (const ElementUnit& unit : units) widths.push_back(2 * unit.box.half.maxCoeff());
    const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
    std::nth_element(widths.begin(), middle, widths.end());
    least_edge_ = least_share * *middle;
  }

  [[nodiscard]] Numbers all() const {
    Numbers numbers(units_.size());
    for (std::uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
    return numbers;
  }

  /// Fills a block of the grid's cubes, halving it along its longest side, so that few units are
  /// looked at for each.
  void fill(const std::array<std::uint32_t, 3>& low, const std::array<std::uint32_t, 3>& size,
            const Numbers& some) {
    const Vector3 edges = data_.cell_size * Vector3(size[0], size[1], size[2]);
    const Vector3 middle =
        data_.origin + data_.cell_size * Vector3(low[0], low[1], low[2]) + edges / 2;
    const std::size_t longest =
        static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
    if (size[longest] == 1) {
      const std::size_t cell =
          (std::size_t{low[2]} * data_.cells[1] + low[1]) * data_.cells[0] + low[0];
      data_.words[cell] = cube(middle, data_.cell_size / 2, some, 0);
      return;
    }
    const double reach = reach_of(middle, edges.maxCoeff() / 2);
    const Numbers near = within(middle, reach, some);
    std::array<std::uint32_t, 3> half = size, upper = low;
    half[longest] = size[longest] / 2;
    fill(low, half, near);
    upper[longest] += half[longest];
    half[longest] = size[longest] - half[longest];
    fill(upper, half, near);
  }

  /// How far from the middle of a cube units lie that can matter to a point of it, at most, m.
  [[nodiscard]] double reach_of(const Vector3& middle, double half) const {
    const double nearest = read_elements(asset_, middle, CubeKind::inside).nearest.distance;
    return nearest + 2 * std::numbers::sqrt3 * half + claim_slack * asset_.tolerance;
  }

  /// Of some units those that can matter in a cube.
  [[nodiscard]] Numbers near_of(const CubeReach& reach, const Numbers& some, double slack) const {
    Numbers near;
    for (const std::uint32_t number : some) {
      if (reach.may_matter(units_[number].box, slack)) near.push_back(number);
    }
    return near;
  }

  /// Of some units, in order, those no farther from a place than a distance (m), and perhaps some
  /// that are a little farther.
  [[nodiscard]] Numbers within(const Vector3& place, double distance, const Numbers& some) const {
    const std::array<float, 3> at = from_origin(asset_.tree, place);
    const double farthest = distance + data_.slack;
    const auto most = static_cast<float>(farthest * farthest * (1 + 1e-6));
    alignas(64) GroupLanes squares{};
    std::optional<std::uint32_t> last;
    Numbers near;
    for (const std::uint32_t number : some) {
      const std::uint32_t group = group_of(number);
      if (group != last) {
        static_cast<void>(
            group_squares(data_.boxes, data_.triangles, {&group, 1}, at, squares.data()));
        last = group;
      }
      if (squares[lane_of(number)] <= most) near.push_back(number);
    }
    return near;
  }

  [[nodiscard]] bool is_one_sheet(const Numbers& near) const {
    for (const std::uint32_t number : near) {
      const ElementUnit& unit = units_[number];
      if (unit.cap || unit.normals.empty()) return false;
      const Vector3& first = units_[near.front()].normals.front();
      for (const Vector3& normal : unit.normals) {
        if (!(normal.dot(first) > one_sheet_cosine)) return false;
      }
    }
    return !near.empty();
  }

  /// What all elements say of a point, which only some units matter to.
  [[nodiscard]] ElementReading reading_at(const Vector3& point, const Numbers& some) const {
    const Numbers groups = groups_of(some);
    if (groups.size() > index_list_groups) return read_elements(asset_, point, CubeKind::told);
    const std::vector<std::uint32_t> packed = packed_list(groups);
    const IndexList list{packed.data() + 1, packed.front(), CubeKind::told};
    return read_elements(asset_, list, point, CubeKind::told);
  }

  /// The word of a cube, whose units are among some.
  std::uint32_t cube(const Vector3& middle, double half, const Numbers& some, int level) {
    if (visits_ > most_visits + most_visits_each * units_.size() ||
        data_.words.size() > index_place) {
      return 0;
    }
    const SpaceKind space = space_at(asset_.space, middle);
    const ElementReading reading = reading_at(middle, some);
    visits_ += reading.visited + some.size() / 4;
    const double diagonal = std::numbers::sqrt3 * half;
    const bool outside = space == SpaceKind::outside || space == SpaceKind::far ||
                         (space == SpaceKind::told && !reading.sides.inside());
    const double end = outside ? asset_.band.margin : asset_.band.max_depth;
    if (!(reading.nearest.distance - diagonal <= end + 2 * asset_.tolerance)) return 0;

    const CubeReach reach(asset_, middle, half, reading.nearest);
    const double slack = claim_slack * asset_.tolerance;
    const Numbers near = near_of(reach, within(middle, reach.farthest(slack), some), slack);
    const CubeKind kind = kind_of(middle, half, reading, space, near);
    const Numbers few = kind == CubeKind::told || kind == CubeKind::unknown
                            ? near
                            : near_of(reach, near, facing_slack * asset_.tolerance);
    const Numbers groups = groups_of(few);
    if (level < index_levels && groups.size() > few_groups &&
        (2 * half >= least_edge_ || groups.size() > index_list_groups)) {
      return split(middle, half, near, level);
    }
    if (few.empty() || groups.size() > index_list_groups) return 0;
    return list(groups) | static_cast<std::uint32_t>(kind) << 28U;
  }

  std::uint32_t split(const Vector3& middle, double half, const Numbers& near, int level) {
    std::array<std::uint32_t, 8> words{};
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      Vector3 at = middle;
      for (int axis = 0; axis < 3; ++axis) {
        at[axis] += ((octant >> static_cast<unsigned>(axis)) & 1U) != 0 ? half / 2 : -half / 2;
      }
      words[octant] = cube(at, half / 2, near, level + 1);
    }
    if (std::all_of(words.begin(), words.end(),
                    [&](std::uint32_t word) { return word == words[0]; })) {
      return words[0];
    }
    const std::size_t first = data_.words.size();
    data_.words.insert(data_.words.end(), words.begin(), words.end());
    return index_split | static_cast<std::uint32_t>(first);
  }

  /// What a whole cube is. Clear of all that is near, the side of its middle is that of all; caps
  /// part the sides too, and carry no distance.
  [[nodiscard]] CubeKind kind_of(const Vector3& middle, double half, const ElementReading& reading,
                                 SpaceKind space, const Numbers& near) const {
    const unsigned whole = spaces_of_cube(asset_.space, middle, half);
    if ((whole & space_bit(SpaceKind::pruned)) != 0) return CubeKind::unknown;
    if (whole == space_bit(SpaceKind::inside)) return CubeKind::inside;
    if (whole == space_bit(SpaceKind::outside)) return CubeKind::outside;
    const bool inside =
        space == SpaceKind::told ? reading.sides.inside() : space == SpaceKind::inside;
    const bool known =
        space == SpaceKind::told || space == SpaceKind::inside || space == SpaceKind::outside;
    double clear = reading.nearest.distance;
    for (const std::uint32_t number : near) {
      const ElementUnit& unit = units_[number];
      if (unit.cap) clear = std::min(clear, (unit.box.closest(middle) - middle).norm());
    }
    if (known && clear > std::numbers::sqrt3 * half + 2 * asset_.tolerance) {
      return inside ? CubeKind::inside : CubeKind::outside;
    }
    // What is far lies beyond the margin of the nearest too.
    if (is_one_sheet(near)) return CubeKind::one_sheet;
    return whole == space_bit(SpaceKind::told) ? CubeKind::told : CubeKind::unknown;
  }

  std::uint32_t list(const Numbers& numbers) {
    const auto [place, is_new] =
        lists_.try_emplace(numbers, static_cast<std::uint32_t>(data_.words.size()));
    if (!is_new) return place->second;
    const std::vector<std::uint32_t> packed = packed_list(numbers);
    data_.words.insert(data_.words.end(), packed.begin(), packed.end());
    return place->second;
  }

  [[nodiscard]] std::uint32_t group_of(std::uint32_t unit) const {
    const std::size_t group = unit < first_triangle_
                                  ? unit / group_units
                                  : data_.boxes.size() + (unit - first_triangle_) / group_units;
    return static_cast<std::uint32_t>(group);
  }
  [[nodiscard]] std::size_t lane_of(std::uint32_t unit) const {
    return (unit < first_triangle_ ? unit : unit - first_triangle_) % group_units;
  }

  /// The groups that units are of, which are in order.
  [[nodiscard]] Numbers groups_of(const Numbers& units) const {
    Numbers groups;
    for (const std::uint32_t unit : units) {
      const std::uint32_t group = group_of(unit);
      if (groups.empty() || groups.back() != group) groups.push_back(group);
    }
    return groups;
  }

  /// A list as the index keeps it.
  [[nodiscard]] std::vector<std::uint32_t> packed_list(const Numbers& numbers) const {
    std::vector<std::uint32_t> packed{static_cast<std::uint32_t>(numbers.size())};
    const bool small = data_.boxes.size() + data_.triangles.size() <= small_groups;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (small && (i & 1U) != 0) {
        packed.back() |= numbers[i] << 16U;
      } else {
        packed.push_back(numbers[i]);
      }
    }
    return packed;
  }
};

}  // namespace

ElementIndexData build_element_index(const AssetView& asset) { return Builder(asset).build(); }

}  // namespace spm
