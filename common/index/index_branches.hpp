// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "common/index/index_lists.hpp"
#include "common/index/packet_bounds.hpp"
#include "common/index/primitive_packets_build.hpp"
#include "common/query/closest_element.hpp"

namespace spm {

/// A cube of an index that is being built, and the packets that can matter to its points.
struct IndexCube {
  Vector3 middle = Vector3::Zero();
  double half = 0;  ///< of its edge, m
  SignKind sign = SignKind::far;
  double nearest = std::numeric_limits<double>::infinity();  ///< distance of its middle, m
  bool inside = false;                                       ///< its middle, as votes tell
  PacketNumbers votes;    ///< packets that can matter where votes tell the side
  PacketNumbers facing;   ///< those of them that can matter elsewhere
  PacketNumbers closest;  ///< those of them that may hold the nearest
  bool one_sided = false;
  double nearest_cap = std::numeric_limits<double>::infinity();  ///< of those in `votes`, m
};

/// What an index records of a cube: of its octants, or of the cube as a whole.
struct IndexBranch {
  std::unique_ptr<std::array<IndexBranch, 8>> octants;
  CubeKind kind = CubeKind::unknown;
  IndexLists lists;  ///< empty where nothing is told
  float beyond = 0;  ///< as in IndexList
};

/// Determines what an index records of cubes, one after another. For the loading thread.
class IndexBrancher {
 public:
  /// `asset`: with an index of packets alone, those of `primitives`; `slack`: of the index. Both
  /// stay.
  IndexBrancher(const AssetView& asset, const PrimitivePacketsData& primitives);

  /// Finds what can matter in a cube (`half` of its edge, m), of some packets.
  [[nodiscard]] IndexCube look(const Vector3& middle, double half, const PacketNumbers& some);

  /// What is told of a cube, which is as large as those of the index's grid, at no more cost than
  /// that of so many packets, each looked at once.
  [[nodiscard]] IndexBranch branch_of(const IndexCube& cube, std::size_t budget);

  /// Whether a cube has no place where queries ask for the nearest.
  [[nodiscard]] bool is_beyond(const IndexCube& cube) const;

 private:
  const AssetView& asset_;
  const PrimitivePacketsData& primitives_;
  double min_edge_ = 0;
  double rounding_ = 0;
  std::size_t budget_left_ = 0;
  std::vector<PacketBounds> bounds_;

  [[nodiscard]] ElementReading reading_at(const Vector3& point, const PacketNumbers& some) const;
  [[nodiscard]] double cap_distance(std::uint32_t packet, const Vector3& point) const;
  [[nodiscard]] bool is_worth_splitting(const IndexBranch& branch, double edge) const;
  [[nodiscard]] CubeKind kind_of(const IndexCube& cube) const;
  [[nodiscard]] bool is_far(const IndexCube& cube) const;
  [[nodiscard]] IndexBranch branch_beyond(const IndexCube& cube);
  [[nodiscard]] PacketNumbers nearest_at_corners(const IndexCube& cube) const;
  [[nodiscard]] IndexBranch branch_at(const IndexCube& cube, int level);
  [[nodiscard]] IndexBranch split(const IndexCube& cube, CubeKind kind,
                                  std::array<IndexLists, 8>& lists, int level);
};

}  // namespace spm
