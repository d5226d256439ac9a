// SPDX-License-Identifier: Apache-2.0
#include "servo/force/tool_escape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/query/query.hpp"

namespace spm {

namespace {

/// Samples that stand for the tool, at most.
constexpr std::uint32_t most_samples = 2048;
/// Ticks in a row after which a tool that lies deep is led; what moves fast is deep for a few.
constexpr std::uint32_t patience_deep = 20;
/// Ticks after which one is led that the fields' normals do not bring out.
constexpr std::uint32_t patience_emerging = 200;
/// Queries of a tick while a way is looked for; some tens of microseconds.
constexpr int queries_per_tick = 128;
/// What a sum over all samples takes, in queries.
constexpr int looks_of_sum = 16;
/// The first way is this part of the tool's radius; the next are longer by this factor each.
constexpr double first_part = 0.125, growth = 1.2;

Vector3 vector(const std::array<float, 3>& v) noexcept { return {v[0], v[1], v[2]}; }

/// The middle of an object's box, world.
Vector3 middle_of(const ContactObject& object) noexcept {
  const Extent extent = extent_of(*object.field);
  return object.pose * (object.scale * (extent.low + extent.size / 2));
}

}  // namespace

std::uint32_t level_within(const SurfaceSamples& tool, std::uint32_t most) noexcept {
  std::uint32_t found = 0;
  for (std::uint32_t k = 0; k < tool.levels.size(); ++k) {
    if (tool.levels[k].count <= most) found = k;
  }
  return found;
}

ToolEscape::ToolEscape(const SurfaceSamples& tool) noexcept : tool_(&tool) {
  if (!tool.levels.empty()) level_ = tool.levels[level_within(tool, most_samples)];
}

void ToolEscape::reset() noexcept {
  phase_ = Phase::none;
  was_put_ = true;
  deep_ticks_ = emerging_ticks_ = 0;
}

/// Whether the middle of an object's box is solid, and in the tool: no sample touches an object
/// that is in it as a whole.
bool ToolEscape::has_in_it(const Eigen::Isometry3d& tool,
                           const ContactObject& object) const noexcept {
  const Extent extent = extent_of(*object.field);
  if (!(query_point(*object.field, extent.low + extent.size / 2).distance < 0)) return false;
  const Vector3 middle = tool.inverse(Eigen::Isometry) * middle_of(object);
  if ((middle - tool_->centre).norm() > tool_->radius) return false;
  // The solid angle that the surface fills as seen from there.
  double angle = 0;
  for (std::uint32_t i = level_.first; i < level_.first + level_.count; ++i) {
    const Vector3 arm = vector(tool_->places[i].position) - middle;
    const double square = arm.squaredNorm();
    if (!(square > 0)) continue;
    const SampleShare& share = tool_->shares[i];
    angle +=
        static_cast<double>(share.area) * share.normal().dot(arm) / (square * std::sqrt(square));
  }
  return angle > 2 * std::numbers::pi;
}

/// Whether the tool's sphere meets an object's box.
bool ToolEscape::may_meet(const Eigen::Isometry3d& tool,
                          const ContactObject& object) const noexcept {
  const Extent extent = extent_of(*object.field);
  const Vector3 centre = object.pose.inverse(Eigen::Isometry) * (tool * tool_->centre);
  const Vector3 low = object.scale * extent.low, high = low + object.scale * extent.size;
  return (low - centre).cwiseMax(centre - high).cwiseMax(0).norm() <= tool_->radius;
}

bool ToolEscape::is_inside(std::uint32_t sample, const Eigen::Isometry3d& tool,
                           const ContactObject& object) const noexcept {
  const Vector3 place = tool * vector(tool_->places[level_.first + sample].position);
  const Vector3 there = object.pose.inverse(Eigen::Isometry) * place;
  // Outside of the margin the distance is no number.
  return query_point(*object.field, there / object.scale).distance < 0;
}

void ToolEscape::note(const Lie& lie, const Eigen::Isometry3d& tool,
                      std::span<const ContactObject> objects) noexcept {
  deep_ticks_ = lie.deep ? deep_ticks_ + 1 : 0;
  emerging_ticks_ = lie.emerging ? emerging_ticks_ + 1 : 0;
  for (std::size_t i = 0; was_put_ && i < objects.size(); ++i) {
    const ContactObject& object = objects[i];
    if (object.field == nullptr || !surrounds(tool, object)) continue;
    begin(i, tool, objects);
    contains_ = true;
    was_put_ = false;
    return;
  }
  was_put_ = false;
  contains_ = false;
  if (deep_ticks_ >= patience_deep || emerging_ticks_ >= patience_emerging) {
    begin(lie.object, tool, objects);
  }
}

void ToolEscape::begin(std::size_t object, const Eigen::Isometry3d& tool,
                       std::span<const ContactObject> objects) noexcept {
  deep_ticks_ = emerging_ticks_ = 0;
  if (object >= objects.size() || objects[object].field == nullptr) return;
  phase_ = Phase::looks;
  const Eigen::Matrix3d axes = objects[object].pose.linear();
  std::size_t made = 0;
  // Along the axes first, then between two and three of them.
  for (int between = 1; between <= 3; ++between) {
    for (int k = 0; k < 27; ++k) {
      const int x = k % 3 - 1, y = k / 3 % 3 - 1, z = k / 9 - 1;
      const Vector3 along(x, y, z);
      if (static_cast<int>(along.squaredNorm()) != between) continue;
      directions_[made++] = axes * along.normalized();
    }
  }
  const Vector3 away = tool * tool_->centre - middle_of(objects[object]);
  away_ = away.norm() > 0 ? Vector3(away.normalized()) : Vector3(axes.col(0));
  farthest_ = 2 * tool_->radius + away.norm();
  for (const ContactObject& other : objects) {
    if (other.field == nullptr || !may_meet(tool, other)) continue;
    farthest_ =
        std::max(farthest_, other.scale * extent_of(*other.field).size.norm() + 2 * tool_->radius);
  }
  distance_ = first_part * tool_->radius;
  direction_ = object_ = 0;
  sample_ = blocking_ = 0;
}

/// Goes on to the next way: all directions, then a longer one.
void ToolEscape::try_next() noexcept {
  object_ = 0;
  sample_ = 0;
  if (++direction_ < direction_count) return;
  direction_ = 0;
  distance_ *= growth;
}

/// Tries ways until one is free, or the work of a tick is done.
void ToolEscape::look(const Eigen::Isometry3d& tool,
                      std::span<const ContactObject> objects) noexcept {
  for (int asked = 0; asked < queries_per_tick;) {
    if (!(distance_ <= farthest_)) {
      way_ = away_;
      left_ = farthest_;
      phase_ = Phase::leads;
      return;
    }
    if (object_ == objects.size()) {
      way_ = directions_[direction_];
      left_ = distance_;
      phase_ = Phase::leads;
      return;
    }
    const ContactObject& object = objects[object_];
    Eigen::Isometry3d there = tool;
    there.translation() += distance_ * directions_[direction_];
    // Numbers without an object are no work: a replay has fewer of them.
    asked += object.field != nullptr ? 1 : 0;
    if (object.field == nullptr || sample_ == level_.count || !may_meet(there, object)) {
      ++object_;
      sample_ = 0;
    } else if (sample_ == 0 && has_in_it(there, object)) {
      asked += looks_of_sum;
      try_next();
    } else {
      // What ended the last way ends this one as well, mostly.
      const std::uint32_t sample = (sample_ + blocking_) % level_.count;
      ++sample_;
      if (is_inside(sample, there, object)) {
        blocking_ = sample;
        try_next();
      }
    }
  }
}

Vector3 ToolEscape::next(const Eigen::Isometry3d& tool, std::span<const ContactObject> objects,
                         double most) noexcept {
  if (phase_ == Phase::looks) look(tool, objects);
  if (phase_ != Phase::leads) return Vector3::Zero();
  const double step = std::min(most, left_);
  left_ -= step;
  if (!(left_ > 0)) phase_ = Phase::none;
  return step * way_;
}

}  // namespace spm
