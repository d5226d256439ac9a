// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene_placement.hpp"

#include <array>
#include <cmath>

namespace spm {

namespace {

constexpr double unit_slack = 0.01;  // of a quaternion written with few digits
constexpr double min_scale = 1e-6, max_scale = 1e6;

void read_pose(TableReader& reader, Placement& placement) {
  const char* cure = "; give [x, y, z] in metres, or [x, y, z, qw, qx, qy, qz]";
  const toml::array* array = reader.node("pose")->as_array();
  if (array == nullptr || (array->size() != 3 && array->size() != 7)) {
    return reader.refuse("pose", std::string("'pose' must be three or seven numbers") + cure);
  }
  std::array<double, 7> numbers{0, 0, 0, 1, 0, 0, 0};
  for (std::size_t i = 0; i < array->size(); ++i) {
    const toml::node& value = *array->get(i);
    const std::optional<double> number = value.value<double>();
    if (!value.is_number() || !number || !std::isfinite(*number)) {
      return reader.refuse("pose", std::string("'pose' holds what is no finite number") + cure);
    }
    numbers[i] = *number;
  }
  const Eigen::Quaterniond rotation(numbers[3], numbers[4], numbers[5], numbers[6]);
  if (!(std::abs(rotation.norm() - 1) <= unit_slack)) {
    return reader.refuse("pose",
                         "the quaternion of 'pose' is not of unit length; give qw qx qy qz of unit "
                         "length, to within 1 %");
  }
  placement.position = Vector3(numbers[0], numbers[1], numbers[2]);
  placement.rotation = rotation.normalized();
}

void read_scale(TableReader& reader, Placement& placement) {
  const toml::node& value = *reader.node("scale");
  const std::optional<double> scale = value.value<double>();
  const bool number = value.is_number() && scale && std::isfinite(*scale);
  if (number && *scale >= min_scale && *scale <= max_scale) {
    placement.scale = *scale;
  } else if (number && *scale < 0) {
    reader.refuse("scale",
                  "'scale' must be above 0: what is mirrored is another object; mirror the mesh "
                  "and bake that");
  } else if (number && *scale > 0) {
    reader.refuse("scale", "'scale' is out of range; give a number from 1e-6 to 1e6");
  } else {
    reader.refuse("scale", "'scale' must be a number above 0, such as 2.0");
  }
}

}  // namespace

Placement read_placement(TableReader& reader) {
  Placement placement;
  if (reader.has("pose")) read_pose(reader, placement);
  if (reader.has("scale")) read_scale(reader, placement);
  return placement;
}

}  // namespace spm
