// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// A view of a buffer as EXT_meshopt_compression describes it.
struct MeshoptView {
  std::string_view packed;
  std::uint64_t count = 0, stride = 0;
  std::string mode, filter;
};

/// What such a view unpacks to: count times stride bytes. Nothing where it is broken, or where more
/// than 64 MiB would come out that are 100 times as large as what is packed.
[[nodiscard]] std::optional<std::string> unpack_meshopt(const MeshoptView& view);

struct DracoMesh {
  std::vector<Vector3> points;
  std::vector<Triangle> triangles;  ///< no index out of range
};

/// The mesh of KHR_draco_mesh_compression; `position` is its attribute's unique number. Nothing
/// where it is broken, or has more than `most` points or triangles.
[[nodiscard]] std::optional<DracoMesh> unpack_draco(std::string_view packed, std::uint64_t position,
                                                    std::uint64_t most);

}  // namespace spm::baker
