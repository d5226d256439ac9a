// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/octree_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/field/octree_pruning.hpp"
#include "common/field/indexed_triangles.hpp"
#include "common/field/triangle_list.hpp"

namespace spm::baker {

namespace {

constexpr std::uint32_t not_stored = 0xFFFFFFFF;
/// So few are not put in order.
constexpr std::size_t close_together = 4;

Vector3 middle_of(const LatticeTriangle& triangle) {
  return (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3;
}

/// Orders triangles by halving along the longest side of their box again and again.
void order(const LatticeSurface& surface, std::span<std::uint32_t> triangles) {
  if (triangles.size() <= close_together) return;
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const std::uint32_t triangle : triangles) {
    const Vector3 middle = middle_of(surface.any_triangle(triangle));
    low = low.cwiseMin(middle);
    high = high.cwiseMax(middle);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t half = triangles.size() / 2;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half),
                   triangles.end(), [&](std::uint32_t a, std::uint32_t b) {
                     const double x = middle_of(surface.any_triangle(a))[axis];
                     const double y = middle_of(surface.any_triangle(b))[axis];
                     return x != y ? x < y : a < b;
                   });
  order(surface, triangles.first(half));
  order(surface, triangles.subspan(half));
}

void append(std::uint64_t word, std::vector<std::uint32_t>& words) {
  words.push_back(static_cast<std::uint32_t>(word));
  words.push_back(static_cast<std::uint32_t>(word >> 32U));
}

/// Writes the triangles that are used as the file stores them, such that those that are close in
/// space are close in memory. Returns the number of each in the file, or not_stored. Throws
/// BakeError where there are too many.
std::vector<std::uint32_t> write_triangles(const LatticeSurface& surface,
                                           const std::vector<bool>& used, OctreeData& data) {
  std::vector<std::uint32_t> ordered;
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    if (used[i]) ordered.push_back(i);
  }
  order(surface, ordered);
  data.lattice_origin = surface.origin;
  data.lattice_step = surface.step;
  data.sides.resize((ordered.size() + 1) / 2, 0);
  std::vector<std::uint32_t> numbers(used.size(), not_stored);
  std::map<LatticePoint, std::uint32_t> corners;
  for (std::uint32_t number = 0; number < ordered.size(); ++number) {
    const LatticeTriangle& triangle = surface.any_triangle(ordered[number]);
    numbers[ordered[number]] = number;
    std::array<std::uint32_t, 3> of_triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [found, fresh] =
          corners.emplace(triangle.steps[k], static_cast<std::uint32_t>(corners.size()));
      if (fresh) append(pack_three(triangle.steps[k]), data.corners);
      of_triangle[k] = found->second;
    }
    append(pack_three(of_triangle, triangle.thin), data.triangles);
    data.sides[number / 2] |= pack_traits({.sides = triangle.sides,
                                           .crossed = ordered[number] >= surface.triangles.size()})
                              << 16U * (number % 2);
  }
  if (corners.size() > corner_mask || ordered.size() > list_first_mask) {
    throw BakeError(ExitCode::tolerance_not_met,
                    "exact lists take more than 2 million corners or 4 million triangles of the "
                    "mesh; take a coarser tolerance or fewer triangles");
  }
  return numbers;
}

/// A triangle of a list, by its number in the file.
struct Listed {
  std::uint32_t bound = 0;  ///< as the list stores it
  std::uint32_t number = 0;

  bool operator<(const Listed& other) const {
    return bound != other.bound ? bound < other.bound : number < other.number;
  }
};

class Writer {
 public:
  Writer(const std::vector<std::uint32_t>& numbers, const Atlas& atlas, BuiltOctree& built)
      : numbers_(numbers), atlas_(atlas), built_(built), data_(built.data) {}

  [[nodiscard]] std::uint32_t root_word(const OctreeNode& node) {
    const auto kind = static_cast<std::uint32_t>(node.kind);
    if (node.kind == OctreeKind::far) {
      const double steps = std::floor(node.clearance / data_.clearance_unit);
      return kind | static_cast<std::uint32_t>(std::clamp(steps, 0.0, 268435455.0)) << 4U;
    }
    const std::uint32_t first = reserve(words_of(node.kind));
    write(node, first);
    return kind | first << 4U;
  }

 private:
  const std::vector<std::uint32_t>& numbers_;  ///< of the surface's triangles, in the file
  const Atlas& atlas_;
  BuiltOctree& built_;
  OctreeData& data_;
  std::map<std::pair<std::uint32_t, std::vector<std::uint32_t>>, std::uint32_t> known_;

  [[nodiscard]] std::uint32_t number_of(const OctreeNode& node, const ChartAtLevel& chart) const {
    return atlas_.number(chart, node.cube.middle, node.cube.half);
  }

  /// Of the maps that answer in a cube.
  [[nodiscard]] std::uint32_t word_of(const OctreeNode& node) const {
    const std::uint32_t first = number_of(node, node.charts.front());
    if (node.charts.size() == 1) return word_of_map(first);
    return word_of_maps(first, number_of(node, node.charts.back()), node.pair);
  }

  std::uint32_t reserve(std::size_t words) {
    const auto first = static_cast<std::uint32_t>(data_.words.size());
    if (first > 0x0FFFFFFF - 64) {
      throw BakeError(ExitCode::tolerance_not_met,
                      "the octree is too large; take a coarser tolerance");
    }
    data_.words.resize(data_.words.size() + words);
    return first;
  }

