// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "tests/bench/model/float_mesh.hpp"

namespace spm::bench {

/// The options of a proxy on a mesh.
struct MeshProxyOptions {
  bool tree = true;        ///< a tree of boxes finds the triangles; otherwise all are tested
  bool shading = true;     ///< by interpolated vertex normals (Ruspini et al. 1997)
  double radius = 0;       ///< m; 0 is a point
  double stiffness = 1e3;  ///< N/m
};

/// Where the proxy is held.
struct ProxyContact {
  bool contact = false;
  Vector3 proxy = Vector3::Zero();   ///< its centre
  Vector3 normal = Vector3::Zero();  ///< unit, from the tool to the proxy; zero without contact
  double depth = 0;                  ///< m between tool and proxy
  Vector3 force = Vector3::Zero();   ///< N
};

/// A god object on a triangle mesh (Zilles and Salisbury 1995): a point or ball that follows the
/// tool as closely as up to three constraint planes allow, and never crosses the surface. The paper
/// compares itself with this method. It remembers its position, so it is not thread-safe.
class MeshProxy {
 public:
  MeshProxy() = default;
  virtual ~MeshProxy() = default;
  MeshProxy(const MeshProxy&) = delete;
  MeshProxy& operator=(const MeshProxy&) = delete;

  /// Puts the proxy at a place, which must be free.
  virtual void place(const Vector3& where) noexcept = 0;

  /// Moves the tool to a place; the proxy follows. This includes the search for triangles.
  virtual ProxyContact follow(const Vector3& tool) noexcept = 0;

  /// The force that one triangle gives a tool, without any search: from the plane at its closest
  /// point, and shading. An earlier `follow()` gives the triangle of a tick, as
  /// `last_triangle()`.
  [[nodiscard]] virtual ProxyContact force_at(const Vector3& tool,
                                              std::uint32_t triangle) const noexcept = 0;
  [[nodiscard]] virtual std::uint32_t last_triangle() const noexcept = 0;

  /// The indexed mesh, the tree, and the vertices' normals where there is shading.
  [[nodiscard]] virtual std::uint64_t bytes() const noexcept = 0;
};

/// For a person, such as "tree, force shading".
[[nodiscard]] std::string to_string(const MeshProxyOptions& options);

[[nodiscard]] std::unique_ptr<MeshProxy> make_mesh_proxy(FloatMesh mesh,
                                                         const MeshProxyOptions& options);

}  // namespace spm::bench
