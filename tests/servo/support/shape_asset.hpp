// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "formats/asset/asset.hpp"
#include "tests/support/shapes.hpp"

namespace spm::test {

/// An asset of a shape, made without the baker: exact triangles in every cell of the band. 2 mm of
/// depth, 1 mm of margin, probes up to 0.5 mm. For shapes of some hundred triangles.
[[nodiscard]] Asset shape_asset(const Shape& shape);

/// A box with edges of `size` as a `full` asset: one support plane per face, maps of distance 0.
[[nodiscard]] Asset box_asset(double size);

/// A folder of its own under the system's temporary one, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Writes an asset; throws where that fails.
void write(const Asset& asset, const std::string& path);

}  // namespace spm::test
