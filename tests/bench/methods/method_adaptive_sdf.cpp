// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "common/base/units.hpp"
#include "tests/bench/geometry/cube_tree.hpp"
#include "tests/bench/geometry/grid_number.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"

namespace spm::bench {
namespace {

/// Larger cubes are split without a test, as all tried places in one might miss the band.
constexpr double largest_leaf = 0.004;  // m
/// The largest spacing of the places tried in a cube.
constexpr double largest_step = 0.001;  // m
/// Cubes much smaller than the allowed error bring no gain.
constexpr double smallest_leaf = 0.5;  // tolerances
/// More leaves would be a gigabyte.
constexpr std::size_t max_leaves = 30'000'000;

struct Look {
  std::optional<std::uint32_t> marker;  ///< of a cube beyond the band
  bool is_leaf = false;
  CubeCorners corners{};
};

/// Corner `index` of a cube of edge 1.
Vector3 unit_corner(std::uint32_t index) { return grid_vector(grid_place({2, 2, 2}, index)); }

CubePlace floats_of(const Vector3& place) {
  return {static_cast<float>(place.x()), static_cast<float>(place.y()),
          static_cast<float>(place.z())};
}

/// True if the trilinear function of a cube's corners is within the tolerance at the places in the
/// band of a lattice in the cube, with `steps` steps per side.
bool holds(const Model& model, double tolerance, const TreeCube& cube, const CubeCorners& corners,
           int steps) {
  const GridCounts tried{steps + 1, steps + 1, steps + 1};
  for (std::size_t i = 0; i < grid_size(tried); ++i) {
    const Vector3 place = grid_vector(grid_place(tried, i)) / steps;
    const double truth = model.caster.closest(cube.low + cube.edge * place).distance;
    if (truth < -model.band.max_depth || truth > model.band.margin) continue;
    if (std::abs(trilinear(corners, floats_of(place)).distance - truth) > tolerance) return false;
  }
  return true;
}

Look look(const Model& model, const CubeTree& tree, double tolerance, const TreeCube& cube) {
  Look result;
  result.marker = tree.marker_of(cube, model.caster.closest(cube.middle()).distance);
  if (result.marker || cube.edge > largest_leaf) return result;
  for (std::uint32_t i = 0; i < 8; ++i) {
    const Vector3 corner = cube.low + cube.edge * unit_corner(i);
    result.corners[i] = static_cast<float>(model.caster.closest(corner).distance);
  }
  result.is_leaf = true;
  if (cube.edge <= smallest_leaf * tolerance) return result;
  // Like Frisken et al., test the middles of edges, faces and cube; then finer in large cubes.
  for (int steps = 2; result.is_leaf; steps *= 2) {
    result.is_leaf = holds(model, tolerance, cube, result.corners, steps);
    if (cube.edge <= steps * largest_step) break;
  }
  return result;
}

class AdaptiveSdf : public Method {
 public:
  AdaptiveSdf(const Model& model, double tolerance)
      : tree_(model.mesh.box_min, model.mesh.box_max, model.band) {
    const Clock::time_point start = Clock::now();
    build(model, tolerance);
    tree_.fill_start(largest_leaf);
    facts_.name = "adaptive-sdf";
    facts_.settings = "tolerance " + format_quantity(tolerance, Quantity::length);
    facts_.setting = facts_.tolerance = tolerance;
    const std::uint64_t leaves = leaves_.size() * sizeof(leaves_[0]);
    facts_.file_bytes = tree_.file_bytes() + leaves;
    facts_.resident_bytes = tree_.resident_bytes() + leaves;
    facts_.build_seconds = seconds_since(start);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    return tree_.answer(point, [this](std::uint32_t leaf, const CubePlace& place) {
      return trilinear(leaves_[leaf], place);
    });
  }

 private:
  CubeTree tree_;
  std::vector<CubeCorners> leaves_;

  /// One level at a time: cubes are judged in parallel and enter the tree in their order.
  void build(const Model& model, double tolerance) {
    std::vector<TreeCube> level{tree_.root()};
    while (!level.empty()) {
      std::vector<Look> looks(level.size());
      tbb::parallel_for(std::size_t{0}, level.size(),
                        [&](std::size_t i) { looks[i] = look(model, tree_, tolerance, level[i]); });
      std::vector<TreeCube> next;
      for (std::size_t i = 0; i < level.size(); ++i) enter(level[i], looks[i], next);
      if (leaves_.size() + next.size() > max_leaves) {
        throw baker::BakeError(ExitCode::invalid_input,
                               "an adaptive field for " +
                                   format_quantity(tolerance, Quantity::length) +
                                   " would hold more than a gigabyte");
      }
      level = std::move(next);
    }
  }

  void enter(const TreeCube& cube, const Look& look, std::vector<TreeCube>& next) {
    if (look.marker) {
      tree_.set(cube, *look.marker);
    } else if (look.is_leaf) {
      tree_.set(cube, static_cast<std::uint32_t>(leaves_.size()) | CubeTree::leaf_bit);
      leaves_.push_back(look.corners);
    } else {
      const std::array<TreeCube, 8> octants = tree_.split(cube);
      next.insert(next.end(), octants.begin(), octants.end());
    }
  }
};

}  // namespace

std::unique_ptr<Method> make_adaptive_sdf(const Model& model, double tolerance) {
  return std::make_unique<AdaptiveSdf>(model, tolerance);
}

}  // namespace spm::bench
