// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <queue>
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

constexpr std::size_t terms_of(int degree) {
  const auto p = static_cast<std::size_t>(degree);
  return (p + 1) * (p + 2) * (p + 3) / 6;
}

/// Nodes and weights of Gauss's quadrature on [0, 1].
std::vector<std::pair<double, double>> gauss_nodes(int count) {
  std::vector<std::pair<double, double>> nodes;
  for (int k = 0; k < count; ++k) {
    double x = std::cos(3.141592653589793 * (k + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 50; ++step) {
      double before = 1, now = x;
      for (int n = 1; n < count; ++n) {
        before = std::exchange(now, ((2 * n + 1) * x * now - n * before) / (n + 1));
      }
      slope = count * (x * now - before) / (x * x - 1);
      const double off = now / slope;
      x -= off;
      if (std::abs(off) < 1e-15) break;
    }
    nodes.emplace_back((1 + x) / 2, 1 / ((1 - x * x) * slope * slope));
  }
  return nodes;
}

/// A polynomial over a cube: the terms of total degree up to `degree`, z fastest.
struct Fit {
  int degree = 0;
  std::vector<double> terms;
  double error =
      0;  ///< their estimate: the root of the mean square of the terms of the last degree
};

Fit fit(const Model& model, const TreeCube& cube, int degree) {
  Fit found{degree, std::vector<double>(terms_of(degree), 0.0)};
  const auto nodes = gauss_nodes(degree + 2);
  std::vector<Legendre<double>> values;
  values.reserve(nodes.size());
  for (const auto& [place, weight] : nodes) values.emplace_back(place, degree);
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    for (std::size_t b = 0; b < nodes.size(); ++b) {
      for (std::size_t c = 0; c < nodes.size(); ++c) {
        const Vector3 place(nodes[a].first, nodes[b].first, nodes[c].first);
        const double weighed = nodes[a].second * nodes[b].second * nodes[c].second *
                               model.caster.closest(cube.low + cube.edge * place).distance;
        std::size_t term = 0;
        for (int i = 0; i <= degree; ++i) {
          for (int j = 0; i + j <= degree; ++j) {
            const double both = weighed * values[a].value[static_cast<std::size_t>(i)] *
                                values[b].value[static_cast<std::size_t>(j)];
            for (int k = 0; i + j + k <= degree; ++k) {
              found.terms[term++] += both * values[c].value[static_cast<std::size_t>(k)];
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
      : band_(model.band), tree_(model.mesh.box_min, model.mesh.box_max, model.band.margin) {
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
    const CubeTree::Found found = tree_.find(point);
    if (found.word == CubeTree::far_word) return far_answer();
    if (found.word == CubeTree::deep_word) return deep_answer(band_.max_depth);
    const Answer answer = polynomial(terms_.data() + (found.word & ~CubeTree::leaf_bit), found);
    // A cube reaches beyond the band.
    if (answer.distance > band_.margin) return far_answer();
    return answer.distance < -band_.max_depth ? deep_answer(band_.max_depth) : answer;
  }

 private:
  Band band_;
  CubeTree tree_;
  std::vector<float> terms_;  ///< of each leaf its degree, then the terms

  [[nodiscard]] static Answer polynomial(const float* leaf, const CubeTree::Found& found) noexcept {
    // A loop of known length takes half of the time.
    switch (static_cast<int>(*leaf)) {
      case 2:
        return evaluate<2>(leaf + 1, found.place);
      case 3:
        return evaluate<3>(leaf + 1, found.place);
      case 4:
        return evaluate<4>(leaf + 1, found.place);
      case 5:
        return evaluate<5>(leaf + 1, found.place);
      case 6:
        return evaluate<6>(leaf + 1, found.place);
      case 7:
        return evaluate<7>(leaf + 1, found.place);
      default:
        return evaluate<8>(leaf + 1, found.place);
    }
  }

  /// Far and deep cubes are told in the tree; returns whether it is one.
  bool is_beyond(const Model& model, const TreeCube& cube) {
    const double distance = model.caster.closest(cube.middle()).distance;
    const bool far = distance - cube.radius() > band_.margin;
    const bool deep = distance + cube.radius() < -band_.max_depth;
    if (deep) tree_.set(cube, CubeTree::deep_word);
    return far || deep;
  }

  /// The first grid's cubes that the band passes.
  std::vector<TreeCube> first_cubes(const Model& model) {
    std::vector<TreeCube> level{tree_.root()}, kept;
    while (!level.empty()) {
      std::vector<TreeCube> next;
      for (const TreeCube& cube : level) {
        if (is_beyond(model, cube)) continue;
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
        const Vector3 at(octant & 1U, octant >> 1U & 1U, octant >> 2U);
        const TreeCube part{cell.cube.low + cell.cube.edge / 2 * at, cell.cube.edge / 2, 0};
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
    const auto better = [](const Cell& a, const Cell& b) {
      return a.square() != b.square() ? a.square() < b.square() : a.cube.word < b.cube.word;
    };
    std::priority_queue<Cell, std::vector<Cell>, decltype(better)> queue(better);
    double squares = 0, volume = 0;
    std::size_t floats = 0;
    const auto add = [&](Cell cell) {
      squares += cell.square();
      volume += cell.volume();
      floats += 1 + cell.fit.terms.size();
      queue.push(std::move(cell));
    };
    for (Cell& cell : cells) add(std::move(cell));
    while (!queue.empty() && squares > rms * rms * volume) {
      cells.clear();
      for (std::size_t i = 0; i < batch && !queue.empty(); ++i) {
        cells.push_back(queue.top());
        queue.pop();
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
          if (!is_beyond(model, octants[octant])) add(std::move(refined[i].cells[octant]));
        }
      }
      if (floats > max_floats) {
        throw baker::BakeError(ExitCode::invalid_input, "an hp-adaptive field for " +
                                                            format_quantity(rms, Quantity::length) +
                                                            " would hold more than a gigabyte");
      }
    }
    for (; !queue.empty(); queue.pop()) done.push_back(queue.top());
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
