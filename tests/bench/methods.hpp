// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "tests/bench/distance_lattice.hpp"
#include "tests/bench/method.hpp"
#include "tests/bench/model.hpp"

namespace spm::bench {

// One file a method: method_<name>.cpp. Their answers are measured alike, by score().

/// The product: baked to a file in `folder`, mapped, asked as the servo asks it. Bytes of the file.
/// `tolerance` in metres. Throws BakeError.
[[nodiscard]] std::unique_ptr<Method> make_spm(const Model& model, double tolerance,
                                               const std::string& folder);

/// A grid over the band, `cell` metres; each cell lists the triangles that can be closest to a
/// place in it. Bytes: the grid's words, its lists, each kept once, and the indexed mesh.
[[nodiscard]] std::unique_ptr<Method> make_triangle_grid(const Model& model, double cell);

/// Embree's tree and point query. Bytes: what Embree reports to hold, and the indexed mesh.
[[nodiscard]] std::unique_ptr<Method> make_embree(const Model& model, bool compact);

/// Distances in a dense lattice over the model's box, trilinear. Bytes: a float a node.
[[nodiscard]] std::unique_ptr<Method> make_dense_sdf(DistanceLattice lattice);

/// The same distances in OpenVDB's tree, only around the band. Bytes: the tree's own count.
[[nodiscard]] std::unique_ptr<Method> make_openvdb(const DistanceLattice& lattice);

/// An octree of trilinear cells, split where one is off by more than `tolerance` metres (adaptively
/// sampled distance fields, Frisken et al. 2000). Bytes: a word a node, eight floats a leaf.
[[nodiscard]] std::unique_ptr<Method> make_adaptive_sdf(const Model& model, double tolerance);

}  // namespace spm::bench
