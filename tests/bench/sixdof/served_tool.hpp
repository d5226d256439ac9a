// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "servo/force/scene_force.hpp"
#include "tests/bench/sixdof/sixdof_scene.hpp"

namespace spm::bench {

/// A tool in the servo's own force law, as `spm-servo run` calls it: SceneForce, with one object,
/// without stabilization. `spm` has no cap that could be met; `proxy` has 12 N and 0.6 N m.
class ServedTool {
 public:
  /// `spacing`: m, of the tool's samples. `area_stiffness`: N/m3 for method `spm`; the coupling of
  /// `proxy` is 1000 N/m. `limit`: s of a tick, 0: none. Throws BakeError.
  ServedTool(const BakedObject& tool, const BakedObject& object, double spacing, Method method,
             double area_stiffness, double limit);

  /// Forgets all.
  void begin();
  /// Force and torque about the tool's origin.
  [[nodiscard]] Wrench ask(const Eigen::Isometry3d& pose);

  [[nodiscard]] const ForceEffort& effort() const noexcept { return force_->effort(); }
  [[nodiscard]] std::size_t patches() const noexcept { return force_->tool().patch_count; }
  [[nodiscard]] std::size_t bytes() const noexcept { return sampled_->bytes(); }
  [[nodiscard]] std::size_t levels() const noexcept { return sampled_->samples().levels.size(); }
  [[nodiscard]] std::uint64_t samples() const noexcept {
    return sampled_->samples().levels.back().count;
  }

 private:
  std::array<const AssetView*, 2> assets_;
  ForceScene scene_;
  std::unique_ptr<SampledTool> sampled_;
  std::unique_ptr<SceneForce> force_;
  double limit_;
};

}  // namespace spm::bench
