// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/concurrent_unordered_map.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "baker/charts/atlas.hpp"
#include "baker/field/cube_candidates.hpp"
#include "common/field/distance_octree.hpp"

namespace spm::baker {

/// What was proven in a cube: polynomials, as an octree stores them, or distance maps.
struct CubeMaps {
  OctreeKind kind = OctreeKind::polynomial;
  std::vector<std::uint32_t> words;
  std::vector<ChartAtLevel> charts;  ///< as OctreeNode
  MapPair pair;
  double shared_bytes = 0;
};

/// What was found for each cube, so that octrees of one surface with smaller or larger smallest
/// cubes fit and prove the maps of the cubes that they share once. Safe from several threads.
class ProvenMaps {
 public:
  /// The distance maps of a cube, or else its polynomials; none where none was proven. `find` is
  /// called where that is not known.
  template <class Find>
  const std::optional<CubeMaps>& maps_of(const Cube& cube, const Find& find) {
    return of(maps_, cube, find);
  }
  template <class Find>
  const std::optional<CubeMaps>& polynomials_of(const Cube& cube, const Find& find) {
    return of(polynomials_, cube, find);
  }

  /// Forgets polynomials where values are stored in other units, m, than before.
  void store_in(double value_unit) {
    if (value_unit != std::exchange(value_unit_, value_unit)) polynomials_.clear();
  }

 private:
  using Key = std::array<double, 4>;
  struct Hash {
    std::size_t operator()(const Key& key) const noexcept {
      std::array<char, sizeof(Key)> bytes;
      std::memcpy(bytes.data(), key.data(), sizeof(Key));
      return std::hash<std::string_view>()({bytes.data(), bytes.size()});
    }
  };
  using Known = tbb::concurrent_unordered_map<Key, std::optional<CubeMaps>, Hash>;

  template <class Find>
  static const std::optional<CubeMaps>& of(Known& all, const Cube& cube, const Find& find) {
    const Key key{cube.middle.x(), cube.middle.y(), cube.middle.z(), cube.half};
    const auto known = all.find(key);
    return known != all.end() ? known->second : all.emplace(key, find()).first->second;
  }

  Known maps_, polynomials_;
  double value_unit_ = 0;
};

}  // namespace spm::baker
