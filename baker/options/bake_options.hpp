// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>

#include "baker/base/oriented_box.hpp"
#include "baker/planes/planes.hpp"
#include "baker/smooth/smooth_options.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

enum class Layers { automatic, scalar, limited };

/// Options of a bake as the command line gives them, SI.
struct BakeOptions {
  AssetForm form = AssetForm::sparse;
  std::optional<double> tolerance;  ///< sparse only; default a thousandth of the diagonal
  double max_depth = 0.002;
  std::optional<double> margin;  ///< default probe radius + max_depth / 4
  double probe_radius = 0;
  /// m, from the middle of a sheet to what is felt of it; default the tolerance.
  std::optional<double> sheet_thickness;
  std::optional<OrientedBox> workspace;  ///< where the device's tool can be, asset's frame
  PlaneKind kind = PlaneKind::automatic;
  std::optional<std::size_t> planes;  ///< full only
  std::uint32_t resolution = 65;      ///< full only: samples a side of each map, 2 to 4097
  Layers layers = Layers::automatic;
  std::uint32_t layer_limit = 0;  ///< with Layers::limited, 1 to 255
  SmoothOptions smooth;           ///< of the mesh, before anything else
  SmoothOptions smooth_maps;      ///< full only: of the distance maps
  /// sparse only, rad: how far directions may be off, see OctreeRules; 4 degrees.
  double direction_tolerance = 4 * std::numbers::pi / 180;
  /// The most bytes of a `sparse` file; empty where the bake decides what is worth it.
  std::optional<std::uint64_t> max_bytes;
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< 0: as many as there are cores; never changes the output
};

}  // namespace spm::baker
