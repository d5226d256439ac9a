// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "tests/bench/geometry/cell_triangles.hpp"
#include "tests/bench/geometry/distance_lattice.hpp"
#include "tests/bench/methods/method.hpp"
#include "tests/bench/model/baked_file.hpp"
#include "tests/bench/model/model.hpp"
#include "tests/bench/model/query_asset.hpp"

namespace spm::bench {

// One file per method: method_<name>.cpp. score() measures all answers in the same way.

/// The product: a baked file, opened and asked through libspm_query, point by point.
[[nodiscard]] std::unique_ptr<Method> make_spm(const BakedFile& file, QueryAsset asset);

/// The same, with many points per library call.
[[nodiscard]] std::unique_ptr<Method> make_spm_batch(const BakedFile& file, QueryAsset asset);

/// The same point by point without SIMD. While query_all runs, no thread uses a SIMD kernel. The
/// answers are the same.
[[nodiscard]] std::unique_ptr<Method> make_spm_scalar(const BakedFile& file, QueryAsset asset);

/// The paper's rule: takes the support plane closest to the point among all planes. The distance is
/// D_SP(P_M) - S_SP, uncorrected. Bytes: the planes and their maps. Throws BakeError.
[[nodiscard]] std::unique_ptr<Method> make_paper(const Model& model, std::size_t planes,
                                                 std::uint32_t resolution);

/// What a cell of a triangle grid lists.
enum class GridLists {
  own,     ///< packets of its own triangles, in a row
  shared,  ///< numbers of packets of neighbours, which cells share
};

/// A grid over the band, each cell with the triangles that can be closest to a place in it, in
/// packets of eight float lanes; equal lists are kept once. A file holds the mesh, the lists as
/// numbers of triangles and a word a cell.
[[nodiscard]] std::unique_ptr<Method> make_triangle_grid(const Model& model,
                                                         const CellTriangles& cells,
                                                         GridLists lists);

/// How Embree builds its tree.
enum class EmbreeTree : std::uint8_t { compact, standard, high_quality };

/// Embree's tree and point query. Resident: the memory that Embree reports, and the sided mesh. For
/// this and all below that keep the triangles a file holds the indexed mesh, and opening builds.
[[nodiscard]] std::unique_ptr<Method> make_embree(const Model& model, EmbreeTree kind);

/// CGAL's AABB tree with hints, asked for the closest point and triangle.
[[nodiscard]] std::unique_ptr<Method> make_cgal_tree(const Model& model);

/// FCL's distance from a mesh, in a tree of oriented boxes and swept spheres, to a ball of no size.
[[nodiscard]] std::unique_ptr<Method> make_fcl(const Model& model);

/// Bullet's quantised tree of boxes, asked for the triangles in a box about the point.
[[nodiscard]] std::unique_ptr<Method> make_bullet(const Model& model);

/// Trilinear distances in a dense lattice over the model's box. Bytes: one float per node. Any
/// number of threads may ask it.
[[nodiscard]] std::unique_ptr<Method> make_dense_sdf(DistanceLattice lattice);

/// The same distances in OpenVDB's tree, only around the band. Bytes: the tree's own count.
[[nodiscard]] std::unique_ptr<Method> make_openvdb(const DistanceLattice& lattice);

/// How NanoVDB stores a voxel.
enum class NanoVoxel : std::uint8_t {
  float32,   ///< as it is
  fixed16,   ///< 16 bits between the extremes of 8x8x8 voxels
  fixed8,    ///< 8 bits
  variable,  ///< as many bits as each 8x8x8 voxels need for an error that NanoVDB chooses
};

/// The same tree as NanoVDB stores it, in one piece that a file holds as it is.
[[nodiscard]] std::unique_ptr<Method> make_nanovdb(const DistanceLattice& lattice, NanoVoxel voxel);

/// An octree of trilinear cells, split where one is off by more than `tolerance` metres (adaptively
/// sampled distance fields, Frisken et al. 2000). Bytes: a word a node, eight floats a leaf. Throws
/// BakeError where it would hold more than a gigabyte.
[[nodiscard]] std::unique_ptr<Method> make_adaptive_sdf(const Model& model, double tolerance);

/// Reports ask `hp-sdf` for so small a share of a tolerance as a root mean square.
inline constexpr double hp_share = 1.0 / 16;

/// An octree of polynomials whose degree and cell adapt (Koschier, Deul and Bender, "Hierarchical
/// hp-Adaptive Signed Distance Fields", 2016): orthonormal Legendre terms by Gauss's quadrature; a
/// cell's error is estimated by its terms of the highest degree, and the worst cell is refined by a
/// degree or by octants, whichever gains more for each term, until the estimated root mean square
/// over the cells is `rms` metres. Bytes: a word a node, floats for degree and terms. Beyond theirs
/// it leaves out cubes beyond the band, as ours does. Throws BakeError as the one above.
[[nodiscard]] std::unique_ptr<Method> make_hp_sdf(const Model& model, double rms);

}  // namespace spm::bench
