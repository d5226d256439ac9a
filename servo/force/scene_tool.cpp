// SPDX-License-Identifier: Apache-2.0
// What SceneForce does where the scene has a tool with six degrees of freedom.
#include <algorithm>
#include <cmath>

#include "common/base/rigid_pose.hpp"
#include "servo/force/contact_part.hpp"
#include "servo/force/scene_force.hpp"

namespace spm {

namespace {
const ToolTick no_tool;
}  // namespace

/// Makes room for what the tool meets; where tools meet, they are objects as applications' are.
void SceneForce::make_tools(const ForceScene& scene) {
  for (std::size_t k = 0; tools_meet(scene) && k < tools_of(scene); ++k) {
    const ToolSettings& tool = *tool_of(scene, k);
    PlacedObject& made = tools_.emplace_back(scene.added);
    made.asset = tool.asset;
    made.placement.scale = tool.placement.scale;
  }
  seen_.resize(tools_.size(), 0);
  pushes_.reserve(tools_.size());
  tool_objects_.resize(objects_.capacity() + tools_.size());
}

/// The tools of the other hands are objects where they are now, and push.
std::span<const ToolPush> SceneForce::meet_tools(
    std::span<const AssetView* const> assets) noexcept {
  pushes_.clear();
  for (std::size_t k = 0; k < std::min(hands_.size(), tools_.size()); ++k) {
    const std::optional<ToolForce>& other = hands_[k]->tool_;
    if (k == hand_number_ || !other) continue;
    const std::size_t number = objects_.capacity() + k;
    const std::uint64_t begun = other->begun();
    if (begun != seen_[k] && begun > 0) tool_->meet_anew(number);
    seen_[k] = begun;
    if (begun == 0) continue;
    ToolObject& made = tool_objects_[number];
    made.asset = assets[tools_[k].asset];
    made.pose = other->tick().pose;
    made.settings = &tools_[k];
    made.leaving = other->leads();
    const ToolPush push = other->push_on(hand_number_);
    if (!push.wrench.force.isZero(0)) pushes_.push_back(push);
  }
  return pushes_;
}

void SceneForce::take_tool(SampledTool* tool, std::size_t hand_number) noexcept {
  if (tool_) tool_->take(tool, hand_number);
}

const ToolTick& SceneForce::tool() const noexcept { return tool_ ? tool_->tick() : no_tool; }

void SceneForce::sent(const Wrench& wrench) noexcept {
  const double share = blend_.law_share();
  Wrench law = wrench;
  // What is felt of the time before a change is no work of the law.
  if (share < 1) {
    const Wrench part{share * law_.force, share * law_.torque};
    law = contact_part(wrench, part, {last_.force - part.force, last_.torque - part.torque});
  }
  if (tool_) {
    tool_->sent(law);
  } else {
    stabilizer_.sent(law.force);
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
  go_on(ticks);
  std::fill(tool_objects_.end() - static_cast<std::ptrdiff_t>(tools_.size()), tool_objects_.end(),
            ToolObject{});
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Object& object = objects_[i];
    tool_objects_[i] = {};
    if (!object.is_there) continue;
    ToolObject& made = tool_objects_[i];
    made.asset = assets[object.contact.asset()];
    made.pose = object.contact.pose();
    made.settings = &object.felt;
  }
  const std::span<const ToolPush> pushes = meet_tools(assets);
  const ContactForce contact = tool_->next(hand, tool_objects_, pushes, ticks, budget, effort_);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    objects_[i].reaction = tool_objects_[i].reaction;
  }
  touched_stiffness_ = contact.contact ? tool_->coupling().stiffness / scale_ : 0;
  return blended(contact, hand, ticks);
}

}  // namespace spm
