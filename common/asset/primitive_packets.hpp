// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "common/asset/cell_packet.hpp"
#include "common/asset/triangle_packet.hpp"

namespace spm {

/// The squared distance given to an empty lane, m^2; still a finite float.
inline constexpr float empty_square = empty_lane * empty_lane;
/// Squares from this value on, m^2, belong to empty lanes: a lane may count in spacings.
inline constexpr float nothing_square = 1e20F;

/// The packets of an index. A number below `cells.size()` names a packet of cells, a higher one a
/// packet of triangles.
struct PrimitivePackets {
  std::span<const CellPacket> cells;
  std::span<const ClipPacket> clips;  ///< of those that have clipped cells
  std::span<const TrianglePacket> triangles;
};

/// Numbers of packets as an index stores them: two of 16 bits per word, or one of 32.
class PackedNumbers {
 public:
  PackedNumbers() noexcept = default;
  PackedNumbers(const std::uint32_t* words, std::size_t count, bool are_small) noexcept
      : words_(words), count_(count), are_small_(are_small) {}
  // NOLINTNEXTLINE(google-explicit-constructor): numbers in memory are names.
  PackedNumbers(std::span<const std::uint32_t> numbers) noexcept
      : PackedNumbers(numbers.data(), numbers.size(), false) {}

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
  [[nodiscard]] PackedNumbers one(std::size_t i, std::uint32_t& kept) const noexcept {
    kept = (*this)[i];
    return {&kept, 1, false};
  }

 private:
  const std::uint32_t* words_ = nullptr;
  std::size_t count_ = 0;
  bool are_small_ = false;
};

/// A primitive of a list of packets: `packet_width` times the packet's place in the list, and the
/// lane.
struct NearestPrimitive {
  std::uint32_t which = 0;
  float square = empty_square;  ///< of its distance, m^2
  float x = 0, y = 0;           ///< on a cell the closest point, from its middle, spacings
  /// The place from the closest point: on a cell in its plane's frame and spacings, on a triangle
  /// m.
  std::array<float, 3> away{};

  [[nodiscard]] bool is_found() const noexcept { return square < nothing_square; }
};

/// Finds the primitive of packets that is nearest to a place (m from the tree's origin): the first
/// of equals, but for rounding. Numbers of no packet are out of all reach. Several primitives at
/// once by whatever the processor has; the same bits on each.
[[nodiscard]] NearestPrimitive nearest_primitive(const PrimitivePackets& packets,
                                                 const PackedNumbers& numbers,
                                                 const std::array<float, 3>& place) noexcept;

/// nearest_primitive of several places, each of its own packets.
void nearest_primitives(const PrimitivePackets& packets, std::span<const PackedNumbers> numbers,
                        std::span<const std::array<float, 3>> places,
                        std::span<NearestPrimitive> found) noexcept;

/// As nearest_primitive, and gives for each packet the square of the distance of its nearest
/// primitive, m^2.
[[nodiscard]] NearestPrimitive nearest_of_packets(const PrimitivePackets& packets,
                                                  const PackedNumbers& numbers,
                                                  const std::array<float, 3>& place,
                                                  float* squares) noexcept;

/// As nearest_primitive, of those primitives whose closest points' own normals meet the place
/// within this cosine.
[[nodiscard]] NearestPrimitive nearest_facing(const PrimitivePackets& packets,
                                              const PackedNumbers& numbers,
                                              const std::array<float, 3>& place,
                                              float cosine) noexcept;

/// Finds the squares of lower bounds of the distances of a place to the primitives of packets, m^2;
/// each packet fills `packet_width` of `squares`, which are aligned as packets are. Gives where the
/// least is. As nearest_primitive else.
[[nodiscard]] std::uint32_t packet_squares(const PrimitivePackets& packets,
                                           const PackedNumbers& numbers,
                                           const std::array<float, 3>& place,
                                           float* squares) noexcept;

/// Lists in `places` which of `count` squares (whole packets) are no larger than `farthest`, in
/// order, and gives how many. What follows them in `places`, up to `count` and a packet more, may
/// be written over.
[[nodiscard]] std::size_t near_lanes(const float* squares, std::size_t count, float farthest,
                                     std::uint32_t* places) noexcept;

}  // namespace spm
