// SPDX-License-Identifier: Apache-2.0
#include "common/element_index_build.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "common/closest_element.hpp"
#include "common/query.hpp"

namespace spm {

namespace {

/// Cubes of the grid along the longest side of the band's box.
constexpr double cells_along = 8;
/// A cube whose list is no longer is not split.
constexpr std::size_t few_elements = 8;
/// Halvings of a cube of the grid at most, and so many elements for the first; finer cubes than an
/// element is large cost more memory than they save time.
constexpr int most_halvings = 3;
constexpr double elements_for_halving = 80;

/// Elements lie along a surface: four times as many are half as large.
int halvings_for(std::size_t elements) {
  const double wanted = std::log2(static_cast<double>(elements) / elements_for_halving) / 2;
  return std::clamp(static_cast<int>(std::lround(wanted)), 1, most_halvings);
}

/// A cube is split again where the last time left it less than this share of the elements.
constexpr double worthwhile_share = 0.8;
/// An element that is so much nearer to a cube than another, m in single precision, may matter.
constexpr double rounding_share = 1e-5;  // of the cube's edge

/// Elements that may be looked at for all, and more for each: where they all lie in each other's
/// way an index is of no use, and takes minutes.
constexpr std::size_t most_visits = 1000000;
constexpr std::size_t most_visits_each = 100;

/// An oriented box, in doubles and the asset's frame.
struct Box {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< a row each
  Vector3 middle = Vector3::Zero();
  Vector3 half = Vector3::Zero();

  /// The point of the box that is closest to another.
  [[nodiscard]] Vector3 closest(const Vector3& point) const {
    const Vector3 at = axes * (point - middle);
    return middle + axes.transpose() * at.cwiseMax(-half).cwiseMin(half);
  }
};

/// The box around places along axes.
Box box_around(const std::vector<Vector3>& places, const Eigen::Matrix3d& axes) {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vector3& place : places) {
    low = low.cwiseMin(axes * place);
    high = high.cwiseMax(axes * place);
  }
  return {axes, axes.transpose() * ((low + high) / 2), (high - low) / 2};
}

/// Axes of which the last is along a normal.
Eigen::Matrix3d axes_along(const Vector3& normal, const Vector3& side) {
  Eigen::Matrix3d axes;
  const Vector3 u = (side - side.dot(normal) * normal).normalized();
  axes << u.transpose(), normal.cross(u).transpose(), normal.transpose();
  return axes;
}

/// The surface about a point: where it is nearest.
struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  Vector3 foot = Vector3::Zero();
};

class Builder {
 public:
  explicit Builder(const AssetView& asset) : asset_(asset) {}

  ElementIndexData build() {
    if (asset_.full || asset_.tree.words.empty()) return {};
    gather_elements();
    halvings_ = halvings_for(boxes_.size());
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
    const double half = data_.cell_size / 2;
    for (std::size_t cell = 0; cell < count; ++cell) {
      const std::size_t row = cell / data_.cells[0];
      const std::size_t sheet = row / data_.cells[1];
      const Vector3 place(static_cast<double>(cell % data_.cells[0]),
                          static_cast<double>(row % data_.cells[1]), static_cast<double>(sheet));
      const Vector3 middle = data_.origin + data_.cell_size * place + Vector3::Constant(half);
      data_.words[cell] = cube(middle, half, nullptr, 0);
    }
    return std::move(data_);
  }

 private:
  const AssetView& asset_;
  ElementIndexData data_;
  std::vector<Box> boxes_;
  std::vector<Box> caps_;
  std::size_t visits_ = 0;
  int halvings_ = 1;

  void gather_elements() {
    const std::size_t nodes = asset_.tree.words.size() / tree_node_words;
    for (std::size_t node = 0; node < nodes; ++node) {
      for (std::size_t child = 0; child < tree_children; ++child) {
        const std::uint32_t word = asset_.tree.words[node * tree_node_words + child];
        const TreeChild element = unpack_child(word);
        if (element.kind == ElementKind::tile && element.first < asset_.tiles.size()) {
          add_element(word, tile_box(asset_.tiles[element.first]));
        } else if (element.kind == ElementKind::fan) {
          const Box box = fan_box(element);
          if (element.first >= asset_.first_cap) caps_.push_back(box);
          add_element(word, box);
        }
      }
    }
    for (const Tile& tile : asset_.tiles) {
      data_.blocks.push_back(block_planes(tile, asset_.height_unit));
    }
  }

