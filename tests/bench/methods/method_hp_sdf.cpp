// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <boost/math/special_functions/legendre.hpp>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "common/base/units.hpp"
#include "tests/bench/geometry/cube_tree.hpp"
#include "tests/bench/methods/methods.hpp"

namespace spm::bench {
namespace {

/// Cubes are at most so large to begin with, m.
constexpr double largest_leaf = 0.016;
constexpr int first_degree = 2, most_degree = 8;
constexpr std::size_t degrees = most_degree - first_degree + 1;
/// Smaller cubes than this share of the largest are not made.
constexpr double smallest_share = 1.0 / 256;
/// So many of the worst cubes are refined at once, for the sake of several processors.
constexpr std::size_t batch = 64;
/// More would be a gigabyte.
constexpr std::size_t max_floats = 250'000'000;

/// Numbers of Legendre's polynomials, made once, since a division takes long.
template <class Number>
struct LegendreNumbers {
  /// P(i + 1) = more x P(i) - less P(i - 1), and what makes the length of P(i) on [0, 1] one.
  std::array<Number, most_degree + 2> more{}, less{}, length{};

  LegendreNumbers() {
    for (std::size_t i = 0; i < length.size(); ++i) {
      const auto n = static_cast<Number>(i);
      more[i] = (2 * n + 1) / (n + 1);
      less[i] = n / (n + 1);
      length[i] = std::sqrt(2 * n + 1);
    }
  }
};
template <class Number>
const LegendreNumbers<Number> legendre_numbers;

/// Legendre's polynomials on [0, 1] and their derivatives, of length 1 there.
template <class Number>
struct Legendre {
  std::array<Number, most_degree + 1> value{}, slope{};

  [[gnu::always_inline]] Legendre(Number place, int degree) {
    const LegendreNumbers<Number>& numbers = legendre_numbers<Number>;
    const Number x = 2 * place - 1;
    Number before = 0, now = 1, before_slope = 0, now_slope = 0;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(degree); ++i) {
      value[i] = numbers.length[i] * now;
      slope[i] = 2 * numbers.length[i] * now_slope;
      const Number next = numbers.more[i] * x * now - numbers.less[i] * before;
      const Number next_slope =
          numbers.more[i] * (now + x * now_slope) - numbers.less[i] * before_slope;
      before = now;
      before_slope = now_slope;
      now = next;
      now_slope = next_slope;
    }
  }
};

/// The polynomial at a place in its cube, and the direction of its gradient.
template <int degree>
Answer evaluate(const float* terms, const CubePlace& place) noexcept {
  const Legendre<float> x(place[0], degree), y(place[1], degree), z(place[2], degree);
  float distance = 0, along_x = 0, along_y = 0, along_z = 0;
  for (std::size_t i = 0; i <= degree; ++i) {
    float plane = 0, plane_y = 0, plane_z = 0;
    for (std::size_t j = 0; i + j <= degree; ++j) {
      float line = 0, line_z = 0;
      for (std::size_t k = 0; i + j + k <= degree; ++k, ++terms) {
        line += *terms * z.value[k];
        line_z += *terms * z.slope[k];
      }
      plane += line * y.value[j];
      plane_y += line * y.slope[j];
      plane_z += line_z * y.value[j];
    }
    distance += plane * x.value[i];
    along_x += plane * x.slope[i];
    along_y += plane_y * x.value[i];
    along_z += plane_z * x.value[i];
  }
  Answer answer;
  answer.distance = static_cast<double>(distance);
  const float length = std::sqrt(along_x * along_x + along_y * along_y + along_z * along_z);
  if (length > 0) answer.normal = Vector3(along_x / length, along_y / length, along_z / length);
  answer.status = Status::exact;
  return answer;
}

/// Those of all degrees, from the first on: a loop of known length takes half of the time.
constexpr auto evaluators = []<std::size_t... above>(std::index_sequence<above...>) {
  return std::array{&evaluate<first_degree + static_cast<int>(above)>...};
}
(std::make_index_sequence<degrees>());

constexpr std::size_t terms_of(int degree) {
  const auto p = static_cast<std::size_t>(degree);
  return (p + 1) * (p + 2) * (p + 3) / 6;
}

/// Gauss's quadrature on [0, 1], and the polynomials up to a degree at its nodes.
struct Quadrature {
  struct Node {
    double place, weight;
    Legendre<double> values;
  };
  std::vector<Node> nodes;

