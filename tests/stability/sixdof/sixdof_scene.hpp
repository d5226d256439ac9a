// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/sixdof/object_contact.hpp"
#include "tests/stability/objects/prepared_object.hpp"
#include "tests/stability/sixdof/sixdof_case.hpp"

namespace spm::stability {

/// How deep a place lies in an object, and which way is out.
struct SampleDepth {
  double depth = 0;                  ///< m, above 0
  Vector3 normal = Vector3::Zero();  ///< unit, outward, the object's frame
};

/// One object as the samples of a tool ask it, one after the other; it may remember what it said of
/// each.
class SampledField {
 public:
  SampledField() = default;
  virtual ~SampledField() = default;
  SampledField(const SampledField&) = delete;
  SampledField& operator=(const SampledField&) = delete;
  /// Of sample number `sample` at a place in the object's frame, m; nothing where it is outside.
  [[nodiscard]] virtual std::optional<SampleDepth> at(std::size_t sample, const Vector3& place) = 0;
};

/// What the finest samples of a tool add up to, on the tool, about its origin, world frame.
struct SampledContact {
  Wrench wrench;
  double deepest = 0;  ///< m
};

/// A case's tool and object as all contestants need them.
class SixdofScene {
 public:
  /// The object is baked, or found baked, when its asset is first asked for; the tool is only
  /// sampled. Throws BakeError. `tried` need not outlive this.
  explicit SixdofScene(const SixdofCase& tried);

  [[nodiscard]] const SurfaceSamples& tool() const noexcept { return tool_; }
  [[nodiscard]] const PreparedObject& object() const noexcept { return *object_; }
  [[nodiscard]] const std::vector<Eigen::Isometry3d>& places() const noexcept { return places_; }
  /// The object's asset at all of its places.
  [[nodiscard]] std::vector<ContactObject> contact_objects() const;
  /// m: no place of the tool is farther from its origin.
  [[nodiscard]] double tool_radius() const noexcept { return tool_radius_; }

  /// The exact surface at each place, which asks only samples that may touch: it remembers how far
  /// each was, and no distance changes by more than a step's length.
  [[nodiscard]] std::vector<std::unique_ptr<SampledField>> exact_fields() const;

  /// Every finest sample of the tool at a pose, asked of one field a place; each pushes with the
  /// stiffness (N/m3) times its area and depth.
  [[nodiscard]] SampledContact contact(const std::vector<std::unique_ptr<SampledField>>& fields,
                                       const Eigen::Isometry3d& pose, double stiffness) const;

  /// The stiffness by area, N/m3, at which the case's touched surface is felt like a spring of
  /// `stiffness` (N/m): pressed in by 2 mm it pushes back with 2 mm times that. By the exact
  /// surface.
  [[nodiscard]] double area_stiffness(double stiffness) const;

 private:
  const PreparedObject* object_;
  std::vector<Eigen::Isometry3d> places_;
  SurfaceSamples tool_;
  double tool_radius_ = 0;
  Eigen::Isometry3d touch_;
  Vector3 press_;
};

/// A case's scene, made once a process. Throws BakeError.
[[nodiscard]] const SixdofScene& sixdof_scene(const SixdofCase& tried);

}  // namespace spm::stability
