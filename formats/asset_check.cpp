// SPDX-License-Identifier: Apache-2.0
#include "formats/asset_check.hpp"

#include <limits>
#include <vector>

namespace spm {
namespace {

constexpr std::uint32_t cap_flag = 1U << 31U;

/// What is wrong with the record at `offset`, empty when nothing is.
std::string record_problem(const AssetView& asset, std::uint32_t offset, int splits_left) {
  const std::span<const std::uint32_t> records = asset.grid.records;
  if (offset >= records.size()) return "lies outside the records";
  if (records[offset] == split_header) {
    if (splits_left == 0) return "is split too often";
    if (records.size() - offset < 9) return "is cut short";
    for (const std::uint32_t word : records.subspan(offset + 1, 8)) {
      if (static_cast<CellKind>(word >> 30U) != CellKind::record) continue;
      if (std::string problem = record_problem(asset, word & payload_mask, splits_left - 1);
          !problem.empty()) {
        return problem;
      }
    }
    return {};
  }
  const std::uint32_t maps = records[offset] & 0xFFFFU;
  const std::uint32_t triangles = records[offset] >> 16U;
  if (std::size_t{maps} + triangles > records.size() - offset - 1) return "is cut short";
  const auto candidates = records.subspan(offset + 1);
  for (const std::uint32_t word : candidates.first(maps)) {
    const auto [map, layer] = unpack_candidate(word);
    if (map >= asset.maps.size() || layer >= asset.maps[map].layers) {
      return "names a map or layer that does not exist";
    }
  }
  for (const std::uint32_t word : candidates.subspan(maps, triangles)) {
    if ((word & ~cap_flag) >= asset.triangles.size() / 9) {
      return "names a triangle that does not exist";
    }
  }
  return {};
}

Result<void> check_grid(const AssetView& asset, const std::string& path) {
  std::vector<bool> checked(asset.grid.records.size(), false);  // cells may share a record
  for (std::size_t cell = 0; cell < asset.grid.index.size(); ++cell) {
    const std::uint32_t word = asset.grid.index[cell];
    if (static_cast<CellKind>(word >> 30U) != CellKind::record) continue;
    const std::uint32_t offset = word & payload_mask;
    if (offset < checked.size() && checked[offset]) continue;
    if (const std::string problem = record_problem(asset, offset, split_levels); !problem.empty()) {
      return fail(ExitCode::invalid_input, path + ": the record of grid cell " +
                                               std::to_string(cell) + " " + problem +
                                               "; bake it again");
    }
    checked[offset] = true;
  }
  return {};
}

/// Counts instead of stopping at the first, so that the loop runs as fast as memory.
std::size_t count_bad(std::span<const float> values, bool infinity_allowed) {
  std::size_t bad = 0;
  for (const float value : values) {
    const bool good = value >= -std::numeric_limits<float>::max() &&
                      (infinity_allowed || value <= std::numeric_limits<float>::max());
    bad += good ? 0U : 1U;
  }
  return bad;
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
  if (count_bad(asset.triangles, false) != 0) {
    return fail(ExitCode::invalid_input,
                path + ": its triangles have corners that are not numbers; bake it again");
  }
  return check_grid(asset, path);
}

}  // namespace spm
