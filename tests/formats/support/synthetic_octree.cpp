// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/support/synthetic_octree.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "common/base/half.hpp"
#include "common/base/octahedral.hpp"
#include "tests/formats/support/synthetic_asset.hpp"
#include "tests/support/octree_by_hand.hpp"

namespace spm::test {

namespace {

/// Makes an octree with cubes of every kind, up to four levels below the roots, and random
/// triangles none of whose corners lies in a far or deep cube.
class OctreeMaker {
 public:
  OctreeMaker(Random& random, std::uint32_t charts, std::uint32_t triangles)
      : random_(random),
        charts_(charts),
        surface_(triangles - triangles / 4),
        sheets_(triangles / 4) {
    octree.origin = Vector3(-0.04, -0.04, -0.03);
    octree.edge = 0.02;
    octree.roots = {4, 4, 3};
    octree.clearance_unit = 1e-4;
    octree.reach = 0.004;
    set_lattice(octree, Vector3(-0.005, -0.005, 0), 1e-6);
    for (std::uint32_t root = 0; root < 4 * 4 * 3; ++root) add_root(root % 3 != 0);
    add_triangles(surface_);
    add_triangles(sheets_);
  }

  OctreeData octree;

 private:
  Random& random_;
  std::uint32_t charts_;
  std::uint32_t surface_, sheets_;  ///< triangles

  OctreeKind random_kind() {
    constexpr std::array kinds{OctreeKind::far,  OctreeKind::pruned, OctreeKind::deep,
                               OctreeKind::list, OctreeKind::list,   OctreeKind::map,
                               OctreeKind::map,  OctreeKind::map,    OctreeKind::map};
    const OctreeKind kind = kinds[below(random_, kinds.size())];
    const bool missing =
        (kind == OctreeKind::list && surface_ == 0) || (kind == OctreeKind::map && charts_ == 0);
    return missing ? OctreeKind::pruned : kind;
  }

  std::uint32_t reserve(std::size_t words) {
    const auto first = static_cast<std::uint32_t>(octree.words.size());
    octree.words.resize(octree.words.size() + words);
    return first;
  }

  void add_root(bool split) {
    const OctreeKind kind = split ? OctreeKind::split : random_kind();
    std::uint32_t word = below(random_, 1000);  // of a far one the distance
    if (kind != OctreeKind::far) word = reserve(words_of(kind));
    octree.root_words.push_back(root_word(kind, word));
    fill(kind, word, 0);
  }

  void fill(OctreeKind kind, std::uint32_t first, int level) {
    std::vector<std::uint32_t> words;
    if (kind == OctreeKind::split) {
      split(first, level);
    } else if (kind == OctreeKind::list) {
      const auto list = random_list();
      words.assign(list.begin(), list.end());
    } else if (kind == OctreeKind::map) {
      words = {word_of_map(below(random_, charts_))};
      if (below(random_, 2) == 0) {
        words = {word_of_maps(words[0], below(random_, charts_),
                              {below(random_, 2) == 0, below(random_, 2) == 0})};
      }
    } else if (kind == OctreeKind::deep) {
      words = {pack_octahedral(random_.direction())};
    }
    std::copy(words.begin(), words.end(),
              octree.words.begin() + static_cast<std::ptrdiff_t>(first));
  }

  void split(std::uint32_t at, int level) {
    std::uint32_t kinds = 0, words = 0;
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      const bool again = level < 3 && below(random_, 6) == 0;
      const OctreeKind kind = again ? OctreeKind::split : random_kind();
      kinds |= static_cast<std::uint32_t>(kind) << (4 * octant);
      words += words_of(kind);
    }
    const std::uint32_t first = reserve(words);
    octree.words[at] = first;
    octree.words[at + 1] = kinds;
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      fill(static_cast<OctreeKind>((kinds >> (4 * octant)) & 15U),
           first + words_before(kinds, octant), level + 1);
    }
  }

  std::array<std::uint32_t, 2> random_list() {
    const auto some = [this](std::uint32_t first, std::uint32_t triangles, std::uint32_t count) {
      std::vector<std::uint32_t> numbers;
      for (std::uint32_t k = 0; k < count; ++k) {
        numbers.push_back(first + below(random_, triangles));
      }
      return numbers;
    };
    std::vector<std::uint32_t> bounds;
    for (std::uint32_t k = 0; k < 5; ++k) bounds.push_back(k * (1 + below(random_, 8)));
    return add_list(
        octree, some(0, surface_, 1 + below(random_, 24)),
        sheets_ == 0 ? std::vector<std::uint32_t>() : some(surface_, sheets_, below(random_, 3)),
        static_cast<ListSide>(below(random_, 3)), bounds);
  }

  void add_triangles(std::uint32_t triangles) {
    for (std::uint32_t k = 0; k < triangles; ++k) {
      TriangleByHand triangle;
      triangle.thin = below(random_, 4) == 0;
      for (auto& corner : triangle.corners) corner = random_corner();
      for (unsigned feature = 1; feature < 7; ++feature) {
        triangle.sides = static_cast<FeatureSides>(
            triangle.sides | pack_side(static_cast<TriangleFeature>(feature),
                                       static_cast<FeatureSide>(below(random_, 3))));
      }
      add_triangle(octree, triangle);
    }
  }

  std::array<std::int32_t, 3> random_corner() {
    AssetView view;
    octree.add_to(view);
    for (;;) {
      std::array<std::int32_t, 3> corner{};
      Vector3 place = octree.lattice_origin;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        corner[axis] = static_cast<std::int32_t>(below(random_, 50000U)) - 25000;
        place[static_cast<int>(axis)] += octree.lattice_step * (corner[axis] + lattice_middle);
      }
      const OctreeKind kind = leaf_at(view.octree, place).kind;
      if (kind != OctreeKind::far && kind != OctreeKind::deep) return corner;
    }
  }
};

}  // namespace

OctreeData random_octree(Random& random, std::uint32_t charts, std::uint32_t triangles) {
  return OctreeMaker(random, charts, triangles).octree;
}

AtlasData random_atlas(Random& random, std::uint32_t planes, std::uint32_t charts) {
  constexpr std::uint32_t side = 9, across = 4;
  AtlasData atlas;
  if (planes == 0 || charts == 0) return atlas;
  atlas.spacing = 0.03;
  atlas.offset = -0.0015;
  atlas.width = side * across;
  // One more row, since one more height may be read behind the last.
  const std::uint32_t rows = side * ((charts + across - 1) / across) + 1;
  for (std::uint32_t k = 0; k < atlas.width * rows; ++k) {
    // As HALF samples can be.
    const auto height = static_cast<float>(random.between(1e-3, 0.02));
    atlas.heights.push_back(float_of_half(half_of(height)));
  }
  for (std::uint32_t k = 0; k < charts; ++k) {
    ChartData& chart = atlas.charts.emplace_back();
    chart.plane = below(random, planes);
    chart.level = below(random, 2);
    chart.column0 = -static_cast<std::int32_t>(side / 2);
    chart.row0 = -static_cast<std::int32_t>(side / 2);
    chart.columns = chart.rows = side;
    chart.offset = below(random, 2) == 0;
    chart.base = static_cast<float>(random.between(0, 0.01));
    chart.first = k / across * side * atlas.width + k % across * side;
  }
  return atlas;
}

}  // namespace spm::test
