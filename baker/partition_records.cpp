// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/partition_records.hpp"

#include <algorithm>
#include <compare>
#include <map>
#include <set>
#include <string>

#include "baker/bake_error.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t small_triangle_bytes = 18;

/// Bytes of a list beside its word: none for one that the word holds.
std::uint64_t list_bytes(std::size_t elements) {
  return elements <= 2 ? 0 : 4 + 4 * ((elements + 1) / 2);
}

std::uint64_t tile_bytes(const TileData& tile) {
  return 2 * tile_sample_count + 16 + (~tile.valid != 0 ? 8 : 0) +
         (tile.clipped != 0 ? 8 + 4 * tile.clips.size() : 0);
}

/// A leaf's list with the numbers of the file.
struct NumberedList {
  std::vector<std::uint32_t> tiles, triangles;
  ListSide side = ListSide::told;
  auto operator<=>(const NumberedList&) const = default;
};

class RecordWriter {
 public:
  RecordWriter(Asset& asset, const FallbackTriangles& fallback)
      : asset_(asset), fallback_(fallback), tile_number_(asset.tiles.size(), unused) {}

  TilePartitionCounts counts;

  /// Numbers everything in use; then the width of the lists' numbers is known.
  void number(const PartitionNode& node) {
    if (node.octants) {
      for (const PartitionNode& part : *node.octants) number(part);
      return;
    }
    if (node.kind != CellKind::record || node.rule != 0) return;
    for (const std::uint32_t element : node.elements) {
      if ((element & triangle_flag) != 0) {
        const auto next = static_cast<std::uint32_t>(triangle_number_.size());
        if (triangle_number_.try_emplace(element & ~triangle_flag, next).second) {
          fallback_.append(element & ~triangle_flag, asset_);
        }
      } else if (tile_number_[element] == unused) {
        tile_number_[element] = static_cast<std::uint32_t>(kept_.size());
        kept_.push_back(element);
      }
    }
  }

  /// Adds up what pruned cubes would have taken that nothing else takes.
  void count_pruned(const PartitionNode& node) {
    if (node.octants) {
      for (const PartitionNode& part : *node.octants) count_pruned(part);
      return;
    }
    if (node.kind != CellKind::record || node.rule == 0) return;
    std::uint64_t& bytes = counts.pruned_bytes[node.rule];
    bytes += list_bytes(node.elements.size());
    for (const std::uint32_t element : node.elements) {
      if (!pruned_.insert(element).second) continue;
      if ((element & triangle_flag) != 0) {
        bytes += triangle_number_.count(element & ~triangle_flag) == 0 ? small_triangle_bytes : 0;
      } else if (tile_number_[element] == unused) {
        bytes += tile_bytes(asset_.tiles[element]);
      }
    }
  }

  void keep_tiles() {
    std::vector<TileData> tiles;
    for (const std::uint32_t tile : kept_) tiles.push_back(std::move(asset_.tiles[tile]));
    asset_.tiles = std::move(tiles);
    asset_.grid.narrow = asset_.tiles.size() <= 0xFFFF && triangle_number_.size() <= 0x7FFF;
  }

  [[nodiscard]] std::uint32_t word_of(const PartitionNode& node) {
    if (node.octants) return split_word(node);
    CellKind kind = node.kind;
    std::uint32_t payload = node.kind == CellKind::deep ? node.normal : 0;
    if (node.kind == CellKind::record && node.rule != 0) {
      kind = CellKind::pruned;
      ++counts.pruned_leaves[node.rule];
    } else if (node.kind == CellKind::record) {
      payload = list_payload(node);
    }
    return static_cast<std::uint32_t>(kind) << 30U | payload;
  }

 private:
  static constexpr std::uint32_t unused = 0xFFFFFFFFU;
  Asset& asset_;
  const FallbackTriangles& fallback_;
  std::set<std::uint32_t> pruned_;  ///< elements that are counted
  std::map<std::uint32_t, std::uint32_t> triangle_number_;
  std::vector<std::uint32_t> tile_number_;
  std::vector<std::uint32_t> kept_;
  std::map<NumberedList, std::uint32_t> lists_;

