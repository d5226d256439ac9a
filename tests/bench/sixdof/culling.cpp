// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/sixdof/culling.hpp"

#include <ccd/ccd.h>

#include <cmath>
#include <map>
#include <utility>

#include "baker/planes/hull.hpp"
#include "common/base/random.hpp"
#include "common/culling/support_culling.hpp"
#include "common/sixdof/object_contact.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/bench/base/one_core.hpp"
#include "tests/bench/geometry/bounding_boxes.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {
namespace {

using Eigen::Isometry3d;

constexpr int ticks = 40;
constexpr double drift = 1e-4, turn = 2e-3;  // m and rad a tick, at most
/// Volume per object in a random scene, in units of the cubed radius of its ball.
constexpr double room = 4;

/// What the scenes are made of copies of.
struct Shape {
  SupportedObject object;
  SupportHull points;
  std::vector<Vector3> hull;  ///< whose points, grown by `grown` (m), contain the object
  double grown = 0;
};

Shape shape_of(const AssetView& view, const SurfaceSamples& samples) {
  const Extent extent = extent_of(view);
  const SampleLevel& finest = samples.levels.back();
  std::vector<Vector3> places;
  for (std::uint32_t i = finest.first; i < finest.first + finest.count; ++i) {
    const auto& [x, y, z] = samples.places[i].position;
    places.emplace_back(x, y, z);
  }
  return {{extent.low, extent.low + extent.size, view.planes},
          support_hull(samples),
          baker::convex_hull_vertices(places).vertices,
          finest.bound};
}

/// A shape at a pose, with a ball about each of its points, as libccd asks for it.
struct PlacedHull {
  const Shape& shape;
  Isometry3d pose;
  double grown;  ///< m
};

void farthest_along(const void* placed, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const auto& [shape, pose, grown] = *static_cast<const PlacedHull*>(placed);
  const Vector3 along =
      Vector3(direction->v[0], direction->v[1], direction->v[2]).stableNormalized();
  const Vector3 back = pose.linear().transpose() * along;
  const Vector3 found = pose * shape.hull[support_mapping(shape.hull, back)] + grown * along;
  ccdVec3Set(point, found.x(), found.y(), found.z());
}

/// Whether both hulls are no farther than `gap` (m) from each other, by libccd's search (Gilbert,
/// Johnson and Keerthi 1988).
bool hulls_touch(const Shape& shape, const Isometry3d& pose2, double gap) {
  constexpr unsigned long most_steps = 100;
  const double grown = shape.grown + gap / 2;
  const PlacedHull first{shape, Isometry3d::Identity(), grown}, second{shape, pose2, grown};
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = farthest_along;
  ccd.max_iterations = most_steps;
  return ccdGJKIntersect(&first, &second, &ccd) != 0;
}

/// Objects and how they move.
class Scene {
 public:
  Scene(const Shape& shape, std::uint64_t objects, bool near, std::uint64_t seed)
      : shape_(shape), seed_(seed) {
    const double edge = shape.points.radius * std::cbrt(room * static_cast<double>(objects));
    for (std::uint64_t k = 0; k < objects; ++k) {
      Isometry3d pose = Isometry3d::Identity();
      pose.linear() = Eigen::AngleAxisd(3 * unit(), direction()).toRotationMatrix();
      if (near && k % 2 == 1) {
        place_beside(poses.back(), pose);
      } else {
        pose.translation() = edge * Vector3(unit(), unit(), unit());
      }
      poses.push_back(pose);
    }
  }

  std::vector<Isometry3d> poses;

  void move() {
    for (Isometry3d& pose : poses) {
      pose.translation() += drift * unit() * direction();
      pose.linear() = Eigen::AngleAxisd(turn * unit(), direction()) * pose.linear();
    }
  }

 private:
  const Shape& shape_;
  std::uint64_t seed_, drawn_ = 0;

  double unit() { return random_unit(seed_, drawn_++); }
  Vector3 direction() {
    const double a = unit(), b = unit();
    return direction_of(a, b);
  }

