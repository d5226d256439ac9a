// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "common/asset/cell_group.hpp"
#include "common/asset/triangle_group.hpp"

namespace spm {

/// The squared distance given to an empty lane, m^2; still a finite float.
inline constexpr float empty_square = empty_lane * empty_lane;
/// Squares from this value on, m^2, belong to empty lanes: a lane may count in spacings.
inline constexpr float nothing_square = 1e20F;

/// The packets of an index. A number below `cells.size()` names a packet of cells, a higher one a
/// packet of triangles.
struct UnitGroups {
  std::span<const CellGroup> cells;
  std::span<const ClipGroup> clips;  ///< of those that have clipped cells
  std::span<const TriangleGroup> triangles;
};

/// Numbers of packets as an index stores them: two of 16 bits per word, or one of 32.
class GroupNames {
 public:
  GroupNames() noexcept = default;
  GroupNames(const std::uint32_t* words, std::size_t count, bool are_small) noexcept
      : words_(words), count_(count), are_small_(are_small) {}
  // NOLINTNEXTLINE(google-explicit-constructor): numbers in memory are names.
  GroupNames(std::span<const std::uint32_t> numbers) noexcept
      : GroupNames(numbers.data(), numbers.size(), false) {}

  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] std::uint32_t operator[](std::size_t i) const noexcept {
    if (!are_small_) return words_[i];
    // The words of a processor whose low halves come first.
    static_assert(std::endian::native == std::endian::little);
    std::uint16_t number = 0;
    std::memcpy(&number, reinterpret_cast<const unsigned char*>(words_) + sizeof number * i,
                sizeof number);
    return number;
  }
  [[nodiscard]] GroupNames one(std::size_t i, std::uint32_t& kept) const noexcept {
    kept = (*this)[i];
    return {&kept, 1, false};
  }

 private:
  const std::uint32_t* words_ = nullptr;
  std::size_t count_ = 0;
  bool are_small_ = false;
};

/// A unit of a list of groups: `group_units` times the group's place in the list, and the lane.
struct NearestUnit {
  std::uint32_t which = 0;
  float square = empty_square;  ///< of its distance, m^2
  float x = 0, y = 0;           ///< on a cell the foot, from its middle, spacings
  /// The place from the foot: on a cell in its plane's frame and spacings, on a triangle m.
  std::array<float, 3> away{};

  [[nodiscard]] bool is_found() const noexcept { return square < nothing_square; }
};

/// Finds the unit of groups that is nearest to a place (m from the tree's origin): the first of
/// equals, but for rounding. Numbers of no group are out of all reach. Several units at once by
/// whatever the processor has; the same bits on each.
[[nodiscard]] NearestUnit nearest_unit(const UnitGroups& groups, const GroupNames& numbers,
                                       const std::array<float, 3>& place) noexcept;

/// nearest_unit of several places, each of its own groups.
void nearest_units(const UnitGroups& groups, std::span<const GroupNames> numbers,
                   std::span<const std::array<float, 3>> places,
                   std::span<NearestUnit> found) noexcept;

/// As nearest_unit, and gives for each group the square of the distance of its nearest unit, m^2.
[[nodiscard]] NearestUnit nearest_of_groups(const UnitGroups& groups, const GroupNames& numbers,
                                            const std::array<float, 3>& place,
                                            float* squares) noexcept;

/// As nearest_unit, of those units whose feet's own normals meet the place within this cosine.
[[nodiscard]] NearestUnit nearest_facing(const UnitGroups& groups, const GroupNames& numbers,
                                         const std::array<float, 3>& place, float cosine) noexcept;

/// Finds the squares of lower bounds of the distances of a place to the units of groups, m^2; each
/// group fills `group_units` of `squares`, which are aligned as groups are. Gives where the least
/// is. As nearest_unit else.
[[nodiscard]] std::uint32_t group_squares(const UnitGroups& groups, const GroupNames& numbers,
                                          const std::array<float, 3>& place,
                                          float* squares) noexcept;

/// Lists in `places` which of `count` squares (whole groups) are no larger than `farthest`, in
/// order, and gives how many. What follows them in `places`, up to `count` and a group more, may be
/// written over.
[[nodiscard]] std::size_t near_lanes(const float* squares, std::size_t count, float farthest,
                                     std::uint32_t* places) noexcept;

}  // namespace spm
