// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/asset_check.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "common/asset/grid_list.hpp"
#include "formats/asset/octree_check.hpp"

namespace spm {
namespace {

/// Walks over the words of the grid; lists that several cells share are checked once.
class GridCheck {
 public:
  explicit GridCheck(const AssetView& asset)
      : asset_(asset),
        triangles_(asset.triangles.size() / 9),
        checked_(asset.grid.records.size(), 0) {}

  /// The error in what a word leads to; empty where there is none.
  [[nodiscard]] std::string problem(std::uint32_t word, int splits_left) {
    if (static_cast<CellKind>(word >> 30U) != CellKind::record) return {};
    const std::size_t offset = word & offset_mask;
    if (offset >= checked_.size()) return "lies outside the records";
    const bool split = is_split(word);
    // One bit for each number of splits that may still be nested, and one for lists.
    const auto bit = static_cast<std::uint8_t>(1U << (split ? splits_left : split_levels + 1));
    if ((checked_[offset] & bit) != 0) return {};
    std::string found = split ? split_problem(offset, splits_left) : list_problem(word);
    if (found.empty()) checked_[offset] = static_cast<std::uint8_t>(checked_[offset] | bit);
    return found;
  }

 private:
  std::string split_problem(std::size_t offset, int splits_left) {
    const std::span<const std::uint32_t> records = asset_.grid.records;
    if (splits_left == 0) return "is split too often";
    if (records.size() - offset < 8) return "is cut short";
    for (const std::uint32_t word : records.subspan(offset, 8)) {
      if (std::string found = problem(word, splits_left - 1); !found.empty()) return found;
    }
    return {};
  }

  [[nodiscard]] std::string list_problem(std::uint32_t word) const {
    const GridList list(asset_.grid, word);
    if (!list.whole()) return "is cut short";
    for (std::uint32_t k = 0; k < list.maps(); ++k) {
      if (!map_exists(list.map(k))) return "names a map that does not exist";
    }
    for (std::uint32_t k = 0; k < list.triangles(); ++k) {
      if (list.triangle(k) >> 1U >= triangles_) return "names a triangle that does not exist";
    }
    return {};
  }

  [[nodiscard]] bool map_exists(std::uint32_t number) const {
    const auto [map, layer] = unpack_candidate(number);
    return map < asset_.maps.size() && layer < asset_.maps[map].layers;
  }

  const AssetView& asset_;
  std::size_t triangles_;
  std::vector<std::uint8_t> checked_;
};

Result<void> check_grid(const AssetView& asset, const std::string& path) {
  GridCheck check(asset);
  for (std::size_t cell = 0; cell < asset.grid.index.size(); ++cell) {
    const std::string problem = check.problem(asset.grid.index[cell], split_levels);
    if (problem.empty()) continue;
    std::string message = path + ": the record of grid cell ";
    message += std::to_string(cell) + " " + problem + "; bake it again";
    return fail(ExitCode::invalid_input, std::move(message));
  }
  return {};
}

/// Counts instead of stopping at the first, so that the loop is limited only by memory.
std::size_t count_bad(std::span<const float> values, bool infinity_allowed) {
  std::size_t bad = 0;
  for (const float value : values) {
    const bool good = value >= -std::numeric_limits<float>::max() &&
                      (infinity_allowed || value <= std::numeric_limits<float>::max());
    bad += good ? 0U : 1U;
  }
  return bad;
}

/// Of HALF samples, which are below these where they are numbers.
std::size_t count_bad(std::span<const std::uint16_t> halves) {
  constexpr std::uint16_t infinite = 0x7C00;
  return static_cast<std::size_t>(std::count_if(
      halves.begin(), halves.end(), [](std::uint16_t half) { return half >= infinite; }));
}

std::size_t count_bad(const StoredHeights& heights) {
  return heights.halves ? count_bad(std::span(heights.half_at(0), heights.count))
                        : count_bad(std::span(heights.float_at(0), heights.count), false);
}

}  // namespace

Result<void> check_content(const AssetView& asset, const std::string& path) {
  for (std::size_t index = 0; index < asset.maps.size(); ++index) {
    const DistanceMap& map = asset.maps[index];
    const std::size_t samples = std::size_t{map.row_stride} * map.rows;
    if (count_bad({map.samples, samples}, asset.full) != 0) {
      return fail(ExitCode::invalid_input, path + ": map " + std::to_string(index) +
                                               " has samples that are not numbers; bake it again");
    }
  }
  if (count_bad(asset.atlas) != 0) {
    return fail(ExitCode::invalid_input,
                path + ": its maps have heights that are not numbers; bake it again");
  }
  if (count_bad(asset.triangles, false) != 0) {
    return fail(ExitCode::invalid_input,
                path + ": its triangles have corners that are not numbers; bake it again");
  }
  if (asset.full) return check_grid(asset, path);
  if (const std::string problem = octree_problem(asset); !problem.empty()) {
    return fail(ExitCode::invalid_input, path + ": " + problem + "; bake it again");
  }
  return {};
}

}  // namespace spm
