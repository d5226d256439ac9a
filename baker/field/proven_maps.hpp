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

#include "baker/field/cube_candidates.hpp"
#include "common/field/distance_octree.hpp"

namespace spm::baker {

/// Polynomials that were proven in a cube, as an octree stores them.
struct CubeMaps {
  OctreeKind kind = OctreeKind::polynomial;
  std::vector<std::uint32_t> words;
};

/// What was found for each cube, so that octrees of one surface with smaller or larger smallest
/// cubes fit and prove the maps of the cubes that they share once. Safe from several threads.
class ProvenMaps {
 public:
  /// The maps of a cube, or none where none was proven. `find` is called where that is not known.
  template <class Find>
  const std::optional<CubeMaps>& of(const Cube& cube, const Find& find) {
    const Key key{cube.middle.x(), cube.middle.y(), cube.middle.z(), cube.half};
    const auto known = maps_.find(key);
    return known != maps_.end() ? known->second : maps_.emplace(key, find()).first->second;
  }

  /// Forgets all where values are stored in other units, m, than before.
  void store_in(double value_unit) {
    if (value_unit != std::exchange(value_unit_, value_unit)) maps_.clear();
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
  tbb::concurrent_unordered_map<Key, std::optional<CubeMaps>, Hash> maps_;
  double value_unit_ = 0;
};

}  // namespace spm::baker
