// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/octree_check.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "common/field/triangle_list.hpp"

namespace spm {
namespace {

/// A cube whose words are still to be checked.
struct Cube {
  OctreeKind kind = OctreeKind::far;
  std::uint32_t word = 0;
  int level = 0;
};

/// Walks over all cubes. Each word belongs to one cube, so the walk ends after as many steps.
class OctreeCheck {
 public:
  OctreeCheck(const AssetView& asset, std::size_t& steps)
      : asset_(asset),
        steps_(steps),
        taken_(asset.octree.words.size(), false),
        listed_(asset.octree.lists.size(), false),
        lists_(asset.octree.lists.size(), 0) {}

  [[nodiscard]] std::string problem() {
    for (const std::uint32_t word : asset_.octree.root_words) {
      const OctreeRoot root = unpack_root(word);
      if (std::string_view found = meet({root.kind, root.word, 0}); !found.empty()) {
        return "a cube of its octree " + std::string(found);
      }
    }
    while (!open_.empty()) {
      const Cube cube = open_.back();
      open_.pop_back();
      if (std::string_view found = look_into(cube); !found.empty()) {
        return "a cube of its octree " + std::string(found);
      }
    }
    return {};
  }

 private:
  const AssetView& asset_;
  std::size_t& steps_;
  std::vector<bool> taken_, listed_;  ///< words of cubes and of lists that belong to a cube
  std::vector<std::uint32_t> lists_;  ///< by the first word, the word of a cube that names the list
  std::vector<Cube> open_;

  [[nodiscard]] std::string_view meet(const Cube& cube) {
    ++steps_;
    switch (cube.kind) {
      case OctreeKind::far:
      case OctreeKind::pruned:
        return {};
      case OctreeKind::deep:
      case OctreeKind::split:
      case OctreeKind::list:
      case OctreeKind::map:
        break;
      default:
        return "is of no kind";
    }
    if (std::string_view found = take(cube.word, words_of(cube.kind)); !found.empty()) return found;
    open_.push_back(cube);
    return {};
  }

  /// Gives words to a cube.
  [[nodiscard]] std::string_view take(std::size_t first, std::size_t count) {
    if (first > taken_.size() || count > taken_.size() - first) return "is cut short";
    for (std::size_t k = first; k < first + count; ++k) {
      if (taken_[k]) return "shares its words with another";
      taken_[k] = true;
    }
    return {};
  }

  [[nodiscard]] std::string_view look_into(const Cube& cube) {
    const std::uint32_t* words = asset_.octree.words.data() + cube.word;
    switch (cube.kind) {
      case OctreeKind::split:
        return look_into_split(words, cube.level);
      case OctreeKind::list:
        return list_problem(words);
      case OctreeKind::map:
        return chart_problem(NamedMaps(words[0]));
      default:
        return {};
    }
  }

  [[nodiscard]] std::string_view look_into_split(const std::uint32_t* words, int level) {
    if (level == max_octree_levels) return "is split too often";
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      const auto kind = static_cast<OctreeKind>((words[1] >> (4 * octant)) & 15U);
      const std::uint64_t word = std::uint64_t{words[0]} + words_before(words[1], octant);
      if (word > 0xFFFFFFFFU) return "is cut short";
      const auto found = meet({kind, static_cast<std::uint32_t>(word), level + 1});
      if (!found.empty()) return found;
    }
    return {};
  }

  [[nodiscard]] std::string_view list_problem(const std::uint32_t* words) {
    if ((words[1] & 0x03FFFFFFU) == 0) return "has a list without triangles";
    if ((words[1] & list_side_bits) >> 26U >= list_side_codes) return "has a list of no side";
    const TriangleList list = list_of(asset_.octree, words);
    if (list.size() == 0) return "has a list that is cut short";
    // Cubes may share a whole list, but no part of one; else looking at all of them could take
    // long.
    constexpr std::uint32_t but_side = ~list_side_bits;
    if (lists_[words[0]] == (words[1] & but_side)) return {};
    for (std::size_t k = words[0]; k < words[0] + list.word_count(); ++k) {
      if (listed_[k]) return "shares a part of its list with another";
      listed_[k] = true;
    }
    lists_[words[0]] = words[1] & but_side;
    steps_ += list.size();
    for (std::size_t k = 0; k < list.size(); ++k) {
      if (list.triangle(k) >= asset_.exact.size()) return "names triangles that do not exist";
    }
    return {};
  }

  [[nodiscard]] std::string_view chart_problem(const NamedMaps& maps) const {
    if (maps.first >= asset_.charts.size() || maps.second_from_one > asset_.charts.size() ||
        (!maps.two() && (maps.pair.larger || maps.pair.edge))) {
      return "names a distance map that does not exist";
    }
    return {};
  }
};

using Corners = std::array<Vector3, 3>;

/// True where corners lie farther outside the octree than one of its root cubes is wide. A surface
/// that is larger without bound would take as much memory to sample.
bool is_far_outside(const AssetView& asset, const Corners& corners) {
  const Extent extent = extent_of(asset);
  const Vector3 slack = Vector3::Constant(asset.octree.edge);
  return std::any_of(corners.begin(), corners.end(), [&](const Vector3& corner) {
    return !((corner - extent.low + slack).minCoeff() >= 0 &&
             (extent.low + extent.size + slack - corner).minCoeff() >= 0);
  });
}

/// True where corners of the surface lie in cubes that have no answer there, or one from beyond the
/// band.
bool is_lost(const AssetView& asset, const Corners& corners) {
  for (const Vector3& corner : corners) {
    const Leaf leaf = leaf_at(asset.octree, corner);
    if (leaf.kind == OctreeKind::far || leaf.kind == OctreeKind::deep) return true;
  }
  return false;
}

}  // namespace

std::string octree_problem(const AssetView& asset, std::size_t* steps) {
  std::size_t uncounted = 0;
  std::size_t& count = steps == nullptr ? uncounted : *steps;
  count = 0;
  if (std::string found = OctreeCheck(asset, count).problem(); !found.empty()) return found;
  // Rounding moves corners by less than the tolerance, and cubes that thin a band may leave out.
  const bool wide = asset.band.margin > asset.tolerance && asset.band.max_depth > asset.tolerance;
  for (std::size_t i = 0; i < asset.exact.size(); ++i) {
    ++count;
    const std::uint64_t numbers = long_word(asset.exact.triangles, i);
    for (unsigned k = 0; k < 3; ++k) {
      if (unpack_third(numbers, k) >= asset.exact.corner_count()) {
        return "a triangle has a corner that does not exist";
      }
    }
    const Corners corners = corners_of(asset.exact, i);
    if (is_far_outside(asset, corners)) return "a triangle lies outside its octree";
    if (wide && !traits_of(asset.exact, i).crossed && is_lost(asset, corners)) {
      return "a cube of its octree says that the surface is not in it, but a triangle is";
    }
  }
  return {};
}

}  // namespace spm
