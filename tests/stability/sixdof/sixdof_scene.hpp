// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/sixdof/surface_samples.hpp"
#include "formats/asset/asset.hpp"
#include "tests/stability/objects/prepared_object.hpp"
#include "tests/stability/sixdof/sixdof_case.hpp"

namespace spm::stability {

/// How deep a place lies in an object, and which way is out.
struct SampleDepth {
  double depth = 0;                  ///< m, above 0
  Vector3 normal = Vector3::Zero();  ///< unit, outward, the object's frame
};

/// One object, as the samples of a tool query it, one after the other. It may remember its last
/// answer for each sample.
class SampledField {
 public:
  SampledField() = default;
  virtual ~SampledField() = default;
  SampledField(const SampledField&) = delete;
  SampledField& operator=(const SampledField&) = delete;
  /// Depth and normal for sample number `sample` at a place in the object's frame, m; nothing where
  /// the place is outside.
  [[nodiscard]] virtual std::optional<SampleDepth> at(std::size_t sample, const Vector3& place) = 0;
};

/// The summed contact of a tool's finest samples: the wrench on the tool about its origin, world
/// frame.
struct SampledContact {
  Wrench wrench;
  double deepest = 0;  ///< m
};

/// A case's tool and object as all contestants need them.
class SixdofScene {
 public:
  /// The object is baked, or loaded if already baked, when its asset is first asked for; the tool
  /// is only sampled. Throws BakeError. `tried` need not outlive this.
  explicit SixdofScene(const SixdofCase& tried);

  [[nodiscard]] const SurfaceSamples& tool() const noexcept { return tool_; }
  /// The tool as an asset, for the servo to sample. It knows nothing of its inside.
  [[nodiscard]] const AssetView& tool_asset() const noexcept { return tool_tables_.view(); }
  /// The tool's planes and maps, as method paper needs them. Made when it is first asked for.
  [[nodiscard]] const AssetView& paper_tool() const { return tool_object_->paper(); }
  [[nodiscard]] const PreparedObject& object() const noexcept { return *object_; }
  [[nodiscard]] const std::vector<Eigen::Isometry3d>& places() const noexcept { return places_; }
  /// Largest distance of a place of the tool from its origin, m.
  [[nodiscard]] double tool_radius() const noexcept { return tool_radius_; }

  /// The exact surface, one field for each place of the object. It is queried only for samples that
  /// may touch: each field remembers how far each sample was, and a distance cannot change by more
  /// than the sample has moved.
  [[nodiscard]] std::vector<std::unique_ptr<SampledField>> exact_fields() const;

  /// Sums over every finest sample of the tool at a pose, with one field for each place of the
  /// object. Each sample pushes with the stiffness (N/m3) times its area and its depth.
  [[nodiscard]] SampledContact contact(const std::vector<std::unique_ptr<SampledField>>& fields,
                                       const Eigen::Isometry3d& pose, double stiffness) const;

  /// The stiffness by area, N/m3, at which the case's touched surface feels like a spring of
  /// `stiffness` (N/m): pressed in by the case's compared depth, it pushes back with that times
  /// `stiffness`. Computed with the exact surface.
  [[nodiscard]] double area_stiffness(double stiffness) const;
  /// How fast that push grows there, N per metre: more than `stiffness`, since more samples press.
  [[nodiscard]] double steepness(double stiffness) const;

 private:
  const PreparedObject *object_, *tool_object_;
  std::vector<Eigen::Isometry3d> places_;
  Asset tool_asset_;
  AssetTables tool_tables_;  ///< of that asset
  SurfaceSamples tool_;
  double tool_radius_ = 0;
  Eigen::Isometry3d touch_;
  Vector3 press_;
  double compared_depth_;
};

/// A case's scene, made once per process. Throws BakeError.
[[nodiscard]] const SixdofScene& sixdof_scene(const SixdofCase& tried);

}  // namespace spm::stability