  [[nodiscard]] std::uint32_t next_offset() const {
    if (asset_.grid.records.size() > offset_mask) {
      throw BakeError(ExitCode::invalid_input,
                      "the spatial partition needs more than 268 million words; simplify the mesh "
                      "or narrow the band");
    }
    return static_cast<std::uint32_t>(asset_.grid.records.size());
  }

  [[nodiscard]] std::uint32_t split_word(const PartitionNode& node) {
    std::array<std::uint32_t, 8> words{};
    for (std::size_t octant = 0; octant < 8; ++octant) words[octant] = word_of((*node.octants)[octant]);
    // Octants that are all the same need no split.
    if (std::all_of(words.begin(), words.end(), [&](std::uint32_t w) { return w == words[0]; })) {
      return words[0];
    }
    const std::uint32_t offset = next_offset();
    asset_.grid.records.insert(asset_.grid.records.end(), words.begin(), words.end());
    return static_cast<std::uint32_t>(CellKind::record) << 30U | split_bit | offset;
  }

  [[nodiscard]] std::uint32_t list_payload(const PartitionNode& node) {
    NumberedList list;
    for (const std::uint32_t element : node.elements) {
      if ((element & triangle_flag) != 0) {
        const std::uint32_t number = element & ~triangle_flag;
        const std::uint32_t cap = fallback_.word(number) & 1U;
        list.triangles.push_back(triangle_number_.at(number) << 1U | cap);
      } else {
        list.tiles.push_back(tile_number_[element]);
      }
    }
    // Costs nothing, and no surface can tell it better.
    list.side = node.side;
    ++counts.leaves;
    counts.with_triangles += list.triangles.empty() ? 0 : 1;
    counts.exact += node.exact ? 1 : 0;
    std::sort(list.tiles.begin(), list.tiles.end());
    std::sort(list.triangles.begin(), list.triangles.end());
    if (list.triangles.empty() && !node.side_needed && list.tiles.size() <= 2 && !list.tiles.empty() && list.tiles.back() < inline_none) {
      const std::uint32_t second = list.tiles.size() == 2 ? list.tiles[1] : inline_none;
      return inline_bit | second << 14U | list.tiles[0];
    }
    const auto found = lists_.find(list);
    if (found != lists_.end()) return found->second;
    return lists_.emplace(list, append(list)).first->second;
  }

  [[nodiscard]] std::uint32_t append(const NumberedList& list) {
    if (list.tiles.size() > most_listed || list.triangles.size() > most_listed_triangles) {
      throw BakeError(ExitCode::invalid_input,
                      std::to_string(list.tiles.size()) + " tiles and " +
                          std::to_string(list.triangles.size()) +
                          " triangles crowd into one cell of the partition, more than it can "
                          "list; simplify the mesh");
    }
    std::vector<std::uint32_t>& records = asset_.grid.records;
    const std::uint32_t offset = next_offset();
    records.push_back(list_header(static_cast<std::uint32_t>(list.tiles.size()),
                                  static_cast<std::uint32_t>(list.triangles.size()), list.side));
    std::vector<std::uint32_t> numbers = list.tiles;
    numbers.insert(numbers.end(), list.triangles.begin(), list.triangles.end());
    if (!asset_.grid.narrow) {
      records.insert(records.end(), numbers.begin(), numbers.end());
      return offset;
    }
    for (std::size_t i = 0; i < numbers.size(); i += 2) {
      records.push_back(numbers[i] | (i + 1 < numbers.size() ? numbers[i + 1] << 16U : 0U));
    }
    return offset;
  }
};

}  // namespace

TilePartitionCounts write_records(Asset& asset, const FallbackTriangles& fallback,
                                  const std::vector<PartitionNode>& nodes) {
  fallback.describe(asset);
  RecordWriter writer(asset, fallback);
  for (const PartitionNode& node : nodes) writer.number(node);
  for (const PartitionNode& node : nodes) writer.count_pruned(node);
  writer.keep_tiles();
  asset.grid.index.clear();
  for (const PartitionNode& node : nodes) asset.grid.index.push_back(writer.word_of(node));
  return writer.counts;
}

}  // namespace spm::baker
