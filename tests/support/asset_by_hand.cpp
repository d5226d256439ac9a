// SPDX-License-Identifier: Apache-2.0
#include "asset_by_hand.hpp"

#include <algorithm>
#include <cmath>

#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/triangle_octree.hpp"

namespace spm::test {

MapByHand map_by_hand(std::uint32_t plane, std::uint32_t columns, std::uint32_t rows,
                      std::uint32_t layers, double eta0, double omega0, double spacing,
                      const Heights& heights) {
  MapByHand made;
  for (std::uint32_t layer = 0; layer < layers; ++layer) {
    made.offsets.push_back(layer * columns * rows);
    for (std::uint32_t row = 0; row < rows; ++row) {
      for (std::uint32_t column = 0; column < columns; ++column) {
        made.samples.push_back(
            static_cast<float>(heights(layer, eta0 + column * spacing, omega0 + row * spacing)));
      }
    }
  }
  made.mask.assign(mask_words(columns, rows, layers), 0xFFFFFFFFU);
  made.map = {nullptr, nullptr, nullptr, plane,  columns, rows,
              layers,  columns, eta0,    omega0, spacing};
  return made;
}

BoxByHand::BoxByHand(const Vector3& size, const Band& band) {
  const Vector3 half = size / 2;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      const Vector3 normal = side * Vector3::Unit(axis);
      SupportPlane plane = plane_with_normal(normal * half[axis], normal);
      const double width = plane.u.cwiseAbs().dot(size);
      const double height = plane.v.cwiseAbs().dot(size);
      const double extent = std::max(width, height);
      plane.x0 += -extent / 2 * plane.u - extent / 2 * plane.v;
      const double thickness = size[axis];
      const auto inside = [=](double eta, double omega) {
        return std::abs(eta - extent / 2) <= width / 2 * (1 + 1e-9) &&
               std::abs(omega - extent / 2) <= height / 2 * (1 + 1e-9);
      };
      by_hand.push_back(map_by_hand(static_cast<std::uint32_t>(planes.size()), 17, 17, 2, 0, 0,
                                    extent / 16,
                                    [=](std::uint32_t layer, double eta, double omega) -> double {
                                      if (!inside(eta, omega)) return no_hit;
                                      return layer == 0 ? 0 : thickness;
                                    }));
      planes.push_back(plane);
    }
  }
  index = {static_cast<std::uint32_t>(CellKind::record) << 30U};
  records = {list_header(6, 0), 0, 1, 2, 3, 4, 5};
  view.band = band;
  view.full = true;
  view.grid.origin = -half - Vector3::Constant(band.margin);
  view.grid.cell_size = size.maxCoeff() + 2 * band.margin;
  view.grid.cells = {1, 1, 1};
  refresh();
}

void BoxByHand::refresh() {
  maps.clear();
  nx.clear();
  ny.clear();
  nz.clear();
  offset.clear();
  for (MapByHand& made : by_hand) {
    made.map.samples = made.samples.data();
    made.map.layer_offsets = made.offsets.data();
    made.map.mask = made.mask.data();
    maps.push_back(made.map);
  }
  for (const SupportPlane& plane : planes) {
    nx.push_back(plane.n.x());
    ny.push_back(plane.n.y());
    nz.push_back(plane.n.z());
    offset.push_back(plane.n.dot(plane.x0));
  }
  view.planes = planes;
  view.maps = maps;
  view.triangles = triangles;
  view.grid.index = index;
  view.grid.records = records;
  view.plane_nx = nx;
  view.plane_ny = ny;
  view.plane_nz = nz;
  view.plane_offset = offset;
}

SparseCubeByHand::SparseCubeByHand(double size, const Band& band) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      const Vector3 normal = side * Vector3::Unit(axis);
      planes.push_back(plane_with_normal(size / 2 * normal, normal));
    }
  }
  octree.origin = Vector3::Constant(-size / 2 - band.margin);
  octree.edge = size + 2 * band.margin;
  // Such that corners are exact.
  octree.lattice_step = size / (2 * half_steps);
  replace_triangles(box(Vector3::Constant(size)));
  view.band = band;
  view.tolerance = 1e-5;
  refresh();
}

void SparseCubeByHand::replace_triangles(const Shape& shape) {
  octree = triangle_octree(shape, {.low = octree.origin, .edge = octree.edge}, octree.lattice_step);
  if (!shape.vertices.empty()) view.box_low = view.box_high = shape.vertices.front();
  for (const Vector3& vertex : shape.vertices) {
    view.box_low = view.box_low.cwiseMin(vertex);
    view.box_high = view.box_high.cwiseMax(vertex);
  }
  refresh();
}

void SparseCubeByHand::forget_box() {
  view.box_low = unknown_box(-1);
  view.box_high = unknown_box(1);
}

void SparseCubeByHand::refresh() {
  view.planes = planes;
  octree.add_to(view);
}

}  // namespace spm::test
