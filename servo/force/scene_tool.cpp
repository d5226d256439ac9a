// SPDX-License-Identifier: Apache-2.0
// What SceneForce does where the scene has a tool with six degrees of freedom.
#include <cmath>

#include "common/base/rigid_pose.hpp"
#include "servo/force/scene_force.hpp"

namespace spm {

namespace {
const ToolTick no_tool;
}  // namespace

void SceneForce::take_tool(SampledTool* tool, std::size_t hand_number) noexcept {
  if (tool_) tool_->take(tool, hand_number);
}

const ToolTick& SceneForce::tool() const noexcept { return tool_ ? tool_->tick() : no_tool; }

void SceneForce::sent(const Wrench& wrench) noexcept {
  if (tool_) {
    tool_->sent(wrench);
  } else {
    stabilizer_.sent(wrench.force);
  }
}

ContactForce SceneForce::next(std::span<const AssetView* const> assets, const HandPose& hand,
                              std::uint64_t ticks, const ForceBudget& budget) noexcept {
  if (!tool_) return next(assets, hand.position, ticks, budget);
  effort_ = {};
  touched_stiffness_ = 0;
  const double length = hand.orientation.norm();
  if (!hand.position.allFinite() || !(std::abs(length - 1) <= pose_rounding)) {
    reset();
    return {};
  }
  return next_with_tool(assets, hand, ticks, budget);
}

ContactForce SceneForce::next_with_tool(std::span<const AssetView* const> assets,
                                        const HandPose& hand, std::uint64_t ticks,
                                        const ForceBudget& budget) noexcept {
  tool_objects_.clear();
  for (const Object& object : objects_) {
    ToolObject& made = tool_objects_.emplace_back();
    if (!object.is_there) continue;
    made.asset = assets[object.contact.asset()];
    made.pose = object.contact.pose();
    made.settings = &object.settings;
  }
  ContactForce contact = tool_->next(hand, tool_objects_, ticks, budget, effort_);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    objects_[i].reaction = tool_objects_[i].reaction;
  }
  touched_stiffness_ = contact.contact ? tool_->coupling().stiffness / scale_ : 0;
  return contact;
}

}  // namespace spm
