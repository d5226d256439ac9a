// SPDX-License-Identifier: Apache-2.0
// A tool of a `full` asset, by the paper's equations.
#include "servo/force/paper_tool.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/rigid_pose.hpp"
#include "common/base/spread_direction.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "servo/force/pressed_part.hpp"
#include "servo/force/tool_force.hpp"

namespace spm {

namespace {

/// ns, of a cell, until it is measured.
constexpr double first_cell_time = 40;
/// Of what a tick measured, what counts for the next; and how far it may be off from what was
/// known, since a tick may be interrupted.
constexpr double learned = 0.125, farthest_off = 2;
/// Ticks of fewer cells than this tell nothing of a cell.
constexpr std::uint32_t telling_cells = 256;
/// What there is time for must have grown by this before it counts, so that the level does not
/// change from tick to tick.
constexpr double grown = 1.25;
/// Cells of the coarsest level of a map, at least.
constexpr std::uint32_t coarsest_cells = 64;
/// Samples of all maps together that outermost_places looks at, about.
constexpr double looked_at = 1e5;

Vector3 middle_of(const AssetView& asset) noexcept {
  const Extent extent = extent_of(asset);
  return extent.low + extent.size / 2;
}

/// How far a box about an asset reaches along a direction, m of the asset's frame. Rounding of
/// its places is within the slack.
double reach_along(const AssetView& asset, const Vector3& direction) noexcept {
  const Extent extent = extent_of(asset);
  const Vector3 low = extent.low.cwiseMax(asset.box_low);
  const Vector3 high = (extent.low + extent.size).cwiseMin(asset.box_high);
  const double slack = 1e-6 * extent.size.norm();
  double reach = slack;
  for (int axis = 0; axis < 3; ++axis) {
    reach += std::max(direction[axis] * low[axis], direction[axis] * high[axis]);
  }
  return reach;
}

/// Whether an asset lies wholly above a support plane of another one. `pose` takes the asset's
/// frame to the plane's.
bool above(const AssetView& asset, const Eigen::Isometry3d& pose,
           const SupportPlane& plane) noexcept {
  const double lowest =
      plane.n.dot(pose.translation()) - reach_along(asset, pose.linear().transpose() * -plane.n);
  return lowest > plane.n.dot(plane.x0);
}

std::uint32_t cells_of(const PaperLooks::Look& look, std::uint32_t level) noexcept {
  return strided_cells(look.columns, look.rows, 1U << level);
}

std::uint32_t coarsest_of(const PaperLooks::Look& look) noexcept {
  std::uint32_t level = 0;
  while (level < 16 && cells_of(look, level + 1) >= coarsest_cells) ++level;
  return level;
}

/// Places of the entries of all maps.
std::vector<Vector3> places_of(const AssetView& asset) {
  double samples = 0;
  for (const DistanceMap& map : asset.maps) samples += double(map.columns) * map.rows;
  const auto stride = static_cast<std::uint32_t>(std::max(1.0, std::sqrt(samples / looked_at)));
  std::vector<Vector3> places;
  for (std::size_t k = 0; k < asset.maps.size(); ++k) {
    const DistanceMap& map = asset.maps[k];
    for (std::uint32_t row = 0; row < map.rows; row += stride) {
      for (std::uint32_t column = 0; column < map.columns; column += stride) {
        const float distance = map.at(0, column, row);
        if (!std::isfinite(distance)) continue;
        places.push_back(reconstructed_surface(asset.planes[k], map.eta0 + column * map.spacing,
                                               map.omega0 + row * map.spacing, distance));
      }
    }
  }
  return places;
}

}  // namespace

PaperPlanes paper_planes(const AssetView& object1, const AssetView& object2,
                         const Eigen::Isometry3d& pose2) noexcept {
  PaperPlanes planes;
  if (!object1.maps_every_plane() || !object2.maps_every_plane() || !keeps_lengths(pose2)) {
    return planes;
  }
  const Vector3 line = pose2 * middle_of(object2) - middle_of(object1);
  planes.of1 = support_plane_mapping(object1.planes, line);
  planes.of2 = support_plane_mapping(object2.planes, pose2.linear().transpose() * -line);
  const SupportPlane& plane1 = object1.planes[planes.of1];
  const SupportPlane& plane2 = object2.planes[planes.of2];
  // What is below M_1 along n_1 is also below S_1. It is below S_2 as well where M_1 is, if the
  // planes look at each other.
  const bool face = plane1.n.dot(pose2.linear() * plane2.n) <= 0;
  planes.apart = above(object2, pose2, plane1) ||
                 (face && above(object1, pose2.inverse(Eigen::Isometry), plane2));
  return planes;
}

PenetrationVolume paper_overlap(const AssetView& object1, const AssetView& object2,
                                const Eigen::Isometry3d& pose2, const PaperPlanes& planes,
                                double density, std::uint32_t stride) noexcept {
  if (planes.apart) return {};
  return penetration_volume(object1, planes.of1, object2, planes.of2, pose2, density,
                            AreaFactor::paper, stride);
}

double paper_tool_area(const AssetView& tool) noexcept {
  const Vector3 size = (extent_of(tool).size.array() - 2 * tool.band.margin).max(0);
  return pressed_part * 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
}

std::vector<Vector3> outermost_places(const AssetView& asset, std::size_t directions) {
  const std::vector<Vector3> places = places_of(asset);
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < directions && !places.empty(); ++i) {
    chosen.push_back(support_mapping(places, spread_direction(i, directions)));
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  std::vector<Vector3> outermost;
  outermost.reserve(chosen.size());
  for (const std::size_t place : chosen) outermost.push_back(places[place]);
  return outermost;
}

PaperLooks::PaperLooks(std::size_t objects) : pressed_(objects, 0), cell_time_(first_cell_time) {
  looks_.reserve(objects);
}

void PaperLooks::forget() noexcept {
  std::fill(pressed_.begin(), pressed_.end(), std::uint8_t{0});
  before_ = ForceEffort::unstopped;
}

std::uint32_t PaperLooks::time_for(const ForceBudget& budget, double own) noexcept {
  if (budget.clock == nullptr) return budget.worked;
  begun_ = budget.clock();
  std::int64_t until = budget.until_ns;
  if (own > 0) until = std::min(until, begun_ + static_cast<std::int64_t>(1e9 * own));
  const auto left = static_cast<double>(std::max<std::int64_t>(0, until - begun_));
  const double most = std::min(left / cell_time_, double{ForceEffort::unstopped - 1});
  const auto cells = static_cast<std::uint32_t>(most);
  if (cells < before_ || cells > grown * before_) before_ = cells;
  return before_;
}

/// First those that pressed in the last tick; each leaves the others what they need at the least.
void PaperLooks::share_out(std::uint32_t cells) noexcept {
  double left = cells;
  for (Look& look : looks_) {
    look.level = coarsest_of(look);
    left -= cells_of(look, look.level);
  }
  for (const bool pressed : {true, false}) {
    for (Look& look : looks_) {
      if ((pressed_[look.object] != 0) != pressed) continue;
      left += cells_of(look, look.level);
      while (look.level > 0 && cells_of(look, look.level - 1) <= left) --look.level;
      left -= cells_of(look, look.level);
    }
  }
}

void PaperLooks::choose(const ForceBudget& budget, double own, ForceEffort& effort) noexcept {
  const std::uint32_t cells = time_for(budget, own);
  if (cells != ForceEffort::unstopped) share_out(cells);
  for (const Look& look : looks_) effort.level = std::max(effort.level, look.level);
  if (effort.level > 0) effort.worked = cells;
}

void PaperLooks::end(const ForceBudget& budget) noexcept {
  if (budget.clock == nullptr) return;
  std::uint32_t cells = 0;
  for (const Look& look : looks_) cells += cells_of(look, look.level);
  if (cells < telling_cells) return;
  const auto took = static_cast<double>(budget.clock() - begun_) / cells;
  const double counted = std::clamp(took, cell_time_ / farthest_off, cell_time_ * farthest_off);
  cell_time_ += learned * (counted - cell_time_);
}

/// Finds the objects of method `paper` that the tool may share volume with. Tool and object have
/// one scale (check_tool_scale).
void ToolForce::look_by_paper(const Eigen::Isometry3d& device, std::span<const ToolObject> objects,
                              const ForceBudget& budget, ForceEffort& effort) noexcept {
  const AssetView& tool = *tool_->paper();
  looks_.begin();
  damps_ = false;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ToolObject& object = objects[i];
    if (object.asset == nullptr || object.settings->force.method != Method::paper) continue;
    if (!(object.settings->force.stiffness > 0)) continue;
    PaperLooks::Look look;
    look.object = static_cast<std::uint32_t>(i);
    look.pose2 = object.pose.inverse(Eigen::Isometry) * (device * seat_);
    look.pose2.translation() /= settings_.placement.scale;
    look.planes = paper_planes(*object.asset, tool, look.pose2);
    if (look.planes.apart) {
      looks_.note(look.object, false);
      ++effort.culled;
      continue;
    }
    const DistanceMap& map = tool.maps[look.planes.of2];
    look.columns = map.columns;
    look.rows = map.rows;
    looks_.add(look);
    damps_ = damps_ || object.settings->effects.damping > 0;
  }
  looks_.choose(budget, settings_.budget, effort);
}

