// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/asset/asset_view.hpp"
#include "common/paper/implicit_probe.hpp"

namespace spm {

/// The force on a probe by the samples of one support plane's map under it.
struct PaperProbeForce {
  Vector3 force = Vector3::Zero();  ///< on the probe, N, object's frame: eq. 11
  Vector3 far = Vector3::Zero();    ///< F_S+, mean over N+, N: eq. 10
  Vector3 near = Vector3::Zero();   ///< F_S-, likewise for the side closer to the plane
  std::uint32_t far_count = 0;      ///< N+: samples where S+ lies under the surface
  std::uint32_t near_count = 0;     ///< N-
};

/// The force on the surface of a probe, eq. 10 and 11, from the scalar map (layer 0) of the support
/// plane that is closest to its centre (section 5.2), of a `full` asset; zero where no sample of it
/// is under the surface. Stiffness in N/m.
///
/// Eq. 10 takes max(S+ - S_SP, 0). S_SP is the support plane itself there, which no point of the
/// object is over, so that every sample would push; the surface is meant, D_SP below the plane, as
/// in eq. 3. S+ and S- are measured from the plane as D_SP is. N_total of eq. 11, which the paper
/// does not define, is N+ plus N-.
[[nodiscard]] PaperProbeForce paper_probe_force(const AssetView& asset, const ImplicitProbe& probe,
                                                double stiffness) noexcept;

/// The form over the probe's volume that section 3.2 sketches: the mean of k times the depth under
/// the surface over all of the probe that lies there, along the surface's normals; eq. 10 with one
/// more integral, along the plane's normal, which is taken in closed form. N.
[[nodiscard]] Vector3 paper_probe_volume_force(const AssetView& asset, const ImplicitProbe& probe,
                                               double stiffness) noexcept;

}  // namespace spm
