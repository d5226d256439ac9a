// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/base/hand_pose.hpp"
#include "common/base/wrench.hpp"
#include "common/sixdof/virtual_tool.hpp"
#include "servo/force/force_budget.hpp"
#include "servo/force/paper_tool.hpp"
#include "servo/force/patch_list.hpp"
#include "servo/force/placed_contact.hpp"
#include "servo/force/sampled_tool.hpp"
#include "servo/force/tool_coupling.hpp"
#include "servo/force/tool_culling.hpp"
#include "servo/force/tool_escape.hpp"
#include "servo/force/tool_levels.hpp"
#include "servo/stabilize/velocity_estimate.hpp"
#include "servo/stabilize/wrench_stabilizer.hpp"

namespace spm {

/// An object of the scene as a tool meets it in a tick; the world's frame.
struct ToolObject {
  const AssetView* asset = nullptr;  ///< null: there is no object of this number
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const PlacedObject* settings = nullptr;
  bool leaving = false;  ///< the tool of another hand, which is led out of what it lies in
  Wrench reaction;  ///< what the tool does to it, N, and N m about its origin; written by a tick
};

/// What the tool of another hand presses this one's with, by the springs of that hand; world.
struct ToolPush {
  std::size_t hand = 0;                   ///< the other's number
  Wrench wrench;                          ///< N, and N m about the origin of this tool's frame
  double stiffness = 0;                   ///< N/m, by which the force falls as this tool gives way
  double turning = 0;                     ///< N m/rad, the same of the torque
  std::span<const ContactPatch> patches;  ///< the other's; those with this hand's tool count
};

/// The force and torque of a scene's objects on a tool that a hand holds, tick by tick.
///
/// Objects of method `proxy` hold a virtual tool back, which a coupling pulls to the hand
/// (VirtualTool); objects of method `spm` push the tool at the hand's own pose, sample by sample.
/// A tool of a `full` asset is pushed by objects of method `paper` alone, each with one force.
///
/// Where the tools of hands meet, each is an object for the others, so that none runs into another,
/// and each is pushed by what another's hand presses it with: its virtual tool comes to where its
/// own springs, the pushes and what holds it back are in balance. A push falls as the tool gives
/// way, as the springs of the other hand do.
/// Construction allocates; no other call allocates or throws.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): what belongs together stands together.
class ToolForce {
 public:
  /// `workspace`: of the hand's frame in the world. `objects`: the largest number of them. After
  /// these come the tools of `tools` hands, this one's, number `hand`, among them.
  ToolForce(const ToolSettings& settings, const ToolLoop& loop,
            const StabilizationSettings& stabilization, const Placement& workspace,
            std::size_t objects, std::size_t tools = 0, std::size_t hand = 0);

  /// What the tool is made of from now on; null: nothing, and no force. It begins where the one
  /// before was. Must outlive its use here.
  void take(SampledTool* tool, std::size_t hand) noexcept;

  /// Force and torque on the hand at `hand` (its frame), torque about its position, `ticks` after
  /// the last call. `hand` must be finite, and its orientation unit. `objects` by their numbers,
  /// with room for no more than the constructor was told. `pushes`: of the tools of other hands.
  [[nodiscard]] ContactForce next(const HandPose& hand, std::span<ToolObject> objects,
                                  std::span<const ToolPush> pushes, std::uint64_t ticks,
                                  const ForceBudget& budget, ForceEffort& effort) noexcept;
  [[nodiscard]] const ToolTick& tick() const noexcept { return tick_; }
  /// Tells what was sent of the wrench that `next` returned.
  void sent(const Wrench& wrench) noexcept { stabilizer_.sent(wrench); }

  /// `stable_share`: as of ToolLoop.
  void stabilize(const StabilizationSettings& stabilization, double stable_share) noexcept;
  /// The account of what can be given back begins anew: an object was removed.
  void rebalance() noexcept { stabilizer_.reset(); }
  /// Forgets all: the next tick begins at the hand's pose.
  void reset() noexcept;
  /// A tick without force: the virtual tool stays on its side of what holds it back, and goes with
  /// the object that it pressed most, unless that moves by more than kept_way or kept_turn. All
  /// else is forgotten. One that was leaving something forgets all.
  void rest() noexcept;
  /// Takes up that the field of an object was exchanged, or another took its number.
  void exchange(std::size_t object) noexcept;
  /// How often the tool has begun; 0 while it is nowhere, or rests.
  [[nodiscard]] std::uint64_t begun() const noexcept {
    return placed_ && !rests_ && tool_ != nullptr ? starts_ : 0;
  }
  /// Whether it is led out of what it lies in; those that it lies in stay where they are.
  [[nodiscard]] bool leads() const noexcept { return placed_ && escape_ && escape_->leads(); }
  /// A tool of another hand has begun, perhaps inside this one: they leave each other slowly.
  void meet_anew(std::size_t object) noexcept;
  /// What this tool presses that of another hand with, since the last tick.
  [[nodiscard]] ToolPush push_on(std::size_t hand) const noexcept;