/// The objects of method `paper`, where the tool's asset is `full`: one force each, at the centre
/// of the volume that both share.
void ToolForce::press_by_paper(const Eigen::Isometry3d& device, std::span<ToolObject> objects,
                               const ForceBudget& budget, Felt& felt,
                               ForceEffort& effort) noexcept {
  const AssetView& tool = *tool_->paper();
  const double scale = settings_.placement.scale;
  const double area = paper_tool_area(tool) * scale * scale;
  look_by_paper(device, objects, budget, effort);
  for (const PaperLooks::Look& look : looks_.looks()) {
    ToolObject& object = objects[look.object];
    const ForceSettings& felt_as = object.settings->force;
    const PenetrationVolume found = paper_overlap(*object.asset, tool, look.pose2, look.planes,
                                                  felt_as.density, 1U << look.level);
    looks_.note(look.object, found.volume > 0);
    if (!(found.volume > 0)) continue;
    // The force goes by the mass of eq. 12, and is no stiffer than the device allows.
    const double stiffness =
        std::min(felt_as.stiffness * found.mass / found.volume, loop_.limits.stiffness / scale_);
    if (!(stiffness > 0)) continue;
    const Vector3 centre = object.pose * (scale * found.centre);
    const Vector3 normal = object.pose.linear() * found.normal;
    const double pressed = found.area * scale * scale, share = std::min(1.0, pressed / area);
    // The mean of f of eq. 13. The stiffness is reached, and not exceeded.
    const double depth = found.volume / found.area * scale;
    const Vector3 force = stiffness * share * depth * normal;
    const Vector3 arm = centre - device.translation();
    felt.contact = true;
    felt.wrench.force += force;
    felt.wrench.torque += arm.cross(force);
    felt.stiffness += share * stiffness;
    felt.turning += share * stiffness * arm.squaredNorm();
    // As a spring of that stiffness.
    felt.stored += share * stiffness * depth * depth / 2;
    object.reaction = {-force, -(centre - object.pose.translation()).cross(force)};
    if (tick_.patch_count == max_patches) continue;
    tick_.patches[tick_.patch_count++] = {centre, normal, force, depth, look.object};
  }
  looks_.end(budget);
}

}  // namespace spm
