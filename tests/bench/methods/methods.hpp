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

// One file a method: method_<name>.cpp. Their answers are measured alike, by score().

/// What counts as the product's bytes.
enum class CountedBytes {
  file,    ///< the baked file
  memory,  ///< and the index that is derived from it when it is opened
};

/// The product: a baked file, opened and asked through libspm_query, point by point.
[[nodiscard]] std::unique_ptr<Method> make_spm(const BakedFile& file, QueryAsset asset,
                                               CountedBytes counted);

/// The same, many points a call of the library.
[[nodiscard]] std::unique_ptr<Method> make_spm_batch(const BakedFile& file, QueryAsset asset);

/// The same point by point without lanes: what query_all asks runs no SIMD kernel, in this thread
/// and in others meanwhile. The same answers.
[[nodiscard]] std::unique_ptr<Method> make_spm_scalar(const BakedFile& file, QueryAsset asset);

/// The paper's rule: the support plane closest to the point, of all planes; the distance is
/// D_SP(P_M) - S_SP, uncorrected. Bytes of the planes and their maps. Throws BakeError.
[[nodiscard]] std::unique_ptr<Method> make_paper(const Model& model, std::size_t planes,
                                                 std::uint32_t resolution);

/// A grid over the band, `cell` metres; each cell lists the triangles that can be closest to a
/// place in it. Bytes: the grid's words, its lists, each kept once, and the indexed mesh.
[[nodiscard]] std::unique_ptr<Method> make_triangle_grid(const Model& model, double cell);

/// Embree's tree and point query. Bytes: what Embree reports to hold, and the indexed mesh.
[[nodiscard]] std::unique_ptr<Method> make_embree(const Model& model, bool compact);

/// CGAL's AABB tree with its hints, asked for the closest point and triangle. Bytes: triangles,
/// nodes and hints as CGAL keeps them, and what tells the side.
[[nodiscard]] std::unique_ptr<Method> make_cgal_tree(const Model& model);

/// FCL's distance of a mesh in a tree of oriented boxes and swept spheres to a ball of no size.
/// Bytes: its nodes, vertices and triangles, and what tells the side.
[[nodiscard]] std::unique_ptr<Method> make_fcl(const Model& model);

/// Bullet's quantised tree of boxes, asked for the triangles in a box about the point that grows
/// until it holds the nearest. Bytes: the tree and the indexed mesh.
[[nodiscard]] std::unique_ptr<Method> make_bullet(const Model& model);

/// Distances in a dense lattice over the model's box, trilinear. Bytes: a float a node.
[[nodiscard]] std::unique_ptr<Method> make_dense_sdf(DistanceLattice lattice);

/// The same distances in OpenVDB's tree, only around the band. Bytes: the tree's own count.
[[nodiscard]] std::unique_ptr<Method> make_openvdb(const DistanceLattice& lattice);

/// An octree of trilinear cells, split where one is off by more than `tolerance` metres (adaptively
/// sampled distance fields, Frisken et al. 2000). Bytes: a word a node, eight floats a leaf.
[[nodiscard]] std::unique_ptr<Method> make_adaptive_sdf(const Model& model, double tolerance);

}  // namespace spm::bench
