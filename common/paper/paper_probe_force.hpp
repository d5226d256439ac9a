// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/asset/asset_view.hpp"
#include "common/paper/implicit_probe.hpp"

namespace spm {

/// Over what a probe's force is the mean (section 3.2).
enum class PaperProbeForm : std::uint8_t {
  surface,  ///< eq. 10 and 11
  volume,   ///< the triple integral that follows them
};

/// The force on a probe from the samples of one support plane's map that lie under it.
struct PaperProbeForce {
  Vector3 force = Vector3::Zero();  ///< on the probe, N, object's frame: eq. 11
  Vector3 far = Vector3::Zero();    ///< F_S+, mean over N+, N: eq. 10
  Vector3 near = Vector3::Zero();   ///< F_S-, the same for the side closer to the plane
  std::uint32_t far_count = 0;      ///< N+: samples where S+ lies under the surface
  std::uint32_t near_count = 0;     ///< N-
};

/// The force on the surface of a probe, eq. 10 and 11, in a `full` asset. It uses the scalar map
/// (layer 0) of the support plane closest to the probe's centre (section 5.2). Zero where no sample
/// of the probe is under the surface. Stiffness in N/m.
///
/// Eq. 10 takes max(S+ - S_SP, 0). Read literally, S_SP is the support plane itself. No point of
/// the object is above that plane, so every sample would push. The surface is meant, at D_SP below
/// the plane, as in eq. 3. S+ and S- are measured from the plane, as D_SP is. The paper does not
/// define N_total of eq. 11; here it is N+ plus N-. n_S is that of eq. 5, not of unit length, as
/// eq. 10 writes it and eq. 9 does not: where the surface is inclined by 30 degrees against the
/// plane, the force is 15 % more than along a unit normal, and on top of that the depth is measured
/// along the plane's.
///
/// The sum runs over a lattice of at most about `most_probe_samples` places (ProbeFootprint), so
/// that its time has a bound.
[[nodiscard]] PaperProbeForce paper_probe_force(const AssetView& asset, const ImplicitProbe& probe,
                                                double stiffness) noexcept;

/// The form over the probe's volume that section 3.2 sketches, N: the mean of k times the depth
/// under the surface over the submerged part of the probe, along n_S of eq. 5. It is eq. 10 with
/// one more integral along the plane's normal, which is evaluated in closed form.
[[nodiscard]] Vector3 paper_probe_volume_force(const AssetView& asset, const ImplicitProbe& probe,
                                               double stiffness) noexcept;

}  // namespace spm
