// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <embree/rays.hpp>
#include <string>

#include "baker/base/bake_error.hpp"
#include "tests/bench/geometry/sided_mesh.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"

namespace spm::bench {
namespace {

/// Three floats and their arithmetic: Eigen would wrap each in calls that GCC keeps at times.
struct Float3 {
  float x, y, z;
};
Float3 operator-(Float3 a, Float3 b) noexcept { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Float3 less(Float3 a, float s, Float3 b) noexcept {
  return {a.x - s * b.x, a.y - s * b.y, a.z - s * b.z};
}
float dot(Float3 a, Float3 b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// The squared distance of the origin from a triangle, by the region it is in (Ericson 2005).
float squared_distance(Float3 a, Float3 b, Float3 c) noexcept {
  const Float3 ab = b - a, ac = c - a;
  const float ab_a = -dot(ab, a), ac_a = -dot(ac, a);
  if (ab_a <= 0 && ac_a <= 0) return dot(a, a);
  const float ab_b = -dot(ab, b), ac_b = -dot(ac, b);
  if (ab_b >= 0 && ac_b <= ab_b) return dot(b, b);
  const float ab_c = -dot(ab, c), ac_c = -dot(ac, c);
  if (ac_c >= 0 && ab_c <= ac_c) return dot(c, c);
  const auto on_side = [](Float3 from, Float3 side, float part, float rest) {
    const Float3 foot = less(from, part + rest > 0 ? -part / (part + rest) : 0.0F, side);
    return dot(foot, foot);
  };
  const float of_c = ab_a * ac_b - ab_b * ac_a;
  if (of_c <= 0 && ab_a >= 0 && ab_b <= 0) return on_side(a, ab, ab_a, -ab_b);
  const float of_b = ab_c * ac_a - ab_a * ac_c;
  if (of_b <= 0 && ac_a >= 0 && ac_c <= 0) return on_side(a, ac, ac_a, -ac_c);
  const float of_a = ab_b * ac_c - ab_c * ac_b;
  const float to_c = ac_b - ab_b, to_b = ab_c - ac_c;
  if (of_a <= 0 && to_c >= 0 && to_b >= 0) return on_side(b, c - b, to_c, to_b);
  const float scale = 1 / (of_a + of_b + of_c);
  const Float3 foot = less(less(a, -of_b * scale, ab), -of_c * scale, ac);
  return dot(foot, foot);
}

/// Embree's tree, asked from the distance of the triangle that was nearest before, or from the
/// band's reach where that is less. Floats find the triangle, doubles answer.
class Embree : public Method {
 public:
  Embree(const Model& model, EmbreeTree kind)
      : mesh_(model),
        vertices_(mesh_.mesh().vertices),
        slack_(1e-6 * model.mesh.diagonal),
        reach_(std::max(model.band.max_depth, model.band.margin) + slack_) {
    const Clock::time_point start = Clock::now();
    device_ = rtcNewDevice(nullptr);
    if (device_ == nullptr) {
      throw baker::BakeError(ExitCode::internal, "Embree could not be started");
    }
    rtcSetDeviceMemoryMonitorFunction(device_, &count_memory, &held_);
    build(kind);
    constexpr std::array<const char*, 3> names{"compact", "default", "high quality"};
    facts_.name = "embree";
    facts_.settings = names[static_cast<std::size_t>(kind)];
    facts_.file_bytes = mesh_.mesh().bytes();
    facts_.resident_bytes = static_cast<std::uint64_t>(held_.load()) + mesh_.bytes();
    facts_.open_seconds = mesh_.seconds() + seconds_since(start);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    if (!point.allFinite()) return far_answer();
    RTCPointQuery place{};
    place.x = static_cast<float>(point.x());
    place.y = static_cast<float>(point.y());
    place.z = static_cast<float>(point.z());
    const double before = mesh_.distance(point, last_);
    place.radius = static_cast<float>(std::min(before * (1 + 1e-6) + slack_, reach_));
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    Search search{this, {place.x, place.y, place.z}, place.radius * place.radius, none};
    rtcPointQuery(scene_, &place, &context, &visit, &search);
    if (search.nearest == none) return far_answer();
    last_ = search.nearest;
    return mesh_.answer(point, last_);
  }

 private:
  static constexpr std::uint32_t none = 0xFFFFFFFFU;

  struct Search {
    const Embree* self;
    Float3 point;
    float squared;
    std::uint32_t nearest;
  };

  static bool visit(RTCPointQueryFunctionArguments* arguments) {
    auto& search = *static_cast<Search*>(arguments->userPtr);
    const auto& triangle = search.self->mesh_.mesh().triangles[arguments->primID];
    const auto corner = [&](std::size_t k) {
      const auto& [x, y, z] = search.self->vertices_[triangle[k]];
      return Float3{x, y, z} - search.point;
    };
    const float squared = squared_distance(corner(0), corner(1), corner(2));
    if (!(squared < search.squared)) return false;
    search.squared = squared;
    search.nearest = arguments->primID;
    arguments->query->radius = std::sqrt(squared);
    return true;
  }

  static bool count_memory(void* held, ssize_t bytes, bool) {
    *static_cast<std::atomic<std::int64_t>*>(held) += bytes;
    return true;
  }

  void build(EmbreeTree kind) {
    // Embree reads whole vectors: there must be memory behind the last vertex.
    vertices_.reserve(vertices_.size() + 1);
    const auto& triangles = mesh_.mesh().triangles;
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_,
                     kind == EmbreeTree::compact ? RTC_SCENE_FLAG_COMPACT : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene_, kind == EmbreeTree::high_quality ? RTC_BUILD_QUALITY_HIGH
                                                                     : RTC_BUILD_QUALITY_MEDIUM);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               vertices_.data(), 0, 3 * sizeof(float), vertices_.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               triangles.data(), 0, 3 * sizeof(std::uint32_t), triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

  SidedMesh mesh_;
  std::vector<std::array<float, 3>> vertices_;  ///< as the mesh has them, with memory behind
  double slack_;                                ///< m: so that rounding loses no triangle
  double reach_;                                ///< m: of the band
  mutable std::uint32_t last_ = 0;              ///< the nearest triangle before
  std::atomic<std::int64_t> held_ = 0;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

}  // namespace

std::unique_ptr<Method> make_embree(const Model& model, EmbreeTree kind) {
  return std::make_unique<Embree>(model, kind);
}

}  // namespace spm::bench
