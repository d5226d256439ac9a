// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/sixdof/culling.hpp"

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "common/base/random.hpp"
#include "common/culling/hull_distance.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/bench/base/one_core.hpp"
#include "tests/bench/geometry/bounding_boxes.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {
namespace {

using Eigen::Isometry3d;

constexpr int ticks = 40;
constexpr double drift = 1e-4, turn = 2e-3;  // m and rad a tick, at most
constexpr int exact_steps = 64;
/// Volume per object in a random scene, in units of the cubed radius of its ball.
constexpr double room = 4;

/// Objects and how they move.
class Scene {
 public:
  Scene(const SupportHull& hull, std::uint64_t objects, bool near, std::uint64_t seed)
      : hull_(hull), seed_(seed) {
    const double edge = hull.radius * std::cbrt(room * static_cast<double>(objects));
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
  const SupportHull& hull_;
  std::uint64_t seed_, drawn_ = 0;

  double unit() { return random_unit(seed_, drawn_++); }
  Vector3 direction() {
    const double a = unit(), b = unit();
    return direction_of(a, b);
  }

  /// Moves `pose` away from `other` along a random direction until the hulls are a gap apart.
  void place_beside(const Isometry3d& other, Isometry3d& pose) {
    const Vector3 along = direction();
    const double gap = 0.1 * hull_.radius * unit();
    double far = 0;
    for (int k = 0; k < 40; ++k) {
      pose.translation() = other.translation() + far * along;
      SeparatingDirection none;
      const CullResult found = objects_apart(hull_, hull_, other.inverse() * pose, none);
      if (found.apart && found.lower_bound > gap) break;
      far += 0.05 * hull_.radius;
    }
  }
};

AxisBox box_of(const SupportHull& hull, const Isometry3d& pose) noexcept {
  AxisBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 along = pose.linear().transpose() * Vector3::Unit(axis);
    const double middle = pose.translation()[axis];
    box.max()[axis] = middle + along.dot(hull.points[support_mapping(hull.points, along)]);
    box.min()[axis] = middle + along.dot(hull.points[support_mapping(hull.points, -along)]);
  }
  box.min().array() -= hull.grown;
  box.max().array() += hull.grown;
  return box;
}

bool hulls_touch(const SupportHull& hull, const Isometry3d& pose2) noexcept {
  const auto support = [&](const Vector3& v) {
    const Vector3 back = pose2.linear().transpose() * v;
    return Vector3(pose2 * hull.points[support_mapping(hull.points, back)] -
                   hull.points[support_mapping(hull.points, -v)]);
  };
  const double enough = 2 * hull.grown;
  return hull_distance(support, pose2.translation(), enough, exact_steps).lower_bound <= enough;
}

CullingRow measure(const SupportHull& hull, std::uint64_t objects, bool near, std::uint64_t seed) {
  CullingRow row;
  row.scene = near ? "near" : "random";
  row.objects = objects;
  Scene scene(hull, objects, near, seed);
  const OrientedBoundingBox turned = oriented_bounding_box(hull.points, hull.grown);
  std::map<std::pair<std::size_t, std::size_t>, SeparatingDirection> last;
  double aabb = 0, obb = 0, spm = 0, remembered = 0, told = 0;
  const OneCore pinned;
  for (int tick = 0; tick < ticks; ++tick, scene.move()) {
    const std::vector<Isometry3d>& poses = scene.poses;
    std::vector<AxisBox> boxes;
    for (const Isometry3d& pose : poses) boxes.push_back(box_of(hull, pose));
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
    for (const auto& [i, j] : left) between.push_back(poses[i].inverse() * poses[j]);
    const Isometry3d to_box = turned.pose.inverse();
    start = Clock::now();
    for (const Isometry3d& pose : between) {
      row.after_obb += boxes_apart(turned.half, turned.half, to_box * pose * turned.pose) ? 0 : 1;
    }
    obb += seconds_since(start);
    // Storing and loading the directions is not part of the measured time.
    std::vector<SeparatingDirection> directions;
    for (const auto& pair : left) directions.push_back(last[pair]);
    start = Clock::now();
    for (std::size_t k = 0; k < left.size(); ++k) {
      const CullResult found = objects_apart(hull, hull, between[k], directions[k]);
      row.after_spm += found.apart ? 0 : 1;
      told += found.apart ? 1 : 0;
      remembered += found.stage == CullStage::remembered ? 1 : 0;
    }
    spm += seconds_since(start);
    for (std::size_t k = 0; k < left.size(); ++k) {
      last[left[k]] = directions[k];
      row.touching += hulls_touch(hull, between[k]) ? 1 : 0;
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

std::vector<CullingRow> measure_culling(const SupportHull& hull, std::uint64_t max_objects,
                                        std::uint64_t seed) {
  std::vector<CullingRow> rows;
  for (const std::uint64_t objects : {2U, 10U, 100U, 1000U}) {
    if (objects > max_objects) continue;
    for (const bool near : {false, true}) rows.push_back(measure(hull, objects, near, seed));
  }
  return rows;
}

}  // namespace spm::bench
