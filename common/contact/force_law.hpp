// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/asset/asset_view.hpp"
#include "common/contact/runtime_smoothing.hpp"
#include "common/paper/paper_force.hpp"
#include "common/query/query.hpp"

namespace spm {

enum class Method : std::uint8_t {
  spm,    ///< the product's penalty form, any asset
  paper,  ///< the paper's equations to the letter, `full` assets and a point probe only
  proxy,  ///< constraint-based, any asset: see proxy.hpp; it keeps a state, so only ContactModel
          ///< offers it
};

/// The settings that a tick's force is computed with; fixed while the loop runs.
struct ForceSettings {
  Method method = Method::spm;
  PaperRule rule = PaperRule::closest_plane;
  double stiffness = 1000;  ///< N/m, 0 or more
  double probe_radius = 0;  ///< m; 0 is a point
};

/// Force on the hand, and the contact that it comes from.
struct ContactForce {
  Vector3 force = Vector3::Zero();   ///< N, asset's frame
  Vector3 normal = Vector3::Zero();  ///< unit, outward; zero where there is no contact
  double depth = 0;                  ///< m, the depth that the force used; 0 without contact
  bool contact = false;
  bool deep = false;  ///< the depth is limited by the band
};

/// Force for a probe centred at `point` (asset's frame, metres): eq. 9, with the depth and normal
/// of the chosen method; `proxy` uses those of `spm`. |force| = stiffness * depth. Never NaN: a
/// point that is not finite gives zero.
[[nodiscard]] ContactForce contact_force(const AssetView& asset, const ForceSettings& settings,
                                         const Vector3& point) noexcept;

/// The same for `spm` with the field smoothed; the force acts along the field's gradient. |force| =
/// stiffness * depth.
[[nodiscard]] ContactForce smoothed_force(const AssetView& asset, const ForceSettings& settings,
                                          const RuntimeSmoothing& smoothing,
                                          const Vector3& point) noexcept;

}  // namespace spm
