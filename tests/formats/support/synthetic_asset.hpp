// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/random.hpp"
#include "formats/asset/asset.hpp"

namespace spm::test {

/// A folder that is gone at the end of the scope; in memory where a test writes thousands of files.
class TemporaryFolder {
 public:
  enum class Place { disk, memory };
  explicit TemporaryFolder(Place place = Place::disk);
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }
  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] std::vector<std::string> entries() const;

 private:
  std::string folder_;
};

/// A whole number from 0 to below a bound.
[[nodiscard]] inline std::uint32_t below(Random& random, std::uint32_t bound) {
  return static_cast<std::uint32_t>(random.next() % bound);
}

struct SparseShape {
  std::uint32_t planes = 10;
  std::uint32_t charts = 6;
  std::uint32_t triangles = 20;
};

/// Assets with random content that is consistent: no object has this shape, but every part of the
/// format is used, and queries in the box find maps and triangles. The octree has cubes of all
/// kinds, up to four levels below its roots; the last quarter of the triangles are of sheets.
[[nodiscard]] Asset sparse_asset(std::uint64_t seed, const SparseShape& shape = {});

/// One map per plane; the map of plane k has layers[k] layers. Cells share lists, and splits are
/// nested three deep.
[[nodiscard]] Asset full_asset(std::uint64_t seed, const std::vector<std::uint32_t>& layers,
                               std::uint32_t columns = 9, std::uint32_t rows = 7);

[[nodiscard]] std::string read_bytes(const std::string& path);
void write_bytes(const std::string& path, const std::string& bytes);

/// Makes the recorded size and checksum of a changed asset right again.
void reseal(std::string& bytes);

}  // namespace spm::test
