// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "tests/bench/model/float_mesh.hpp"

namespace spm::bench {

inline constexpr std::size_t packet_triangles = 8;

/// Eight triangles, one a lane: a corner, the sides to the other two, and what their closest points
/// need again and again. Lanes without a triangle are out of all reach.
struct alignas(32) TriangleLanes {
  using Row = std::array<float, packet_triangles>;
  std::array<Row, 3> corner, side, other;
  Row per_side, per_other, per_third;              ///< over the sides' squared lengths
  Row side_side, side_other, other_other;          ///< of the inverse of their products
  std::array<std::uint32_t, packet_triangles> id;  ///< the triangle's number in the mesh
};

/// Up to eight triangles of a mesh as one packet.
[[nodiscard]] TriangleLanes make_packet(const FloatMesh& mesh,
                                        std::span<const std::uint32_t> triangles);

/// The number of the triangle that is nearest to a place, in floats and lanes. There must be a
/// packet.
[[nodiscard]] std::uint32_t nearest_in_packets(std::span<const TriangleLanes> packets,
                                               const std::array<float, 3>& place) noexcept;

/// The same of those among `packets` that `numbers` names.
[[nodiscard]] std::uint32_t nearest_in_packets(const TriangleLanes* packets,
                                               std::span<const std::uint32_t> numbers,
                                               const std::array<float, 3>& place) noexcept;

}  // namespace spm::bench
