// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/asset/asset_view.hpp"
#include "common/contact/runtime_smoothing.hpp"
#include "common/paper/paper_force.hpp"
#include "common/paper/paper_probe_force.hpp"
#include "common/paper/probe_shape.hpp"
#include "common/query/query.hpp"

namespace spm {

enum class Method : std::uint8_t {
  spm,    ///< the product's penalty form, any asset
  paper,  ///< the paper's equations to the letter, `full` assets only
  proxy,  ///< constraint-based, any asset: see proxy.hpp; it keeps a state, so only ContactModel
          ///< offers it
};

/// The settings that a tick's force is computed with; fixed while the loop runs.
struct ForceSettings {
  Method method = Method::spm;
  PaperRule rule = PaperRule::closest_plane;  ///< for a point probe; others know the default one
  double stiffness = 1000;                    ///< N/m, 0 or more
  double probe_radius = 0;                    ///< m; 0 is a point
  ProbeKind probe_kind = ProbeKind::ball;     ///< others than balls are of `paper` alone
  PaperProbeForm form = PaperProbeForm::surface;  ///< of `paper`; a point has neither
  double probe_length = 0;                        ///< m, of a capsule (ProbeShape)
  /// Unit, along the probe's long side, in the frame that the force is asked in; for an object of a
  /// scene that of the hand.
  Vector3 probe_axis = Vector3::UnitZ();
  /// d of eq. 12, of `paper` against a tool that is an object; a number, 1 is the material whose
  /// stiffness is given.
  double density = 1;

  [[nodiscard]] ProbeShape probe() const noexcept {
    return {probe_kind, probe_radius, probe_length};
  }
  void take_probe(const ProbeShape& shape) noexcept {
    probe_kind = shape.kind;
    probe_radius = shape.radius;
    probe_length = shape.length;
  }
};

/// Force on the hand, and the contact that it comes from.
struct ContactForce {
  Vector3 force = Vector3::Zero();   ///< N, asset's frame
  Vector3 torque = Vector3::Zero();  ///< N m, about the hand's origin; zero for a point or a ball
  Vector3 normal = Vector3::Zero();  ///< unit, outward; zero where there is no contact
  double depth = 0;                  ///< m, the depth that the force used; 0 without contact
  bool contact = false;
  bool deep = false;  ///< the depth is limited by the band
};

/// Force for a probe centred at `point` (asset's frame, metres): eq. 9, with the depth and normal
/// of the chosen method; `proxy` uses those of `spm`. By `paper` it is for a point eq. 9, and for
/// other probes eq. 11 or its form over the volume, whose mean gives depth and normal. |force| =
/// stiffness * depth. Never NaN: a point that is not finite gives zero. Takes a bounded time
/// (`most_probe_samples`).
[[nodiscard]] ContactForce contact_force(const AssetView& asset, const ForceSettings& settings,
                                         const Vector3& point) noexcept;

/// The same for `spm` with the field smoothed; the force acts along the field's gradient. |force| =
/// stiffness * depth.
[[nodiscard]] ContactForce smoothed_force(const AssetView& asset, const ForceSettings& settings,
                                          const RuntimeSmoothing& smoothing,
                                          const Vector3& point) noexcept;

}  // namespace spm
