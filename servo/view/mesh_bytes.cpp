// SPDX-License-Identifier: Apache-2.0
#include "servo/view/mesh_bytes.hpp"

#include <array>
#include <bit>
#include <cstdint>

namespace spm::servo {

namespace {

template <class T>
void append(std::string& bytes, const T* first, std::size_t count) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(first), count * sizeof(T));
}

}  // namespace

std::string to_bytes(const ContourMesh& mesh) {
  std::string bytes;
  const std::array<std::uint32_t, 2> counts{static_cast<std::uint32_t>(mesh.vertices.size()),
                                            static_cast<std::uint32_t>(mesh.triangles.size() / 3)};
  bytes.reserve(8 + 12 * mesh.vertices.size() + 4 * mesh.triangles.size());
  append(bytes, counts.data(), counts.size());
  append(bytes, mesh.vertices.data(), mesh.vertices.size());
  append(bytes, mesh.triangles.data(), mesh.triangles.size());
  return bytes;
}

}  // namespace spm::servo
