// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trees/element_choice.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>

#include "baker/proof/tile_proof.hpp"
#include "formats/asset/tile_words.hpp"

namespace spm::baker {

namespace {

/// Triangles may represent at most this share of the surface, while everything together takes more
/// bytes than `many_bytes` and than `many_times` the bytes of the surface's own triangles. A
/// rigging of thin spars, for example, is no place for maps.
constexpr double max_share = 0.5;
constexpr double many_bytes = 400e3;
constexpr double many_times = 3;

double area_of(const std::array<Vector3, 3>& corners) {
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 2;
}

/// A tile to leave out, or a triangle to take as a whole.
struct Move {
  double price = 0;  ///< m^2 left to triangles for each byte saved
  double area = 0;   ///< m^2 left to triangles
  bool tile = false;
  std::uint32_t which = 0;
  bool operator>(const Move& other) const {
    if (price != other.price) return price > other.price;
    return tile != other.tile ? other.tile : which > other.which;
  }
};

class Chooser {
 public:
  Chooser(const Caster& caster, const std::vector<TileData>& tiles, const SurfaceCover& cover,
          double free_share)
      : cover_(cover),
        free_share_(free_share),
        taken_(cover.uses.size(), 0),
        gone_(tiles.size(), 0),
        rests_(tiles.size()) {
    for (const TileData& tile : tiles) tile_bytes_.push_back(tile_bytes(tile));
    for (std::uint32_t t = 0; t < cover.uses.size(); ++t) {
      area_.push_back(area_of({caster.corner(t, 0), caster.corner(t, 1), caster.corner(t, 2)}));
      open_area_.push_back(0);
      for (const SurfacePiece& piece : cover.open[t]) open_area_.back() += area_of(piece.corners);
      all_ += area_.back();
      left_ += open_area_.back();
      bytes_ += triangle_bytes * cover.open[t].size();
      for (const TileUse& use : cover.uses[t]) rests_[use.tile].push_back(t);
    }
    for (const std::uint64_t bytes : tile_bytes_) bytes_ += bytes;
  }

  void run() {
    for (std::uint32_t i = 0; i < rests_.size(); ++i) push(true, i);
    for (std::uint32_t t = 0; t < area_.size(); ++t) push(false, t);
    while (!moves_.empty()) {
      const Move move = moves_.top();
      moves_.pop();
      const Move now = judged(move.tile, move.which);
      if (now.price > move.price) {
        if (now.price < std::numeric_limits<double>::infinity()) moves_.push(now);
        continue;
      }
      if (done(move.tile, move.which) || !affordable(now)) continue;
      if (move.tile) {
        leave_out(move.which);
      } else {
        take(move.which);
      }
    }
  }

  [[nodiscard]] bool whole(std::uint32_t triangle) const { return taken_[triangle] != 0; }
  [[nodiscard]] double share() const { return all_ > 0 ? left_ / all_ : 0; }

 private:
  const SurfaceCover& cover_;
  double free_share_;
  std::vector<std::uint8_t> taken_, gone_;
  std::vector<std::vector<std::uint32_t>> rests_;  ///< by tile: its triangles
  std::vector<std::uint64_t> tile_bytes_;
  std::vector<double> area_, open_area_;
  double all_ = 0, left_ = 0;
  std::uint64_t bytes_ = 0;
  std::priority_queue<Move, std::vector<Move>, std::greater<>> moves_;

  [[nodiscard]] bool done(bool tile, std::uint32_t which) const {
    return (tile ? gone_[which] : taken_[which]) != 0;
  }

  /// The bytes and the area that are added where a triangle is taken as a whole.
  void add(std::uint32_t triangle, double& bytes, double& area) const {
    if (taken_[triangle] != 0) return;
    bytes += static_cast<double>(triangle_bytes) *
             (1 - static_cast<double>(cover_.open[triangle].size()));
    area += area_[triangle] - open_area_[triangle];
  }

  [[nodiscard]] Move judged(bool tile, std::uint32_t which) const {
    double bytes = 0, area = 0;
    if (tile) {
      for (const std::uint32_t triangle : rests_[which]) add(triangle, bytes, area);
      bytes -= static_cast<double>(tile_bytes_[which]);
    } else {
      add(which, bytes, area);
    }
    const bool worthless = !(bytes < 0) || done(tile, which);
    return {worthless ? std::numeric_limits<double>::infinity() : std::max(area, 0.0) / -bytes,
            area, tile, which};
  }

  void push(bool tile, std::uint32_t which) {
    const Move move = judged(tile, which);
    if (move.price < std::numeric_limits<double>::infinity()) moves_.push(move);
  }

  [[nodiscard]] bool affordable(const Move& move) const {
    if (move.area <= 0) return true;
    const double share = (left_ + move.area) / all_;
    if (share <= free_share_) return true;
    const double own = many_times * static_cast<double>(triangle_bytes * area_.size());
    return share <= max_share && static_cast<double>(bytes_) > std::max(many_bytes, own);
  }

  void take(std::uint32_t triangle) {
    if (taken_[triangle] != 0) return;
    double bytes = 0, area = 0;
    add(triangle, bytes, area);
    taken_[triangle] = 1;
    left_ += area;
    bytes_ = static_cast<std::uint64_t>(std::max(0.0, static_cast<double>(bytes_) + bytes));
    for (const TileUse& use : cover_.uses[triangle]) push(true, use.tile);
  }

  void leave_out(std::uint32_t tile) {
    gone_[tile] = 1;
    bytes_ -= std::min(bytes_, tile_bytes_[tile]);
    for (const std::uint32_t triangle : rests_[tile]) take(triangle);
  }
};

}  // namespace

std::uint64_t tile_bytes(const TileData& tile) {
  return 2 * tile_sample_count + 4 * tile_words + (~tile.valid != 0 ? 8 : 0) +
         (tile.clipped != 0 ? 8 + 4 * tile.clips.size() : 0) + bvh_bytes;
}

ElementChoice choose_elements(const Caster& caster, std::vector<TileData> tiles,
                              const SurfaceCover& cover, double free_share) {
  Chooser chooser(caster, tiles, cover, free_share);
  chooser.run();
  std::vector<std::uint64_t> used(tiles.size(), 0);
  ElementChoice choice;
  for (std::uint32_t t = 0; t < cover.uses.size(); ++t) {
    if (chooser.whole(t)) {
      choice.triangles.push_back(
          {{caster.corner(t, 0), caster.corner(t, 1), caster.corner(t, 2)}, t});
      continue;
    }
    for (const TileUse& use : cover.uses[t]) used[use.tile] |= use.cells;
    choice.triangles.insert(choice.triangles.end(), cover.open[t].begin(), cover.open[t].end());
  }
  trim_tiles(tiles, used);
  choice.tiles = std::move(tiles);
  choice.triangle_area_share = chooser.share();
  return choice;
}

}  // namespace spm::baker
