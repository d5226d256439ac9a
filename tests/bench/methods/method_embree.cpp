// SPDX-License-Identifier: GPL-3.0-or-later
#include <embree3/rtcore.h>

#include <atomic>
#include <cstdint>
#include <limits>

#include "baker/base/bake_error.hpp"
#include "common/surface/closest_on_triangle.hpp"
#include "tests/bench/geometry/nearest_point.hpp"
#include "tests/bench/methods/methods.hpp"
#include "tests/bench/model/float_mesh.hpp"

namespace spm::bench {
namespace {

class Embree : public Method {
 public:
  Embree(const Model& model, bool compact)
      : mesh_(model.surface), tie_(1e-7 * model.mesh.diagonal), diagonal_(model.mesh.diagonal) {
    const Clock::time_point start = Clock::now();
    device_ = rtcNewDevice(nullptr);
    if (device_ == nullptr) {
      throw baker::BakeError(ExitCode::internal, "Embree could not be started");
    }
    rtcSetDeviceMemoryMonitorFunction(device_, &count_memory, &held_);
    build(compact);
    facts_.name = "embree";
    facts_.settings = compact ? "compact" : "default";
    facts_.bytes = static_cast<std::uint64_t>(held_.load()) + mesh_.bytes();
    facts_.build_seconds = seconds_since(start);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    struct Search {
      const Embree* self;
      Vector3 point;
      NearestPoint nearest;
    };
    Search search{this, point, NearestPoint(point, tie_)};
    RTCPointQuery place{};
    place.x = static_cast<float>(point.x());
    place.y = static_cast<float>(point.y());
    place.z = static_cast<float>(point.z());
    place.radius = std::numeric_limits<float>::infinity();
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    const auto visit = [](RTCPointQueryFunctionArguments* arguments) {
      auto& io = *static_cast<Search*>(arguments->userPtr);
      const auto [a, b, c] = io.self->mesh_.corners(arguments->primID);
      const Vector3 closest_point = closest_on_triangle(io.point, a, b, c);
      if (!io.nearest.show(closest_point, a, b, c)) return false;
      // Slack, so that single precision loses no triangle that decides the side.
      arguments->query->radius = static_cast<float>(
          (io.nearest.distance() + io.self->tie_) * (1 + 1e-5) + 1e-6 * io.self->diagonal_);
      return true;
    };
    rtcPointQuery(scene_, &place, &context, visit, &search);
    return search.nearest.answer();
  }

 private:
  static bool count_memory(void* held, ssize_t bytes, bool) {
    *static_cast<std::atomic<std::int64_t>*>(held) += bytes;
    return true;
  }

  void build(bool compact) {
    // Embree reads whole vectors: there must be memory behind the last vertex.
    mesh_.vertices.reserve(mesh_.vertices.size() + 1);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, compact ? RTC_SCENE_FLAG_COMPACT : RTC_SCENE_FLAG_NONE);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh_.vertices.data(), 0, 3 * sizeof(float), mesh_.vertices.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh_.triangles.data(), 0, 3 * sizeof(std::uint32_t),
                               mesh_.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

  FloatMesh mesh_;
  double tie_;
  double diagonal_;
  std::atomic<std::int64_t> held_ = 0;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

}  // namespace

std::unique_ptr<Method> make_embree(const Model& model, bool compact) {
  return std::make_unique<Embree>(model, compact);
}

}  // namespace spm::bench
