// SPDX-License-Identifier: Apache-2.0
#include "common/index/element_index_build.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <thread>
#include <utility>

#include "common/index/index_branches.hpp"
#include "common/index/primitive_packets_build.hpp"

namespace spm {

namespace {

/// Cubes of the grid along the longest side of the band's box.
constexpr double cells_along = 16;
/// Rounding of packets' bounds, of the longest side of all.
constexpr double rounding_share = 1e-6;
/// How often packets may be looked at for an index, and more for each there is; and for a cube of
/// its grid at least and at most: where all lie in each other's way it would take minutes.
constexpr std::size_t base_budget = 20000000, max_budget_per_packet = 400000;
constexpr std::size_t min_budget_per_cube = 10000, max_budget_per_cube = 16000000;
/// Where a cube of the grid has this share of all packets in the mean, they lie in each other's
/// way: an index would take long to build and be of little use. Few packets are none too many, and
/// with many a cube the share counts that those of a surface are below.
constexpr double max_share_a_cube = 0.12, surface_share_a_cube = 0.025;
constexpr double few_packets_per_cube = 64, many_packets_per_cube = 800;
/// Threads that look at cubes, at most.
constexpr unsigned max_threads = 8;

class Builder {
 public:
  explicit Builder(const AssetView& asset) : asset_(asset) { asset_.index = {}; }

  ElementIndexData build() {
    if (asset_.full || asset_.bvh.words.empty()) return {};
    gather();
    if (primitives_.size() == 0) return {};
    const Extent extent = extent_of(asset_);
    data_.origin = extent.low;
    data_.cell_size = extent.size.maxCoeff() / cells_along;
    std::size_t count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double cells = extent.size[static_cast<int>(axis)] / data_.cell_size;
      data_.cells[axis] = static_cast<std::uint32_t>(std::max(1.0, std::ceil(cells - 1e-9)));
      count *= data_.cells[axis];
    }
    PacketNumbers all(primitives_.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    cubes_.resize(count);
    IndexBrancher brancher(asset_, primitives_);
    gather_cubes(brancher, {0, 0, 0}, data_.cells, all);
    if (!find_branches()) return {};
    data_.words.resize(count);
    for (std::size_t cell = 0; cell < count; ++cell) data_.words[cell] = word_of(branches_[cell]);
    // What does not fit is not told.
    if (data_.words.size() > index_place) data_.words.assign(count, 0);
    data_.cell_packets = std::move(primitives_.cells);
    data_.clip_packets = std::move(primitives_.clips);
    data_.triangle_packets = std::move(primitives_.triangles);
    return std::move(data_);
  }

 private:
  AssetView asset_;
  ElementIndexData data_;
  PrimitivePacketsData primitives_;
  std::vector<IndexCube> cubes_;       ///< of the grid
  std::vector<IndexBranch> branches_;  ///< theirs
  std::map<IndexLists, std::uint32_t> lists_;

  void gather() {
    primitives_ = gather_primitive_packets(asset_);
    const std::array<float, 3>& size = asset_.bvh.size;
    data_.slack = rounding_share * static_cast<double>(*std::max_element(size.begin(), size.end()));
    // Packets are complete: the rest is found with them.
    asset_.index.packets = primitives_.view();
    asset_.index.slack = data_.slack;
  }

  /// Looks at a block of the grid's cubes, halving it along its longest side, so that few packets
  /// are looked at for each.
  void gather_cubes(IndexBrancher& brancher, const std::array<std::uint32_t, 3>& low,
                    const std::array<std::uint32_t, 3>& size, const PacketNumbers& some) {
    const Vector3 edges = data_.cell_size * Vector3(size[0], size[1], size[2]);
    const Vector3 middle =
        data_.origin + data_.cell_size * Vector3(low[0], low[1], low[2]) + edges / 2;
    const std::size_t longest =
        static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
    IndexCube cube = brancher.look(middle, edges.maxCoeff() / 2, some);
    if (size[longest] == 1) {
      cubes_[(std::size_t{low[2]} * data_.cells[1] + low[1]) * data_.cells[0] + low[0]] =
          std::move(cube);
      return;
    }
    std::array<std::uint32_t, 3> half = size, upper = low;
    half[longest] = size[longest] / 2;
    gather_cubes(brancher, low, half, cube.votes);
    upper[longest] += half[longest];
    half[longest] = size[longest] - half[longest];
    gather_cubes(brancher, upper, half, cube.votes);
  }

  /// Each cube by itself, so that how many threads there are changes nothing; false: an index is
  /// of no use here.
  [[nodiscard]] bool find_branches() {
    branches_.resize(cubes_.size());
    const IndexBrancher any(asset_, primitives_);
    std::size_t count = 0, packets = 0;
    for (const IndexCube& cube : cubes_) {
      if (any.is_beyond(cube)) continue;
      ++count;
      packets += cube.votes.size();
    }
    const double mean = static_cast<double>(packets) / static_cast<double>(count + 1);
    const auto all_packets = static_cast<double>(primitives_.size());
    const double most =
        std::min(max_share_a_cube * all_packets,
                 std::max(many_packets_per_cube, surface_share_a_cube * all_packets));
    if (mean > std::max(few_packets_per_cube, most)) return false;
    const std::size_t all = base_budget + max_budget_per_packet * primitives_.size();
    const std::size_t budget =
        std::clamp(all / (count + 1), min_budget_per_cube, max_budget_per_cube);
    std::atomic<std::size_t> next = 0;
    const auto work = [this, &next, budget] {
      IndexBrancher brancher(asset_, primitives_);
      for (std::size_t cell = next++; cell < cubes_.size(); cell = next++) {
        branches_[cell] = brancher.branch_of(cubes_[cell], budget);
      }
    };
    std::vector<std::jthread> others;
    const unsigned threads = std::clamp(std::thread::hardware_concurrency(), 1U, max_threads);
    for (unsigned k = 1; k < threads; ++k) others.emplace_back(work);
    work();
    return true;
  }

  std::uint32_t word_of(const IndexBranch& branch) {
    if (branch.octants == nullptr) {
      if (branch.kind == CubeKind::far) return far_word(branch.beyond);
      if (branch.lists.all.empty()) return 0;
      return place_of(branch.lists) | static_cast<std::uint32_t>(branch.kind) << 28U;
    }
    std::array<std::uint32_t, 8> words{};
    std::transform(branch.octants->begin(), branch.octants->end(), words.begin(),
                   [this](const IndexBranch& octant) { return word_of(octant); });
    const bool alike = std::all_of(words.begin(), words.end(),
                                   [&](std::uint32_t word) { return word == words[0]; });
    if (alike) return words[0];
    const auto first = static_cast<std::uint32_t>(data_.words.size());
    data_.words.insert(data_.words.end(), words.begin(), words.end());
    return index_split | first;
  }

  std::uint32_t place_of(const IndexLists& lists) {
    const auto [place, is_new] =
        lists_.try_emplace(lists, static_cast<std::uint32_t>(data_.words.size()));
    if (!is_new) return place->second;
    const std::vector<std::uint32_t> packed = lists.packed(asset_.index.has_small_numbers());
    data_.words.insert(data_.words.end(), packed.begin(), packed.end());
    return place->second;
  }
};

}  // namespace

ElementIndexData build_element_index(const AssetView& asset) { return Builder(asset).build(); }

}  // namespace spm