  void add_element(std::uint32_t word, const Box& box) {
    data_.elements.push_back(word);
    boxes_.push_back(box);
    const Vector3 offset = box.axes * (asset_.tree.origin - box.middle);
    const auto lanes = [](const Vector3& v) {
      return FourLanes{static_cast<float>(v.x()), static_cast<float>(v.y()),
                       static_cast<float>(v.z()), 0};
    };
    // Rounding must not turn a bound into a hope.
    const double slack = 1e-6 * (offset.cwiseAbs().maxCoeff() + box.half.maxCoeff());
    data_.boxes.push_back({lanes(box.axes.col(0)), lanes(box.axes.col(1)), lanes(box.axes.col(2)),
                           lanes(offset), lanes(box.half + Vector3::Constant(slack))});
  }

  /// Around the samples of all cells that are valid.
  [[nodiscard]] Box tile_box(const Tile& tile) const {
    const SupportPlane& plane = asset_.planes[tile.plane];
    TileHeights heights;
    tile_heights(tile, asset_.height_unit, heights);
    const auto spacing = static_cast<double>(tile.spacing);
    std::vector<Vector3> places;
    for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
      if (((tile.valid >> cell) & 1U) == 0) continue;
      for (const auto& [i, j] : {std::pair{0U, 0U}, {1U, 0U}, {0U, 1U}, {1U, 1U}}) {
        const std::uint32_t x = cell % tile_cells + i, y = cell / tile_cells + j;
        places.push_back(
            support_plane_point(plane, tile.eta0 + x * spacing, tile.omega0 + y * spacing) -
            (tile.base + static_cast<double>(heights[y * tile_samples + x])) * plane.n);
      }
    }
    const Vector3 normal = surface_normal(plane, static_cast<double>(tile.slope_eta),
                                          static_cast<double>(tile.slope_omega))
                               .normalized();
    return box_around(places, axes_along(normal, plane.u));
  }

  [[nodiscard]] Box fan_box(const TreeChild& fan) const {
    std::vector<Vector3> places;
    Vector3 across = Vector3::Zero();
    for (std::uint32_t k = 0; k < fan.count + 2; ++k) {
      Vector3 corner;
      if (!stored_corner(asset_, fan.first + k, corner)) break;
      places.push_back(corner);
      if (k >= 2) across += (places[k - 1] - places[0]).cross(corner - places[0]);
    }
    const Vector3 side = places.size() > 1 ? Vector3(places[1] - places[0]) : Vector3::Zero();
    const bool flat = across.norm() > 0 && across.normalized().cross(side).norm() > 0;
    return box_around(places, flat ? axes_along(across.normalized(), side)
                                   : Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  }

  /// True where no answer at a point that is so far from the surface is exact, m.
  [[nodiscard]] bool beyond_band(const Vector3& point, double distance) const {
    const SpaceKind kind = space_at(asset_.space, point);
    bool outside = kind == SpaceKind::outside || kind == SpaceKind::far;
    if (kind == SpaceKind::told) {
      const ElementReading reading = read_elements(asset_, point, kind);
      outside = !reading.sides.inside();
    }
    const double end = outside ? asset_.band.margin : asset_.band.max_depth;
    return distance > end + 2 * asset_.tolerance;
  }

  [[nodiscard]] Nearest nearest_of(const Vector3& point) {
    const ElementReading reading = read_elements(asset_, point, SpaceKind::inside);
    visits_ += reading.visited;
    const ElementFoot& foot = reading.nearest;
    if (foot.tile == nullptr) return {foot.distance, foot.on_triangle};
    const TileFoot& on = foot.on_tile;
    return {foot.distance, point - from_plane_frame(asset_.planes[foot.tile->plane],
                                                    static_cast<double>(on.away_eta),
                                                    static_cast<double>(on.away_omega),
                                                    static_cast<double>(on.away_depth))};
  }

  /// True where no point of a cube can be so near to an element that it matters beside what is
  /// known to be near. The element lies behind the plane through its closest point; so what it is
  /// farther away by is least at a corner of the cube, for the distance to a point is convex.
  [[nodiscard]] bool too_far(const Box& box, const Vector3& middle, double half,
                             const Nearest& nearest) const {
    const Vector3 away = middle - box.closest(middle);
    const double distance = away.norm();
    const double slack = 2 * asset_.tolerance + rounding_share * half;
    if (distance > nearest.distance + 2 * std::numbers::sqrt3 * half + slack) return true;
    if (!(distance > 1e-9)) return false;
    const Vector3 normal = away / distance;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Vector3 step((corner & 1U) != 0 ? half : -half, (corner & 2U) != 0 ? half : -half,
                         (corner & 4U) != 0 ? half : -half);
      const double least = distance + normal.dot(step);
      if (!(least > (middle + step - nearest.foot).norm() + slack)) return false;
    }
    return true;
  }

  /// The word of a cube, whose elements are among some, or any.
  std::uint32_t cube(const Vector3& middle, double half, const std::vector<std::uint32_t>* some,
                     int level) {
    if (visits_ > most_visits + most_visits_each * boxes_.size()) return 0;
    const Nearest nearest = nearest_of(middle);
    if (beyond_band(middle, nearest.distance - std::numbers::sqrt3 * half)) return 0;
    std::vector<std::uint32_t> near;
    const auto count = static_cast<std::uint32_t>(some != nullptr ? some->size() : boxes_.size());
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t number = some != nullptr ? (*some)[i] : i;
      if (!too_far(boxes_[number], middle, half, nearest)) near.push_back(number);
    }
    const bool many = near.size() > index_list_elements;
    const bool fewer = some == nullptr || static_cast<double>(near.size()) <
                                              worthwhile_share * static_cast<double>(some->size());
    if (level < (many ? index_levels : halvings_) && near.size() > few_elements && fewer) {
      const std::size_t first = data_.words.size();
      data_.words.resize(first + 8);
      for (std::uint32_t octant = 0; octant < 8; ++octant) {
        Vector3 at = middle;
        for (int axis = 0; axis < 3; ++axis) {
          at[axis] += ((octant >> axis) & 1U) != 0 ? half / 2 : -half / 2;
        }
        const std::uint32_t word = cube(at, half / 2, &near, level + 1);
        data_.words[first + octant] = word;
      }
      return index_split | static_cast<std::uint32_t>(first);
    }
    if (many) return 0;
    // So that the first to be visited leave little to the others.
    const auto distance = [&](std::uint32_t number) {
      return (middle - boxes_[number].closest(middle)).squaredNorm();
    };
    std::stable_sort(near.begin(), near.end(), [&](std::uint32_t one, std::uint32_t other) {
      return distance(one) < distance(other);
    });
    return list(middle, near);
  }

  /// How far a point is from all that parts inside from outside, m, negative inside; NaN where that
  /// is not known. Caps part them too, and carry no distance.
  [[nodiscard]] double clearance(const Vector3& middle) const {
    const Answer answer = query_point(asset_, middle);
    if (answer.status != Status::exact) return std::numeric_limits<double>::quiet_NaN();
    double least = std::abs(answer.distance);
    for (const Box& cap : caps_) least = std::min(least, (cap.closest(middle) - middle).norm());
    return std::copysign(least, answer.distance);
  }

  std::uint32_t list(const Vector3& middle, const std::vector<std::uint32_t>& near) {
    const std::size_t first = data_.words.size();
    data_.words.push_back(static_cast<std::uint32_t>(near.size()));
    data_.words.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(clearance(middle))));
    const bool small = data_.elements.size() <= small_elements;
    for (std::size_t i = 0; i < near.size(); ++i) {
      if (small && (i & 1U) != 0) {
        data_.words.back() |= near[i] << 16U;
      } else {
        data_.words.push_back(near[i]);
      }
    }
    return static_cast<std::uint32_t>(first);
  }
};

}  // namespace

ElementIndexData build_element_index(const AssetView& asset) { return Builder(asset).build(); }

}  // namespace spm
