// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "tests/bench/geometry/distance_lattice.hpp"
#include "tests/bench/methods/method.hpp"
#include "tests/bench/model/baked_file.hpp"
#include "tests/bench/model/model.hpp"
#include "tests/bench/model/query_asset.hpp"

namespace spm::bench {

// One file per method: method_<name>.cpp. score() measures all answers in the same way.

/// Which bytes of the product are counted.
enum class CountedBytes {
  file,    ///< the baked file
  memory,  ///< the file and the index that is derived from it when it is opened
};

/// The product: a baked file, opened and asked through libspm_query, point by point.
[[nodiscard]] std::unique_ptr<Method> make_spm(const BakedFile& file, QueryAsset asset,
                                               CountedBytes counted);

/// The same, with many points per library call.
[[nodiscard]] std::unique_ptr<Method> make_spm_batch(const BakedFile& file, QueryAsset asset);

/// The same point by point without SIMD. While query_all runs, no thread uses a SIMD kernel. The
/// answers are the same.
[[nodiscard]] std::unique_ptr<Method> make_spm_scalar(const BakedFile& file, QueryAsset asset);

/// The paper's rule: takes the support plane closest to the point among all planes. The distance is
/// D_SP(P_M) - S_SP, uncorrected. Bytes: the planes and their maps. Throws BakeError.
[[nodiscard]] std::unique_ptr<Method> make_paper(const Model& model, std::size_t planes,
                                                 std::uint32_t resolution);

/// A grid over the band with cells of `cell` metres. Each cell lists the triangles that can be
/// closest to a place in it. Bytes: the grid's words, the distinct lists, and the indexed mesh.
[[nodiscard]] std::unique_ptr<Method> make_triangle_grid(const Model& model, double cell);

/// Embree's tree and point query. Bytes: the memory that Embree reports, and the indexed mesh.
[[nodiscard]] std::unique_ptr<Method> make_embree(const Model& model, bool compact);

/// CGAL's AABB tree with its hints, asked for the closest point and triangle. Bytes: triangles,
/// nodes and hints as CGAL stores them, and the data that decides the side.
[[nodiscard]] std::unique_ptr<Method> make_cgal_tree(const Model& model);

/// FCL's distance from a mesh, in a tree of oriented boxes and swept spheres, to a ball of no size.
/// Bytes: its nodes, vertices and triangles, and the data that decides the side.
[[nodiscard]] std::unique_ptr<Method> make_fcl(const Model& model);

/// Bullet's quantised tree of boxes, asked for the triangles in a box about the point that grows
/// until it holds the nearest. Bytes: the tree and the indexed mesh.
[[nodiscard]] std::unique_ptr<Method> make_bullet(const Model& model);

/// Trilinear distances in a dense lattice over the model's box. Bytes: one float per node.
[[nodiscard]] std::unique_ptr<Method> make_dense_sdf(DistanceLattice lattice);

/// The same distances in OpenVDB's tree, only around the band. Bytes: the tree's own count.
[[nodiscard]] std::unique_ptr<Method> make_openvdb(const DistanceLattice& lattice);

/// An octree of trilinear cells, split where one is off by more than `tolerance` metres (adaptively
/// sampled distance fields, Frisken et al. 2000). Bytes: a word a node, eight floats a leaf.
[[nodiscard]] std::unique_ptr<Method> make_adaptive_sdf(const Model& model, double tolerance);

}  // namespace spm::bench
