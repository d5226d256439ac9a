// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "baker/base/bake_error.hpp"
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
/// More leaves would be a gigabyte.
constexpr std::size_t max_leaves = 30'000'000;

struct Cube {
  Vector3 low = Vector3::Zero();
  double edge = 0;
  std::uint32_t word = 0;  ///< its place in the tree
};

enum class Verdict { far, deep, leaf, split };

struct Look {
  Verdict verdict = Verdict::far;
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
bool holds(const Model& model, double tolerance, const Cube& cube, const CubeCorners& corners,
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
  for (std::uint32_t i = 0; i < 8; ++i) {
    const Vector3 corner = cube.low + cube.edge * unit_corner(i);
    result.corners[i] = static_cast<float>(model.caster.closest(corner).distance);
  }
  result.verdict = Verdict::leaf;
  if (cube.edge <= smallest_leaf * tolerance) return result;
  // Like Frisken et al., test the middles of edges, faces and cube; then finer in large cubes.
  for (int steps = 2; result.verdict == Verdict::leaf; steps *= 2) {
    if (!holds(model, tolerance, cube, result.corners, steps)) result.verdict = Verdict::split;
    if (cube.edge <= steps * largest_step) break;
  }
  return result;
}

class AdaptiveSdf : public Method {
 public:
  AdaptiveSdf(const Model& model, double tolerance) : band_(model.band) {
    const Clock::time_point start = Clock::now();
    build(model, tolerance);
    fill_start();
    facts_.name = "adaptive-sdf";
    facts_.settings = "tolerance " + format_quantity(tolerance, Quantity::length);
    facts_.setting = facts_.tolerance = tolerance;
    facts_.file_bytes = words_.size() * sizeof(words_[0]) + leaves_.size() * sizeof(leaves_[0]);
    facts_.resident_bytes = facts_.file_bytes + start_.size() * sizeof(start_[0]);
    facts_.build_seconds = seconds_since(start);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    const Vector3 scaled = (point - root_.low) * per_root_;
    if (!(scaled.minCoeff() >= 0 && scaled.maxCoeff() < 1)) return far_answer();
    // Bit by bit, from the highest, the coordinates name the octants.
    std::array<std::uint32_t, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[axis] = static_cast<std::uint32_t>(scaled[static_cast<int>(axis)] * (1U << top));
    }
    std::uint32_t shift = top - start_levels_;
    std::uint32_t word = start_[start_number(at[0] >> shift, at[1] >> shift, at[2] >> shift)];
    while (word < leaf_bit) {
      --shift;
      word = words_[word + (at[0] >> shift & 1U) + 2 * (at[1] >> shift & 1U) +
                    4 * (at[2] >> shift & 1U)];
    }
    if (word == far_word) return far_answer();
    if (word == deep_word) return deep_answer(band_.max_depth);
    CubePlace place{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t within = at[axis] & ((1U << shift) - 1);
      place[axis] = static_cast<float>(within) * per_cube[shift];
    }
    return trilinear(leaves_[word & ~leaf_bit], place);
  }

 private:
  /// Cubes larger than any leaf are skipped by a table of all cubes of the next smaller size.
  void fill_start() {
    per_root_ = 1 / root_.edge;
    while (std::ldexp(root_.edge, -static_cast<int>(start_levels_)) > largest_leaf) ++start_levels_;
    const std::uint32_t side = 1U << start_levels_;
    for (std::uint32_t z = 0; z < side; ++z) {
      for (std::uint32_t y = 0; y < side; ++y) {
        for (std::uint32_t x = 0; x < side; ++x) {
          std::uint32_t word = words_[0];
          for (std::uint32_t shift = start_levels_; word < leaf_bit && shift-- > 0;) {
            word = words_[word + (x >> shift & 1U) + 2 * (y >> shift & 1U) + 4 * (z >> shift & 1U)];
          }
          start_.push_back(word);
        }
      }
    }
  }

  [[nodiscard]] std::size_t start_number(std::uint32_t x, std::uint32_t y,
                                         std::uint32_t z) const noexcept {
    return x + ((y + (static_cast<std::size_t>(z) << start_levels_)) << start_levels_);
  }

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
      if (leaves_.size() + next.size() > max_leaves) {
        throw baker::BakeError(ExitCode::invalid_input,
                               "an adaptive field for " +
                                   format_quantity(tolerance, Quantity::length) +
                                   " would hold more than a gigabyte");
      }
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

  static constexpr std::uint32_t top = 30;  ///< bits of a coordinate
  /// 1 over the size of a cube so many levels above the finest.
  static constexpr std::array<float, top + 1> per_cube = [] {
    std::array<float, top + 1> result{};
    for (std::uint32_t i = 0; i <= top; ++i) result[i] = 1 / static_cast<float>(1U << i);
    return result;
  }();

  Cube root_;
  double per_root_ = 0;  ///< 1/m
  Band band_;
  std::uint32_t start_levels_ = 0;
  std::vector<std::uint32_t> start_;  ///< words of all cubes at that level, x fastest
  std::vector<std::uint32_t> words_;
  std::vector<CubeCorners> leaves_;
};

}  // namespace

std::unique_ptr<Method> make_adaptive_sdf(const Model& model, double tolerance) {
  return std::make_unique<AdaptiveSdf>(model, tolerance);
}

}  // namespace spm::bench