  explicit Quadrature(int degree) {
    const int count = degree + 2;
    const auto add = [&](double x) {
      const double slope = boost::math::legendre_p_prime(count, x), place = (1 + x) / 2;
      nodes.push_back({place, 1 / ((1 - x * x) * slope * slope), {place, degree}});
    };
    // Those that are not negative.
    for (const double zero : boost::math::legendre_p_zeros<double>(count)) {
      add(zero);
      if (zero > 0) add(-zero);
    }
  }
};

/// That of a degree; each is made once.
const Quadrature& quadrature(int degree) {
  static const std::vector<Quadrature> all = [] {
    std::vector<Quadrature> made;
    made.reserve(degrees);
    for (int each = first_degree; each <= most_degree; ++each) made.emplace_back(each);
    return made;
  }();
  return all[static_cast<std::size_t>(degree - first_degree)];
}

/// A polynomial over a cube: the terms of total degree up to `degree`, z fastest.
struct Fit {
  int degree = 0;
  std::vector<double> terms;
  /// Their estimate: the root of the mean square of the terms of the last degree.
  double error = 0;
};

Fit fit(const Model& model, const TreeCube& cube, int degree) {
  Fit found{degree, std::vector<double>(terms_of(degree), 0.0)};
  const std::vector<Quadrature::Node>& nodes = quadrature(degree).nodes;
  for (const Quadrature::Node& a : nodes) {
    for (const Quadrature::Node& b : nodes) {
      for (const Quadrature::Node& c : nodes) {
        const Vector3 place(a.place, b.place, c.place);
        const double weighed = a.weight * b.weight * c.weight *
                               model.caster.closest(cube.low + cube.edge * place).distance;
        std::size_t term = 0;
        for (int i = 0; i <= degree; ++i) {
          for (int j = 0; i + j <= degree; ++j) {
            const double both = weighed * a.values.value[static_cast<std::size_t>(i)] *
                                b.values.value[static_cast<std::size_t>(j)];
            for (int k = 0; i + j + k <= degree; ++k) {
              found.terms[term++] += both * c.values.value[static_cast<std::size_t>(k)];
            }
          }
        }
      }
    }
  }
  std::size_t term = 0;
  double square = 0;
  for (int i = 0; i <= degree; ++i) {
    for (int j = 0; i + j <= degree; ++j) {
      for (int k = 0; i + j + k <= degree; ++k, ++term) {
        if (i + j + k == degree) square += found.terms[term] * found.terms[term];
      }
    }
  }
  found.error = std::sqrt(square);
  return found;
}

/// A leaf while the tree is built; the error counts with its volume.
struct Cell {
  TreeCube cube;
  Fit fit;
  [[nodiscard]] double volume() const { return std::pow(cube.edge, 3); }
  [[nodiscard]] double square() const { return fit.error * fit.error * volume(); }
};

/// What refining a cell gave.
struct Refined {
  std::vector<Cell> cells;  ///< one of a higher degree, or octants; of these none are far or deep
  bool is_split = false;
};

class HpSdf : public Method {
 public:
  HpSdf(const Model& model, double rms)
      : band_(model.band), tree_(model.mesh.box_min, model.mesh.box_max, model.band) {
    const Clock::time_point start = Clock::now();
    build(model, rms);
    tree_.fill_start(largest_leaf);
    facts_.name = "hp-sdf";
    facts_.settings = "estimated rms error " + format_quantity(rms, Quantity::length);
    facts_.setting = rms;
    const std::uint64_t terms = terms_.size() * sizeof(terms_[0]);
    facts_.file_bytes = tree_.file_bytes() + terms;
    facts_.resident_bytes = tree_.resident_bytes() + terms;
    facts_.build_seconds = seconds_since(start);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    return tree_.answer(point, [this](std::uint32_t leaf, const CubePlace& place) {
      const float* stored = terms_.data() + leaf;
      const auto degree = static_cast<std::size_t>(*stored);
      const Answer answer = evaluators[degree - first_degree](stored + 1, place);
      // A cube reaches beyond the band.
      if (answer.distance > band_.margin) return far_answer();
      return answer.distance < -band_.max_depth ? deep_answer(band_.max_depth) : answer;
    });
  }

 private:
  Band band_;
  CubeTree tree_;
  std::vector<float> terms_;  ///< of each leaf its degree, then the terms

  /// Tells in the tree where a cube lies wholly beyond the band; returns whether it does.
  bool mark_beyond(const Model& model, const TreeCube& cube) {
    const auto marker = tree_.marker_of(cube, model.caster.closest(cube.middle()).distance);
    if (marker) tree_.set(cube, *marker);
    return marker.has_value();
  }

  /// The first grid's cubes that the band passes.
  std::vector<TreeCube> first_cubes(const Model& model) {
    std::vector<TreeCube> level{tree_.root()}, kept;
    while (!level.empty()) {
      std::vector<TreeCube> next;
      for (const TreeCube& cube : level) {
        if (mark_beyond(model, cube)) continue;
        if (cube.edge <= largest_leaf) {
          kept.push_back(cube);
          continue;
        }
        const std::array<TreeCube, 8> octants = tree_.split(cube);
        next.insert(next.end(), octants.begin(), octants.end());
      }
      level = std::move(next);
    }
    return kept;
  }