  /// Fills the words of a cube, which begin at a place.
  void write(const OctreeNode& node, std::size_t at) {
    const double volume = node.cube.volume();
    switch (node.kind) {
      case OctreeKind::split: {
        std::uint32_t words = 0, kinds = 0;
        for (std::uint32_t i = 0; i < 8; ++i) {
          const OctreeKind kind = (*node.octants)[i].kind;
          words += words_of(kind);
          kinds |= static_cast<std::uint32_t>(kind) << (4 * i);
        }
        const std::uint32_t first = reserve(words);
        data_.words[at] = first;
        data_.words[at + 1] = kinds;
        for (std::uint32_t i = 0; i < 8; ++i) {
          write((*node.octants)[i], first + words_before(kinds, i));
        }
        break;
      }
      case OctreeKind::list:
        ++built_.counts.lists;
        built_.counts.answered_volume += volume;
        data_.words[at] = list_of(node, data_.words[at + 1]);
        break;
      case OctreeKind::map:
        data_.words[at] = word_of(node);
        ++(node.charts.size() > 1 ? built_.counts.map_pairs : built_.counts.maps);
        built_.counts.answered_volume += volume;
        break;
      case OctreeKind::pruned:
        built_.counts.pruned_volume[static_cast<std::size_t>(node.rule)] += volume;
        break;
      case OctreeKind::far:
        break;
      case OctreeKind::deep:
        data_.words[at] = node.direction;
        break;
    }
  }

  [[nodiscard]] std::vector<Listed> entries_of(const std::vector<ListedCandidate>& listed) const {
    std::vector<Listed> entries;
    for (const ListedCandidate& candidate : listed) {
      const double steps = std::floor(candidate.bound / data_.reach * 255 * (1 - 1e-6));
      entries.push_back({static_cast<std::uint32_t>(std::clamp(steps, 0.0, 255.0)),
                         numbers_[candidate.triangle]});
    }
    return entries;
  }

  /// The words of a list (TriangleList).
  static std::vector<std::uint32_t> list_words(std::vector<Listed> solids,
                                               std::vector<Listed> sheets,
                                               const std::vector<std::uint32_t>& crossed,
                                               std::uint32_t& word) {
    TriangleList list{.solids = static_cast<std::uint32_t>(solids.size()),
                      .sheets = static_cast<std::uint32_t>(sheets.size()),
                      .crossed = static_cast<std::uint32_t>(crossed.size())};
    // In the order of numbers more lists are the same.
    if (!list.has_bounds()) {
      for (auto* part : {&solids, &sheets}) {
        for (Listed& listed : *part) listed.bound = 0;
      }
    }
    std::sort(solids.begin(), solids.end());
    std::sort(sheets.begin(), sheets.end());
    std::vector<std::uint32_t> numbers, bounds;
    for (const auto* part : {&solids, &sheets}) {
      for (std::size_t k = 0; k < part->size(); ++k) {
        numbers.push_back((*part)[k].number);
        if (k % packet_size == 0) bounds.push_back((*part)[k].bound);
      }
    }
    numbers.insert(numbers.end(), crossed.begin(), crossed.end());
    const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
    list.wide = *most - *least > 0xFFFF;
    std::vector<std::uint32_t> words(list.word_count(), 0);
    words[0] = *least | list.crossed << list_first_bits;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const std::uint32_t more = numbers[k] - *least;
      if (list.wide) words[1 + k] = more;
      if (!list.wide) words[1 + k / 2] |= more << 16U * (k % 2);
    }
    if (list.has_bounds()) {
      for (std::size_t k = 0; k < bounds.size(); ++k) {
        words[list.number_words() + k / 4] |= bounds[k] << 8U * (k % 4);
      }
    }
    word = list_word(list.solids, list.sheets, ListSide::surface, list.wide);
    return words;
  }

  std::uint32_t list_of(const OctreeNode& node, std::uint32_t& word) {
    if (std::max(node.solids.size(), node.sheets.size()) > max_listed_of_kind) {
      throw BakeError(ExitCode::tolerance_not_met,
                      fmt::format("more than {} triangles meet in one place", max_listed_of_kind));
    }
    std::vector<std::uint32_t> crossed;
    for (const std::uint32_t triangle : node.crossed) crossed.push_back(numbers_[triangle]);
    const std::vector<std::uint32_t> words =
        list_words(entries_of(node.solids), entries_of(node.sheets), crossed, word);
    const auto first = static_cast<std::uint32_t>(data_.lists.size());
    const auto [found, fresh] = known_.emplace(std::pair(word, words), first);
    if (fresh) data_.lists.insert(data_.lists.end(), words.begin(), words.end());
    word |= list_word(0, 0, node.side, false, node.known);
    built_.counts.listed_triangles += node.solids.size() + node.sheets.size();
    return found->second;
  }
};

}  // namespace

void write_words(const OctreeRoots& roots, const LatticeSurface& surface, const Atlas& atlas,
                 BuiltOctree& built) {
  OctreeData& data = built.data;
  const std::vector<std::uint32_t> numbers =
      write_triangles(surface, used_triangles(surface, roots), data);
  Writer writer(numbers, atlas, built);
  for (const OctreeNode& root : roots.nodes) data.root_words.push_back(writer.root_word(root));
  built.counts.bytes = 4 * (data.root_words.size() + data.words.size() + data.lists.size() +
                            data.corners.size() + data.triangles.size() + data.sides.size());
}

}  // namespace spm::baker
