// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/asset/asset_view.hpp"
#include "tests/bench/methods/method.hpp"
#include "tests/bench/model/float_mesh.hpp"
#include "tests/bench/model/model.hpp"
#include "tests/stability/objects/stability_case.hpp"

namespace spm::stability {

/// Cell size of the rivals' distance field, m: as for a field of 200 cells over a model of 100 mm.
/// This is finer than the bytes of our assets would pay for, so that the field does not lose
/// because of its budget.
inline constexpr double field_cell = 0.5e-3;

/// A case's object as all contenders need it. Each part is made when it is first asked for, and
/// kept; any number of threads may ask. Baked files outlive the process: see asset_cache.hpp.
class PreparedObject {
 public:
  /// Throws BakeError where the mesh cannot be read or bounds no solid.
  explicit PreparedObject(const StabilityCase& tried);
  ~PreparedObject();
  PreparedObject(const PreparedObject&) = delete;
  PreparedObject& operator=(const PreparedObject&) = delete;

  /// The mesh, its outer surface and the exact surface; the band is that of the case's bake.
  [[nodiscard]] const bench::Model& model() const;
  /// The product's asset, `sparse`. Throws BakeError.
  [[nodiscard]] const AssetView& sparse() const;
  [[nodiscard]] std::uint64_t sparse_bytes() const;  ///< of its file
  /// The planes and maps that `paper` needs, as a `full` bake makes them. The bake's partition of
  /// space is left out: the paper does not know it, and it takes the longest. Throws BakeError.
  [[nodiscard]] const AssetView& paper() const;
  /// The triangles as they are stored by a method that keeps them.
  [[nodiscard]] const bench::FloatMesh& float_mesh() const;
  /// Trilinear distances with cells of field_cell over the band.
  [[nodiscard]] const bench::Method& distance_field() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// A case's object, made once per process for all cases that share it. Throws BakeError.
[[nodiscard]] const PreparedObject& prepared_object(const StabilityCase& tried);

/// Why a case's object is not available: the shared meshes are missing (SPM_SHARED). Empty where it
/// is available.
[[nodiscard]] std::string why_unprepared(const StabilityCase& tried);

}  // namespace spm::stability
