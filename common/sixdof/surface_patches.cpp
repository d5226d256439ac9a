// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/surface_patches.hpp"

#include <cmath>
#include <cstdint>
#include <string>

#include "common/contour/line_crossings.hpp"
#include "common/sixdof/sample_vectors.hpp"

namespace spm {

namespace {

constexpr std::size_t most_lines = std::size_t{1} << 24U;
/// Lines that are nearly along the surface tell nothing of its area.
constexpr double least_slope = 0.05;
/// So many that only a broken file needs more: ten seconds.
constexpr std::size_t most_queries = std::size_t{1} << 28U;

Result<std::vector<SurfacePatch>> too_many() {
  return fail(ExitCode::invalid_input,
              "surface samples: the surface would take too many pieces of this size; give a larger "
              "spacing, or bake the mesh again where its surface is not as large");
}

}  // namespace

Result<std::vector<SurfacePatch>> surface_patches(const AssetView& asset, double step) {
  if (asset.full) {
    return fail(ExitCode::invalid_input,
                "surface samples: the asset is `full`, whose maps show a place many times; bake "
                "the mesh with --form sparse");
  }
  if (!(step > 0)) {
    return fail(ExitCode::usage, "surface samples: the step must be above 0; give a length in m");
  }
  const LineLattice lattice = line_lattice(asset, step);
  if (lattice.lines() > most_lines) return too_many();
  std::vector<SurfacePatch> patches;
  CrossingSearch search(asset, most_queries);
  for (int axis = 0; axis < 3; ++axis) {
    const int across = (axis + 1) % 3, up = (axis + 2) % 3;
    const double area = lattice.step[across] * lattice.step[up];
    Vector3 through = lattice.low;
    for (std::uint32_t j = 0; j < lattice.count[static_cast<std::size_t>(up)]; ++j) {
      through[up] = lattice.place(up, j);
      for (std::uint32_t i = 0; i < lattice.count[static_cast<std::size_t>(across)]; ++i) {
        through[across] = lattice.place(across, i);
        for (const SurfaceCrossing& crossing : search.along(axis, through)) {
          const double slope = std::abs(crossing.normal[axis]);
          if (slope < least_slope) continue;
          patches.push_back({floats_of(crossing.place), floats_of(crossing.normal),
                             static_cast<float>(area * slope)});
        }
      }
    }
  }
  if (search.exhausted()) return too_many();
  if (patches.empty()) {
    return fail(ExitCode::invalid_input,
                "surface samples: the asset has no surface; bake a mesh that bounds a solid");
  }
  return patches;
}

}  // namespace spm
