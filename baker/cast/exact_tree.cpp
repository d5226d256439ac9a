// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cast/exact_tree.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <embree/rays.hpp>
#include <vector>

#include "baker/base/bake_error.hpp"

namespace spm::baker {

namespace {

bool count_memory(void* held, ssize_t bytes, bool /*after*/) {
  *static_cast<std::atomic<std::int64_t>*>(held) += bytes;
  return true;
}

}  // namespace

std::uint64_t exact_tree_bytes(const Mesh& mesh, std::uint64_t enough) {
  const std::uint64_t of_mesh =
      3 * sizeof(float) * mesh.vertices.size() + 3 * sizeof(std::uint32_t) * mesh.triangles.size();
  if (of_mesh >= enough) return of_mesh;
  std::vector<float> vertices;
  vertices.reserve(3 * mesh.vertices.size() + 1);  // Embree reads whole vectors
  for (const Vector3& vertex : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) vertices.push_back(static_cast<float>(vertex[axis]));
  }
  std::atomic<std::int64_t> held = 0;
  // More threads would take more memory.
  RTCDevice device = rtcNewDevice("threads=1");
  if (device == nullptr) throw BakeError(ExitCode::internal, "Embree could not be started");
  rtcSetDeviceMemoryMonitorFunction(device, &count_memory, &held);
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_COMPACT);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             vertices.data(), 0, 3 * sizeof(float), mesh.vertices.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                             mesh.triangles.data(), 0, 3 * sizeof(std::uint32_t),
                             mesh.triangles.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  const std::int64_t tree = held.load();
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  return of_mesh + static_cast<std::uint64_t>(std::max<std::int64_t>(tree, 0));
}

}  // namespace spm::baker
