// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/asset/asset_view.hpp"

namespace spm {

/// Ways to read section 5.2, which only says that distances are estimated for all support planes
/// and that forces are calculated for the closer one.
enum class PaperRule : std::uint8_t {
  closest_plane,    ///< the plane closest to the point, smallest S_SP; the default reading
  closest_surface,  ///< the plane whose mapped surface is closest, smallest |S_SP - D_SP|
  all_planes,       ///< contact only where every plane reports it; uses the smallest depth
  partition,        ///< as closest_plane, among those that the partition of space has for the place
};
/// As options and scenes name them, in that order.
inline constexpr std::array<const char*, 4> paper_rule_words{"closest-plane", "closest-surface",
                                                             "all-planes", "partition"};

/// Result of the paper's rule at a point.
struct PaperContact {
  bool contact = false;
  std::uint32_t plane = 0;
  double plane_depth = 0;            ///< S_SP, m, positive inside
  double surface_distance = 0;       ///< D_SP(P_M), m
  double depth = 0;                  ///< S_SP - D_SP(P_M), uncorrected, m; 0 without contact
  Vector3 normal = Vector3::Zero();  ///< n_S / |n_S| of eq. 5
};

/// Index of the plane closest to the point, that is with the smallest S_SP; the lowest index in a
/// tie. Evaluates all planes. `asset` must be a `full` one.
[[nodiscard]] std::size_t closest_support_plane(const AssetView& asset,
                                                const Vector3& point) noexcept;

/// The same among the planes whose maps the grid's cell around the point lists: the partition of
/// space that section 5.2 proposes in place of all planes. All of them where it lists none.
[[nodiscard]] std::size_t closest_plane_of_cell(const AssetView& asset,
                                                const Vector3& point) noexcept;

/// Contact by the paper's rule on the scalar map (layer 0) of a `full` asset, eq. 3 to 8. The point
/// is in the asset's frame, metres.
[[nodiscard]] PaperContact paper_contact(const AssetView& asset, const Vector3& point,
                                         PaperRule rule) noexcept;

/// The same for a plane that was chosen before: the part of paper_contact that follows the search.
/// `plane` must be one of the asset's.
[[nodiscard]] PaperContact paper_contact_on_plane(const AssetView& asset, std::size_t plane,
                                                  const Vector3& point) noexcept;

/// Magnitude of the penalty force, N: eq. 3. It is not zero outside contact; the caller must test
/// for contact.
[[nodiscard]] double paper_force_magnitude(double stiffness, double plane_depth,
                                           double surface_distance) noexcept;

/// Force on the hand, N: eq. 9 where there is contact, zero elsewhere. Stiffness in N/m.
[[nodiscard]] Vector3 paper_force(const PaperContact& contact, double stiffness) noexcept;

}  // namespace spm