  [[nodiscard]] const ToolCoupling& coupling() const noexcept { return coupling_; }

 private:
  /// The sum of a tick before it is stabilized; the world's frame, torque about the hand.
  struct Felt {
    Wrench wrench;
    bool contact = false;
    double stiffness = 0, turning = 0;  ///< N/m, N m/rad
    double stored = 0;                  ///< J
  };
  /// The pushes of a tick together; the world's frame, about the virtual tool's position.
  struct Pushed {
    Wrench wrench;
    double stiffness = 0, turning = 0;
    [[nodiscard]] bool any() const noexcept { return stiffness > 0; }
  };
  /// What is left of a tick's budget.
  struct Work {
    VirtualToolBudget budget;
    std::uint32_t done = 0;  ///< samples
    std::uint32_t level = 0;
    std::uint32_t unresolved = 0;  ///< objects that time ran out for
    std::uint32_t looks = 0;       ///< of the virtual tool
    bool follows = true;           ///< it came near its balance
  };

  [[nodiscard]] Eigen::Isometry3d world_pose(const HandPose& hand) const noexcept;
  void sort_out(std::span<const ToolObject> objects, const Eigen::Isometry3d& device,
                ForceEffort& effort) noexcept;
  [[nodiscard]] bool holds(std::size_t number, const PlacedObject& object) const noexcept;
  [[nodiscard]] bool begins_inside(const Eigen::Isometry3d& device) noexcept;
  [[nodiscard]] ContactObject contact_object(const ToolObject& object, bool holds) const noexcept;
  [[nodiscard]] double work_of(std::span<const ToolObject> objects) noexcept;
  [[nodiscard]] double way_of(const ToolObject& object, std::size_t number) const noexcept;
  [[nodiscard]] Eigen::Isometry3d on_way(const ToolObject& object, std::size_t number,
                                         double share) const noexcept;
  void move_on(std::span<const ToolObject> objects, double from, double to) noexcept;
  [[nodiscard]] bool may_wait(double gone) const noexcept;
  void sit_down(std::span<const ToolObject> objects) noexcept;
  [[nodiscard]] Vector3 moved_at(const ContactPatch& patch,
                                 const ToolObject& object) const noexcept;
  void note_carrier() noexcept;
  [[nodiscard]] Work begin_work(const ForceBudget& budget) const noexcept;
  void touch(const Eigen::Isometry3d& device, std::span<ToolObject> objects,
             std::span<const ToolPush> pushes, const ForceBudget& budget, Felt& felt,
             ForceEffort& effort) noexcept;
  void take_pushes(std::span<const ToolPush> pushes) noexcept;
  [[nodiscard]] CoupledSprings springs() const noexcept;
  [[nodiscard]] VirtualToolReport tick_of_virtual(const Eigen::Isometry3d& device,
                                                  const VirtualToolBudget& budget) noexcept;
  void press_tools(std::span<const ToolObject> objects, std::span<const ToolPush> pushes,
                   const Eigen::Isometry3d& device) noexcept;
  [[nodiscard]] bool touches(std::size_t tool) noexcept;
  [[nodiscard]] Wrench pressed_with(std::size_t tool, std::span<const ToolPush> pushes,
                                    const Eigen::Isometry3d& device) const noexcept;
  void add_mirrored(const ToolPush& push) noexcept;
  void tell_tools() noexcept;
  void push(const Eigen::Isometry3d& device, Work& work, Felt& felt, ForceEffort& effort) noexcept;
  void hold(const Eigen::Isometry3d& device, std::span<const ToolObject> objects, Work& work,
            Felt& felt, ForceEffort& effort) noexcept;
  [[nodiscard]] VirtualToolReport follow(const Eigen::Isometry3d& device,
                                         std::span<const ToolObject> objects, Work& work,
                                         ForceEffort& effort) noexcept;
  [[nodiscard]] VirtualToolReport leave(const Eigen::Isometry3d& device,
                                        std::span<const ToolObject> objects, Work& work,
                                        ForceEffort& effort) noexcept;
  [[nodiscard]] bool another_leads(std::span<const ToolObject> objects) const noexcept;
  [[nodiscard]] bool waits(std::span<const ToolObject> objects) const noexcept;
  void note_lie() noexcept;
  void forget_motion() noexcept;
  [[nodiscard]] bool stays_after_rest(std::span<const ToolObject> objects) noexcept;
  void begin(const HandPose& hand, const Eigen::Isometry3d& device,
             std::span<const ToolObject> objects) noexcept;
  void put() noexcept;
  [[nodiscard]] bool step_on(const Eigen::Isometry3d& device, std::uint32_t steps, Work& work,
                             ForceEffort& effort, VirtualToolReport& report) noexcept;
  void look_by_paper(const Eigen::Isometry3d& device, std::span<const ToolObject> objects,
                     const ForceBudget& budget, ForceEffort& effort) noexcept;
  void press_by_paper(const Eigen::Isometry3d& device, std::span<ToolObject> objects,
                      const ForceBudget& budget, Felt& felt, ForceEffort& effort) noexcept;
  void end_work(const Work& work, ForceEffort& effort) noexcept;
  void react(std::span<ToolObject> objects, const Eigen::Isometry3d& pose,
             const Eigen::Isometry3d& device, double share, const Wrench& felt) noexcept;
  [[nodiscard]] double share_felt(const Eigen::Isometry3d& pose, const Eigen::Isometry3d& device,
                                  double share, const Wrench& felt) const noexcept;
  void damp(const HandPose& hand, std::span<const ToolObject> objects, std::uint64_t ticks,
            Felt& felt) noexcept;
  [[nodiscard]] ContactForce deepest() const noexcept;

