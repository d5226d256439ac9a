// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "common/base/units.hpp"
#include "tests/bench/geometry/grid_number.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"

namespace spm::bench {
namespace {

// The word of a cube is a marker, a leaf's number, or the first of its octants' eight words.
constexpr std::uint32_t far_word = 0xFFFFFFFFU;
constexpr std::uint32_t deep_word = 0xFFFFFFFEU;
constexpr std::uint32_t leaf_bit = 1U << 31U;

/// Larger cubes are split without a test, as all tried places in one might miss the band.
constexpr double largest_leaf = 0.004;  // m
/// The largest spacing of the places tried in a cube.
constexpr double largest_step = 0.001;  // m
/// Cubes much smaller than the allowed error bring no gain.
constexpr double smallest_leaf = 0.5;  // tolerances

struct Cube {
  Vector3 low = Vector3::Zero();
  double edge = 0;
  std::uint32_t word = 0;  ///< its place in the tree
};

enum class Verdict { far, deep, leaf, split };

struct Look {
  Verdict verdict = Verdict::far;
  std::array<float, 8> corners{};
};

/// Corner `index` of a cube of edge 1.
Vector3 unit_corner(std::uint32_t index) { return grid_vector(grid_place({2, 2, 2}, index)); }

/// True if the trilinear function of a cube's corners is within the tolerance at the places in the
/// band of a lattice in the cube, with `steps` steps per side.
bool holds(const Model& model, double tolerance, const Cube& cube, const CubeCorners& corners,
           int steps) {
  const GridCounts tried{steps + 1, steps + 1, steps + 1};
  for (std::size_t i = 0; i < grid_size(tried); ++i) {
    const Vector3 place = grid_vector(grid_place(tried, i)) / steps;
    const double truth = model.caster.closest(cube.low + cube.edge * place).distance;
    if (truth < -model.band.max_depth || truth > model.band.margin) continue;
    if (std::abs(trilinear(corners, place).distance - truth) > tolerance) return false;
  }
  return true;
}

Look look(const Model& model, double tolerance, const Cube& cube) {
  Look result;
  const double reach = std::numbers::sqrt3 / 2 * cube.edge;
  const Vector3 middle = cube.low + Vector3::Constant(cube.edge / 2);
  const double at_middle = model.caster.closest(middle).distance;
  result.verdict = at_middle < 0 ? Verdict::deep : Verdict::far;
  if (at_middle - reach > model.band.margin || at_middle + reach < -model.band.max_depth) {
    return result;
  }
  result.verdict = Verdict::split;
  if (cube.edge > largest_leaf) return result;
  CubeCorners corners{};
  for (std::uint32_t i = 0; i < 8; ++i) {
    const Vector3 corner = cube.low + cube.edge * unit_corner(i);
    result.corners[i] = static_cast<float>(model.caster.closest(corner).distance);
    corners[i] = result.corners[i];
  }
  result.verdict = Verdict::leaf;
  if (cube.edge <= smallest_leaf * tolerance) return result;
  // Like Frisken et al., test the middles of edges, faces and cube; then finer in large cubes.
  for (int steps = 2; result.verdict == Verdict::leaf; steps *= 2) {
    if (!holds(model, tolerance, cube, corners, steps)) result.verdict = Verdict::split;
    if (cube.edge <= steps * largest_step) break;
  }
  return result;
}

class AdaptiveSdf : public Method {
 public:
  AdaptiveSdf(const Model& model, double tolerance) : band_(model.band) {
    const Clock::time_point start = Clock::now();
    build(model, tolerance);
    facts_.name = "adaptive-sdf";
    facts_.settings = "tolerance " + format_quantity(tolerance, Quantity::length);
    facts_.setting = tolerance;
    facts_.bytes = words_.size() * sizeof(words_[0]) + leaves_.size() * sizeof(leaves_[0]);
    facts_.build_seconds = seconds_since(start);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    Vector3 place = (point - root_.low) / root_.edge;
    if (!(place.minCoeff() >= 0 && place.maxCoeff() < 1)) return far_answer();
    std::uint32_t word = words_[0];
    while (true) {
      if (word == far_word) return far_answer();
      if (word == deep_word) return deep_answer(band_.max_depth);
      if ((word & leaf_bit) != 0) break;
      std::uint32_t octant = 0;
      for (int axis = 0; axis < 3; ++axis) {
        place[axis] *= 2;
        if (place[axis] < 1) continue;
        place[axis] -= 1;
        octant |= 1U << static_cast<unsigned>(axis);
      }
      word = words_[word + octant];
    }
    CubeCorners corners{};
    const std::array<float, 8>& leaf = leaves_[word & ~leaf_bit];
    std::copy(leaf.begin(), leaf.end(), corners.begin());
    return trilinear(corners, place);
  }

 private:
  /// One level at a time: cubes are judged in parallel and enter the tree in their order.
  void build(const Model& model, double tolerance) {
    root_.low = model.mesh.box_min - Vector3::Constant(model.band.margin);
    root_.edge = (model.mesh.box_max - model.mesh.box_min).maxCoeff() + 2 * model.band.margin;
    words_ = {far_word};
    std::vector<Cube> level{root_};
    while (!level.empty()) {
      std::vector<Look> looks(level.size());
      tbb::parallel_for(std::size_t{0}, level.size(),
                        [&](std::size_t i) { looks[i] = look(model, tolerance, level[i]); });
      std::vector<Cube> next;
      for (std::size_t i = 0; i < level.size(); ++i) enter(level[i], looks[i], next);
      level = std::move(next);
    }
  }

  void enter(const Cube& cube, const Look& look, std::vector<Cube>& next) {
    std::uint32_t word = look.verdict == Verdict::deep ? deep_word : far_word;
    if (look.verdict == Verdict::leaf) {
      word = static_cast<std::uint32_t>(leaves_.size()) | leaf_bit;
      leaves_.push_back(look.corners);
    } else if (look.verdict == Verdict::split) {
      word = static_cast<std::uint32_t>(words_.size());
      for (std::uint32_t octant = 0; octant < 8; ++octant) {
        const Vector3 low = cube.low + cube.edge / 2 * unit_corner(octant);
        next.push_back({low, cube.edge / 2, word + octant});
        words_.push_back(far_word);
      }
    }
    words_[cube.word] = word;
  }

  Cube root_;
  Band band_;
  std::vector<std::uint32_t> words_;
  std::vector<std::array<float, 8>> leaves_;
};

}  // namespace

std::unique_ptr<Method> make_adaptive_sdf(const Model& model, double tolerance) {
  return std::make_unique<AdaptiveSdf>(model, tolerance);
}

}  // namespace spm::bench
