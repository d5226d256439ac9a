// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "baker/mesh/load.hpp"
#include "baker/mesh/mesh.hpp"
#include "common/surface/closest_on_triangle.hpp"
#include "tests/support/shapes.hpp"

namespace spm::test {

/// A folder of its own under the system's temporary folder, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "spm-mesh-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] std::string path(const std::string& name) const { return (path_ / name).string(); }

  /// Writes a file and returns its path.
  [[nodiscard]] std::string write(const std::string& name, std::string_view bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

 private:
  std::filesystem::path path_;
};

/// A shape as a user's file would bring it.
[[nodiscard]] inline baker::Mesh load_shape(const Shape& shape,
                                            const baker::LoadOptions& options = {}) {
  const TemporaryFolder folder;
  write_obj(shape, folder.path("shape.obj"));
  return baker::load_mesh(folder.path("shape.obj"), options);
}

[[nodiscard]] inline double signed_volume(const std::vector<Vector3>& vertices,
                                          const std::vector<baker::Triangle>& triangles) {
  double volume = 0;
  for (const auto& [a, b, c] : triangles) {
    volume += vertices[a].dot(vertices[b].cross(vertices[c])) / 6;
  }
  return volume;
}

[[nodiscard]] inline double area(const std::vector<Vector3>& vertices,
                                 const std::vector<baker::Triangle>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    sum += (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]).norm() / 2;
  }
  return sum;
}

/// How far a place is from the nearest of some triangles.
[[nodiscard]] inline double distance_to(const std::vector<Vector3>& vertices,
                                        const std::vector<baker::Triangle>& triangles,
                                        const Vector3& place) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : triangles) {
    const Vector3 closest = closest_on_triangle(place, vertices[a], vertices[b], vertices[c]);
    least = std::min(least, (closest - place).norm());
  }
  return least;
}

}  // namespace spm::test
