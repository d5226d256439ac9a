// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "tests/bench/model/float_mesh.hpp"

namespace spm::bench {

/// What a proxy on a mesh is made of.
struct MeshProxyOptions {
  bool tree = true;        ///< a tree of boxes finds the triangles; otherwise all are looked at
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
/// tool as near as up to three constraint planes let it, and never passes the surface. The rival
/// that the paper compares itself with. It remembers where it is: not for several threads.
class MeshProxy {
 public:
  MeshProxy() = default;
  virtual ~MeshProxy() = default;
  MeshProxy(const MeshProxy&) = delete;
  MeshProxy& operator=(const MeshProxy&) = delete;

  /// Puts the proxy at a place, which must be free.
  virtual void place(const Vector3& where) noexcept = 0;

  /// The tool moves here: the proxy follows. The search for triangles is part of it.
  virtual ProxyContact follow(const Vector3& tool) noexcept = 0;

  /// The force that a tool gets from one triangle without any search: the plane of its closest
  /// point, and shading. Which triangle a tick touches is `last_triangle()` of the following
  /// before.
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