  /// One degree more, or octants: whichever lessens the estimated error more for each term added.
  [[nodiscard]] static Refined refine(const Model& model, const Cell& cell) {
    const std::size_t terms = terms_of(cell.fit.degree);
    const bool can_split = cell.cube.edge > 2 * smallest_share * largest_leaf;
    Refined higher, split;
    double by_degree = -1, by_octants = -1;
    if (cell.fit.degree < most_degree) {
      higher.cells = {{cell.cube, fit(model, cell.cube, cell.fit.degree + 1)}};
      const std::size_t more = terms_of(cell.fit.degree + 1) - terms;
      by_degree = (std::sqrt(cell.square()) - std::sqrt(higher.cells[0].square())) /
                  static_cast<double>(more);
    }
    if (can_split) {
      split.is_split = true;
      double square = 0;
      for (std::uint32_t octant = 0; octant < 8; ++octant) {
        const TreeCube part = cell.cube.octant(octant);
        split.cells.push_back({part, fit(model, part, cell.fit.degree)});
        square += split.cells.back().square();
      }
      by_octants =
          (std::sqrt(cell.square()) - std::sqrt(square)) / (7 * static_cast<double>(terms));
    }
    if (!can_split && cell.fit.degree == most_degree) return {};
    if (!can_split) return higher;
    return by_degree > by_octants ? higher : split;
  }

  /// The worst cells first, until the root of the mean square of their errors is small enough.
  void build(const Model& model, double rms) {
    const std::vector<TreeCube> first = first_cubes(model);
    std::vector<Cell> cells(first.size()), done;
    tbb::parallel_for(std::size_t{0}, first.size(), [&](std::size_t i) {
      cells[i] = {first[i], fit(model, first[i], first_degree)};
    });
    const auto less_off = [](const Cell& a, const Cell& b) {
      return a.square() != b.square() ? a.square() < b.square() : a.cube.word < b.cube.word;
    };
    std::vector<Cell> heap;
    double squares = 0, volume = 0;
    std::size_t floats = 0;
    const auto add = [&](Cell cell) {
      squares += cell.square();
      volume += cell.volume();
      floats += 1 + cell.fit.terms.size();
      heap.push_back(std::move(cell));
      std::push_heap(heap.begin(), heap.end(), less_off);
    };
    for (Cell& cell : cells) add(std::move(cell));
    while (!heap.empty() && squares > rms * rms * volume) {
      cells.clear();
      for (std::size_t i = 0; i < batch && !heap.empty(); ++i) {
        std::pop_heap(heap.begin(), heap.end(), less_off);
        cells.push_back(std::move(heap.back()));
        heap.pop_back();
      }
      std::vector<Refined> refined(cells.size());
      tbb::parallel_for(std::size_t{0}, cells.size(),
                        [&](std::size_t i) { refined[i] = refine(model, cells[i]); });
      for (std::size_t i = 0; i < cells.size(); ++i) {
        if (refined[i].cells.empty()) {
          done.push_back(std::move(cells[i]));
          continue;
        }
        squares -= cells[i].square();
        volume -= cells[i].volume();
        floats -= 1 + cells[i].fit.terms.size();
        if (!refined[i].is_split) {
          add(std::move(refined[i].cells[0]));
          continue;
        }
        const std::array<TreeCube, 8> octants = tree_.split(cells[i].cube);
        for (std::size_t octant = 0; octant < 8; ++octant) {
          refined[i].cells[octant].cube = octants[octant];
          if (!mark_beyond(model, octants[octant])) add(std::move(refined[i].cells[octant]));
        }
      }
      if (floats > max_floats) {
        throw baker::BakeError(ExitCode::invalid_input, "an hp-adaptive field for " +
                                                            format_quantity(rms, Quantity::length) +
                                                            " would hold more than a gigabyte");
      }
    }
    std::move(heap.begin(), heap.end(), std::back_inserter(done));
    std::sort(done.begin(), done.end(),
              [](const Cell& a, const Cell& b) { return a.cube.word < b.cube.word; });
    for (const Cell& cell : done) {
      tree_.set(cell.cube, static_cast<std::uint32_t>(terms_.size()) | CubeTree::leaf_bit);
      terms_.push_back(static_cast<float>(cell.fit.degree));
      for (const double term : cell.fit.terms) terms_.push_back(static_cast<float>(term));
    }
  }
};

}  // namespace

std::unique_ptr<Method> make_hp_sdf(const Model& model, double rms) {
  return std::make_unique<HpSdf>(model, rms);
}

}  // namespace spm::bench
