// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/model/model.hpp"

#include <utility>

#include "baker/base/bake_error.hpp"

namespace spm::bench {
namespace {

[[noreturn]] void refuse(const baker::Mesh& mesh) {
  throw baker::BakeError(ExitCode::invalid_input,
                         mesh.path +
                             ": no part of its surface bounds a solid; close the mesh, or give it "
                             "a thickness");
}

baker::OuterSurface solid_surface(const baker::Mesh& mesh, double narrow) {
  baker::OuterSurface surface = baker::outer_surface(mesh, narrow);
  if (surface.solid_count == 0) refuse(mesh);
  return surface;
}

}  // namespace

Model::Model(const ModelSource& source, baker::Mesh loaded)
    : name(source.name),
      tolerance(source.tolerance),
      mesh(std::move(loaded)),
      surface(solid_surface(mesh, baker::narrow_share * tolerance)),
      caster(surface),
      truth(mesh, 0, tolerance) {
  if (truth.empty()) refuse(mesh);
}

}  // namespace spm::bench
