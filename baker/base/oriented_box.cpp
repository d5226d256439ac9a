// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/base/oriented_box.hpp"

#include <nlohmann/json.hpp>
#include <vector>

namespace spm::baker {

bool may_touch(const OrientedBox& box, const Vector3& middle, double edge) noexcept {
  // Separating axes: the normals of the faces of both. Those from pairs of edges would only sharpen
  // the result for near misses.
  const Vector3 offset = middle - box.middle;
  const Eigen::Matrix3d spread = box.axes.cwiseAbs();
  const Vector3 in_box = (box.axes.transpose() * offset).cwiseAbs();
  const Vector3 cube_half = spread.transpose() * Vector3::Constant(edge / 2);
  if (((in_box - box.half - cube_half).array() > 0).any()) return false;
  const Vector3 box_half = spread * box.half;
  return ((offset.cwiseAbs() - box_half).array() <= edge / 2).all();
}

bool touches_triangle(const OrientedBox& box, const Vector3& a, const Vector3& b,
                      const Vector3& c) {
  std::vector<Vector3> polygon;
  for (const Vector3& corner : {a, b, c}) {
    polygon.push_back(box.axes.transpose() * (corner - box.middle));
  }
  // The part of the triangle that the six half-spaces of the faces leave.
  for (int face = 0; face < 6 && !polygon.empty(); ++face) {
    const int axis = face / 2;
    const double sign = face % 2 == 0 ? 1 : -1;
    const auto height = [&](const Vector3& point) { return box.half[axis] - sign * point[axis]; };
    std::vector<Vector3> left;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector3& from = polygon[i];
      const Vector3& to = polygon[(i + 1) % polygon.size()];
      const double before = height(from), after = height(to);
      if (before >= 0) left.push_back(from);
      if ((before < 0) != (after < 0))
        left.push_back(from + before / (before - after) * (to - from));
    }
    polygon = std::move(left);
  }
  return !polygon.empty();
}

OrientedBox grown(OrientedBox box, double distance) noexcept {
  box.half.array() += distance;
  return box;
}

nlohmann::ordered_json to_json(const OrientedBox& box) {
  const auto row = [](const Vector3& v) {
    return nlohmann::ordered_json::array({v.x(), v.y(), v.z()});
  };
  return {{"middle", row(box.middle)},
          {"axes", {row(box.axes.col(0)), row(box.axes.col(1)), row(box.axes.col(2))}},
          {"half", row(box.half)}};
}

}  // namespace spm::baker
