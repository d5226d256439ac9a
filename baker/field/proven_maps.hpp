// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/concurrent_unordered_map.h>

#include <array>
#include <cstring>
#include <functional>
#include <optional>
#include <string_view>

#include "baker/field/chart_fit.hpp"
#include "baker/field/cube_candidates.hpp"

namespace spm::baker {

/// Which maps were proven in each cube, so that octrees of one surface with smaller or larger
/// smallest cubes fit and prove the maps of the cubes that they share once. Safe from several
/// threads.
class ProvenMaps {
 public:
  /// The maps of a cube; none where none was proven. `find` is called where that is not known.
  template <class Find>
  const std::optional<FittedCharts>& of(const Cube& cube, const Find& find) {
    const Key key{cube.middle.x(), cube.middle.y(), cube.middle.z(), cube.half};
    const auto known = known_.find(key);
    return known != known_.end() ? known->second : known_.emplace(key, find()).first->second;
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
  tbb::concurrent_unordered_map<Key, std::optional<FittedCharts>, Hash> known_;
};

}  // namespace spm::baker
