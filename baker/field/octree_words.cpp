// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/octree_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/field/octree_pruning.hpp"
#include "baker/field/octree_triangles.hpp"
#include "common/field/triangle_list.hpp"

namespace spm::baker {

namespace {

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
