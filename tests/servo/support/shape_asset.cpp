// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/support/shape_asset.hpp"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "common/base/octahedral.hpp"
#include "common/query/query.hpp"
#include "common/surface/closest_on_triangle.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "formats/asset/asset_writer.hpp"
#include "tests/support/triangle_octree.hpp"

namespace spm::test {

namespace {

constexpr Band band{2e-3, 1e-3};
constexpr double cell_size = 2e-3;

Vector3 corner(const Asset& asset, std::size_t triangle, std::size_t which) {
  const float* at = asset.triangles.data() + triangle * 9 + which * 3;
  return {at[0], at[1], at[2]};
}

std::uint32_t cell_word(CellKind kind, std::uint32_t payload) {
  return (static_cast<std::uint32_t>(kind) << 30U) | payload;
}

/// The whole shape in one cell: exact, and slow.
Asset one_cell(const Asset& asset, std::size_t triangles, const Vector3& low, double size) {
  Asset whole = asset;
  whole.grid.origin = low;
  whole.grid.cell_size = size;
  whole.grid.cells = {1, 1, 1};
  whole.grid.index = {cell_word(CellKind::record, 0)};
  whole.grid.records = {list_header(0, static_cast<std::uint32_t>(triangles))};
  for (std::uint32_t i = 0; i < triangles; ++i) whole.grid.records.push_back(2 * i);
  whole.metadata.band = {1e3, 1e3};
  return whole;
}

/// Fills a cell: the triangles that can be the closest one to a point in it.
void add_cell(Asset& asset, std::size_t triangles, const AssetView& exact, const Vector3& centre) {
  const double reach = asset.grid.cell_size * std::sqrt(3.0) / 2;
  const Answer answer = query_point(exact, centre);
  if (answer.distance > reach + band.margin) {
    asset.grid.index.push_back(cell_word(CellKind::far, 0));
    return;
  }
  if (answer.distance < -reach - band.max_depth) {
    asset.grid.index.push_back(cell_word(CellKind::deep, pack_octahedral(answer.normal)));
    return;
  }
  asset.grid.index.push_back(
      cell_word(CellKind::record, static_cast<std::uint32_t>(asset.grid.records.size())));
  const std::size_t header = asset.grid.records.size();
  asset.grid.records.push_back(0);
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Vector3 nearest =
        closest_on_triangle(centre, corner(asset, i, 0), corner(asset, i, 1), corner(asset, i, 2));
    if ((centre - nearest).norm() > std::abs(answer.distance) + 2.1 * reach) continue;
    asset.grid.records.push_back(2 * i);
    ++count;
  }
  asset.grid.records[header] = list_header(0, count);
}

MapData flat_map(std::uint32_t plane, double size) {
  MapData map;
  map.plane = plane;
  map.columns = 5;
  map.rows = 5;
  map.spacing = size / 4;
  map.samples.assign(25, 0.0F);
  map.mask.assign(mask_words(5, 5, 1), ~0U);
  return map;
}

/// A shape's triangles and description, without a partition.
Asset describe(const Shape& shape) {
  Asset asset;
  AssetMetadata& metadata = asset.metadata;
  metadata.kind = "vertex";
  metadata.mesh_sha256 = std::string(64, '0');
  metadata.options = "{}";
  metadata.band = band;
  metadata.probe_radius = 0.5e-3;
  metadata.tolerance = 1e-6;
  metadata.tolerance_met = true;
  metadata.closed = true;
  metadata.mesh_triangles = shape.triangles.size();
  metadata.box_min = metadata.box_max = shape.vertices.front();
  for (const Vector3& vertex : shape.vertices) {
    metadata.box_min = metadata.box_min.cwiseMin(vertex);
    metadata.box_max = metadata.box_max.cwiseMax(vertex);
  }
  metadata.diagonal = (metadata.box_max - metadata.box_min).norm();
  metadata.fallback_cells = 1;
  for (const auto& triangle : shape.triangles) {
    for (const std::uint32_t vertex : triangle) {
      for (int axis = 0; axis < 3; ++axis) {
        asset.triangles.push_back(static_cast<float>(shape.vertices[vertex][axis]));
      }
    }
  }

  return asset;
}

/// Fills the grid of a `full` asset whose answers come from its triangles.
void fill_grid(Asset& asset) {
  const AssetMetadata& metadata = asset.metadata;
  const std::size_t triangles = asset.triangles.size() / 9;
  asset.grid.cell_size = cell_size;
  asset.grid.origin = metadata.box_min - Vector3::Constant(band.margin + cell_size);
  const Vector3 size = metadata.box_max - asset.grid.origin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    asset.grid.cells[axis] = static_cast<std::uint32_t>(
        std::ceil((size[static_cast<Eigen::Index>(axis)] + band.margin + cell_size) / cell_size));
  }
  const Asset exact = one_cell(asset, triangles, asset.grid.origin, 2 * metadata.diagonal + 0.1);
  const AssetTables exact_tables = tables_of(exact);
  const auto& cells = asset.grid.cells;
  for (std::uint32_t z = 0; z < cells[2]; ++z) {
    for (std::uint32_t y = 0; y < cells[1]; ++y) {
      for (std::uint32_t x = 0; x < cells[0]; ++x) {
        add_cell(asset, triangles, exact_tables.view(),
                 asset.grid.origin + cell_size * Vector3(x + 0.5, y + 0.5, z + 0.5));
      }
    }
  }
}

}  // namespace

Asset shape_asset(const Shape& shape) {
  Asset asset = describe(shape);
  asset.triangles.clear();
  const double margin = band.margin + 2e-3;
  const AssetMetadata& metadata = asset.metadata;
  asset.octree =
      triangle_octree(shape,
                      {.low = metadata.box_min - Vector3::Constant(margin),
                       .edge = (metadata.box_max - metadata.box_min).maxCoeff() + 2 * margin},
                      metadata.tolerance.value());
  return asset;
}

Asset box_asset(double size) {
  Asset asset = describe(box(Vector3::Constant(size)));
  asset.metadata.form = AssetForm::full;
  fill_grid(asset);
  asset.metadata.kind = "face";
  asset.metadata.tolerance.reset();
  asset.metadata.layers_max = 1;
  for (int face = 0; face < 6; ++face) {
    Vector3 normal = Vector3::Zero();
    normal[face / 2] = face % 2 == 0 ? 1 : -1;
    SupportPlane plane = plane_with_normal(Vector3::Zero(), normal);
    plane.x0 = size / 2 * (normal - plane.u - plane.v);
    asset.planes.push_back(plane);
    asset.maps.push_back(flat_map(static_cast<std::uint32_t>(face), size));
  }
  return asset;
}

TemporaryFolder::TemporaryFolder() {
  path_ = (std::filesystem::temp_directory_path() / "spm-servo-XXXXXX").string();
  if (mkdtemp(path_.data()) == nullptr) throw std::runtime_error("cannot make " + path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void write(const Asset& asset, const std::string& path) {
  const auto written = write_asset(asset, path);
  if (!written) throw std::runtime_error(written.error().message);
}

}  // namespace spm::test