  /// Moves `pose` away from `other` along a random direction until the hulls are a gap apart.
  void place_beside(const Isometry3d& other, Isometry3d& pose) {
    const Vector3 along = direction();
    const double gap = 0.1 * shape_.points.radius * unit();
    double far = 0;
    for (int k = 0; k < 40; ++k) {
      pose.translation() = other.translation() + far * along;
      if (!hulls_touch(shape_, other.inverse() * pose, gap)) break;
      far += 0.05 * shape_.points.radius;
    }
  }
};

AxisBox box_of(const Shape& shape, const Isometry3d& pose) noexcept {
  AxisBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 along = pose.linear().transpose() * Vector3::Unit(axis);
    const double middle = pose.translation()[axis];
    box.max()[axis] = middle + along.dot(shape.hull[support_mapping(shape.hull, along)]);
    box.min()[axis] = middle + along.dot(shape.hull[support_mapping(shape.hull, -along)]);
  }
  box.min().array() -= shape.grown;
  box.max().array() += shape.grown;
  return box;
}

CullingRow measure(const Shape& shape, std::uint64_t objects, bool near, std::uint64_t seed) {
  CullingRow row;
  row.scene = near ? "near" : "random";
  row.objects = objects;
  Scene scene(shape, objects, near, seed);
  const OrientedBoundingBox turned = oriented_bounding_box(shape.hull, shape.grown);
  std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> last;
  double aabb = 0, obb = 0, spm = 0, remembered = 0, told = 0;
  const OneCore pinned;
  for (int tick = 0; tick < ticks; ++tick, scene.move()) {
    const std::vector<Isometry3d>& poses = scene.poses;
    std::vector<AxisBox> boxes;
    boxes.reserve(poses.size());
    for (const Isometry3d& pose : poses) boxes.push_back(box_of(shape, pose));
    std::vector<std::pair<std::size_t, std::size_t>> left;
    Clock::time_point start = Clock::now();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      for (std::size_t j = i + 1; j < poses.size(); ++j) {
        if (boxes[i].intersects(boxes[j])) left.emplace_back(i, j);
      }
    }
    aabb += seconds_since(start);
    row.pairs += poses.size() * (poses.size() - 1) / 2;
    row.after_aabb += left.size();
    std::vector<Isometry3d> between;
    between.reserve(left.size());
    for (const auto& [i, j] : left) between.push_back(poses[i].inverse() * poses[j]);
    const Isometry3d to_box = turned.pose.inverse();
    start = Clock::now();
    for (const Isometry3d& pose : between) {
      row.after_obb += boxes_apart(turned.half, turned.half, to_box * pose * turned.pose) ? 0 : 1;
    }
    obb += seconds_since(start);
    // Storing and loading the planes is not part of the measured time.
    std::vector<std::uint32_t> planes;
    planes.reserve(left.size());
    for (const auto& pair : left) planes.push_back(last.try_emplace(pair, no_plane).first->second);
    start = Clock::now();
    for (std::size_t k = 0; k < left.size(); ++k) {
      const CullStage stage = objects_apart(shape.object, shape.points, between[k], 0, planes[k]);
      row.after_spm += stage == CullStage::none ? 1 : 0;
      told += stage != CullStage::none ? 1 : 0;
      remembered += stage == CullStage::remembered ? 1 : 0;
    }
    spm += seconds_since(start);
    for (std::size_t k = 0; k < left.size(); ++k) {
      last[left[k]] = planes[k];
      row.touching += hulls_touch(shape, between[k], 0) ? 1 : 0;
    }
  }
  const auto each = [](double seconds, std::uint64_t count) {
    return count > 0 ? 1e9 * seconds / static_cast<double>(count) : 0;
  };
  row.aabb_ns = each(aabb, row.pairs);
  row.obb_ns = each(obb, row.after_aabb);
  row.spm_ns = each(spm, row.after_aabb);
  row.remembered = told > 0 ? remembered / told : 0;
  return row;
}

}  // namespace

CullingReport measure_culling(const AssetView& object, const SurfaceSamples& samples,
                              std::uint64_t max_objects, std::uint64_t seed) {
  const Shape shape = shape_of(object, samples);
  CullingReport report{shape.hull.size(), {}};
  for (const std::uint64_t objects : {2U, 10U, 100U, 1000U}) {
    if (objects > max_objects) continue;
    for (const bool near : {false, true}) {
      report.rows.push_back(measure(shape, objects, near, seed));
    }
  }
  return report;
}

}  // namespace spm::bench