  ToolSettings settings_;
  ToolLoop loop_;
  StabilizationSettings stabilization_;
  ToolCoupling coupling_;  ///< of the hand
  Eigen::Matrix3d rotation_;
  Vector3 position_;
  double scale_;
  Eigen::Isometry3d seat_;  ///< the tool's frame in that of the device's tool, m of the world
  WrenchStabilizer stabilizer_;
  SampledTool* tool_ = nullptr;
  ObjectContact* contact_ = nullptr;
  ToolCulling* culling_ = nullptr;
  std::optional<VirtualTool> virtual_;
  std::optional<ToolEscape> escape_;
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();  ///< of the virtual tool's grip, world
  std::vector<ContactObject> held_, pushed_;                ///< by the numbers of objects
  std::vector<Eigen::Isometry3d> seats_;                    ///< of the objects, in the last tick
  std::vector<std::uint8_t> seated_;                        ///< whether that is known
  /// m: how far objects moved past the tool since then; 0 where they did not, or jumped.
  std::vector<double> ways_;
  std::vector<double> late_;  ///< m, of these ways, what time did not suffice for in the last tick
  std::vector<std::uint8_t> unmet_;  ///< objects that the tool may have begun in, or was put into
  /// Those of method `spm` that it began deep in: they hold a virtual tool until the hand is out.
  std::vector<std::uint8_t> left_;
  double gone_ = 1;                ///< the part of these ways that the objects went in this tick
  double longest_way_ = 0;         ///< m, of the objects that hold
  std::uint32_t parts_ = 1;        ///< in which these go their ways in this tick
  std::size_t carrier_ = 0;        ///< the moving object that the tool presses most; or none
  std::vector<Wrench> reactions_;  ///< on the objects, in the last tick
  double most_force_ = 0;          ///< N, of the coupling in the world
  std::size_t first_tool_, hand_;  ///< number of the first tool of a hand, and which is this one's
  Pushed push_;                    ///< in this tick
  PaperLooks looks_;               ///< of a tool of a `full` asset
  /// How this tool touches that of another hand.
  struct Met {
    Wrench given;                   ///< to it, about its frame's origin
    Vector3 out = Vector3::Zero();  ///< out of it, where it was touched last
    std::uint32_t ticks = 0;        ///< that it counts as touched
    double softly = 1;              ///< the part of it that is given: less after it was led out
  };
  std::vector<Met> met_;      ///< by hands
  std::uint64_t starts_ = 0;  ///< how often it has begun
  ToolLevels levels_;
  bool placed_ = false;       ///< the virtual tool is somewhere
  bool rests_ = false;        ///< there was no force since the last tick
  std::size_t leant_on_ = 0;  ///< the object that a tool that rests pressed most; or none
  bool any_held_ = false, any_pushed_ = false, any_unmet_ = false;
  bool same_objects_ = false;                        ///< those that hold, as in the last tick
  bool damps_ = false;                               ///< an object that is near damps
  VelocityEstimate place_velocity_, turn_velocity_;  ///< of the hand, its frame
  Vector3 turned_ = Vector3::Zero();                 ///< rad, the sum of all small turns
  Eigen::Quaterniond orientation_ = Eigen::Quaterniond::Identity();
  ToolTick tick_;
  PatchList patches_;
};

}  // namespace spm
