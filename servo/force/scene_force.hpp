// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "common/base/hand_pose.hpp"
#include "common/base/wrench.hpp"
#include "common/contact/stable_stiffness.hpp"
#include "servo/force/default_settings.hpp"
#include "servo/force/force_blend.hpp"
#include "servo/force/placed_contact.hpp"
#include "servo/force/scene_listener.hpp"
#include "servo/force/tool_force.hpp"
#include "servo/force/tool_settings.hpp"
#include "servo/stabilize/stabilizer.hpp"

namespace spm {

/// What a hand touches: objects in a world, and the position of the hand's frame in it. Fixed while
/// the loop runs.
struct ForceScene {
  Placement workspace;                ///< of the hand's frame; its scale applies to lengths only
  std::vector<PlacedObject> objects;  ///< one or more
  StabilizationSettings stabilization{};  ///< of the sum, and of how the objects are touched
  /// What objects of applications are, beside what they name.
  PlacedObject added = default_object(ForceSettings{}.stiffness, {});
  bool follows_delay = false;          ///< the delay is measured; false: it is that of the settings
  std::optional<ToolSettings> tool{};  ///< empty: a point or a ball, as the objects' settings say
  /// Of the second hand and the next, where each has a tool of its own; these touch one another.
  /// Empty: all hands have such a tool, and the tools pass through one another.
  std::vector<ToolSettings> more_tools{};
};

/// Whether each hand has a tool of its own, and these touch one another.
[[nodiscard]] inline bool tools_meet(const ForceScene& scene) noexcept {
  return scene.tool && !scene.more_tools.empty();
}

/// How many tools a scene names.
[[nodiscard]] inline std::size_t tools_of(const ForceScene& scene) noexcept {
  return scene.tool ? 1 + scene.more_tools.size() : 0;
}

/// The tool of a hand; null where it has none.
[[nodiscard]] const ToolSettings* tool_of(const ForceScene& scene, std::size_t hand) noexcept;

/// A scene as it is for one hand alone.
[[nodiscard]] ForceScene scene_of_hand(ForceScene scene, std::size_t hand);

/// Whether an asset is a tool of the scene.
[[nodiscard]] bool is_tool(const ForceScene& scene, std::size_t asset) noexcept;

/// Which memory of its tool's samples is a hand's.
[[nodiscard]] inline std::size_t memory_of(const ForceScene& scene, std::size_t hand) noexcept {
  return tools_meet(scene) ? 0 : hand;
}

/// How many objects a tool of the scene may meet: with `room` for more, and the tools of others.
[[nodiscard]] inline std::size_t objects_to_meet(const ForceScene& scene,
                                                 std::size_t room) noexcept {
  return scene.objects.size() + room + (tools_meet(scene) ? tools_of(scene) : 0);
}

/// The scene of one object whose frame is the hand's.
[[nodiscard]] ForceScene scene_of(const ForceSettings& force, const EffectSettings& effects = {});

/// The force of all objects of a scene on one hand, tick by tick: the sum of the forces that the
/// objects give by their own settings, then stabilized. Construction allocates; no other call
/// allocates or throws.
class SceneForce {
 public:
  /// `tick` in s, above 0; `encoder_step` in m of the hand, 0 or more. `room`: number of objects
  /// that can be added to those of the scene. `limits` hold whatever the settings of objects say.
  /// `turning`: of the device, where the scene has a tool. `hand_number`: whose tool it is.
  SceneForce(const ForceScene& scene, double tick, double encoder_step, std::size_t room = 0,
             const FeltLimits& limits = {}, const HandTurning& turning = {},
             std::size_t hand_number = 0);

  /// Force on a probe centred at `hand`, `ticks` after the last one. Position, force and normal are
  /// in the hand's frame. The workspace's scale turns metres of the hand into metres of the world;
  /// newtons stay newtons. Depth (m of the world), normal and `deep` are those of the object that
  /// is pressed deepest. `assets`: those that the objects refer to, none null. Never NaN: a
  /// position that is not finite gives zero, and all state is forgotten.
  ///
  /// Objects for which `budget` does not suffice are not left out. One that was touched is felt by
  /// the plane at which it was touched last; the proxy of one that was not makes fewer queries. The
  /// next call with a clock begins with the first of them.
  [[nodiscard]] ContactForce next(std::span<const AssetView* const> assets, const Vector3& hand,
                                  std::uint64_t ticks = 1, const ForceBudget& budget = {}) noexcept;
  /// The same for a hand that turns. Where the scene has a tool, force and torque (N m, about the
  /// hand's position) are on a hand that holds it; depth and normal are those of the deepest patch.
  /// Without a tool the orientation is ignored, and the torque is zero. A position that is not
  /// finite, or an orientation that is not unit, gives zero, and all state is forgotten.
  [[nodiscard]] ContactForce next(std::span<const AssetView* const> assets, const HandPose& hand,
                                  std::uint64_t ticks = 1, const ForceBudget& budget = {}) noexcept;
  /// How the last force was computed.
  [[nodiscard]] const ForceEffort& effort() const noexcept { return effort_; }
  /// Tells what was sent of that force, N, the hand's frame: a soft start or a cap may have taken
  /// from it. Without it all of it counts as sent.
  void sent(const Vector3& force) noexcept { sent(Wrench{force, Vector3::Zero()}); }
  void sent(const Wrench& wrench) noexcept;

  /// Gives the tool's samples, made by the loading thread; null: none yet, and no force. Must
  /// outlive its use here. `hand_number`: which of its memories this hand may use.
  void take_tool(SampledTool* tool, std::size_t hand_number) noexcept;
  [[nodiscard]] bool has_tool() const noexcept { return tool_.has_value(); }
  /// Where tools meet: the forces on all hands, by their numbers; all of one scene, with the same
  /// room. They must outlive this, and `next` be called in that order in every tick. A tool whose
  /// hand was reset, as one without force, is not there for the others.
  void meet(std::span<SceneForce* const> hands) noexcept { hands_ = hands; }
  /// What the tool did in the last tick. Without a tool, that of a tool that never was.
  [[nodiscard]] const ToolTick& tool() const noexcept;

  /// The number of objects, including those that were removed: each object's number is below it.
  [[nodiscard]] std::size_t size() const noexcept { return objects_.size(); }
  /// Sets an object's position, m, and its rotation, unit, from now on; its scale stays. An object
  /// that a hand touches moves under it; one that moves into the hand pushes it.
  void place(std::size_t object, const Vector3& position,
             const Eigen::Quaterniond& rotation) noexcept;
  /// Adds an object and returns its number; nothing if there is no room for it. A hand that it
  /// touches feels it come, by ForceBlend.
  [[nodiscard]] std::optional<std::size_t> add(const PlacedObject& object) noexcept;
  /// Gives an object other settings, its place included. What is the same already changes nothing.
  /// Numbers of the material go over into the new ones (step_towards). A hand that touches the
  /// object stays on its side; where asset, scale or method change, the contact begins anew. What
  /// else changes, and another place, comes by ForceBlend to a hand that it touches.
  void change(std::size_t object, const PlacedObject& settings) noexcept;
  /// Gives the scene other stabilization settings. Hands stay on their sides of what they touch.
  void stabilize(const StabilizationSettings& stabilization) noexcept;
  /// Counts with a measured delay of the loop, ticks, from now on, wherever it is longer than that
  /// of the settings: in the stabilization, and in the stiffness that was chosen for the device.
  /// Hands stay on their sides.
  void set_delay(double ticks) noexcept;
  /// The delay that is counted with, ticks.
  [[nodiscard]] double counted_delay() const noexcept { return stabilization_.delay_ticks; }
  /// The same with the actuator's lag.
  [[nodiscard]] double total_delay() const noexcept { return stabilization_.total_delay(tick_); }
  /// What that leaves of the stiffness that the device holds stably at one tick, 0 to 1.
  [[nodiscard]] double stable_share() const noexcept {
    return stiffness_share(stabilization_.lag, stabilization_.delay_ticks, tick_);
  }
  /// N per metre of the hand, of the stiffest object as it is felt now.
  [[nodiscard]] double stiffest() const noexcept;
  /// N/m, of all objects that were touched in the last tick, together, as they were felt; world.
  [[nodiscard]] double touched_stiffness() const noexcept { return touched_stiffness_; }
  /// Removes an object. A hand that touched it feels it go, by ForceBlend. Its number may be given
  /// to another object.
  void remove(std::size_t object) noexcept;
  /// What the hand did to an object in the last tick: N, and N m about its origin; world frame.
  /// What stabilization takes from the hand acts on no object.
  [[nodiscard]] const Wrench& reaction(std::size_t object) const noexcept {
    return objects_[object].reaction;
  }

  /// Where a point or a ball touched an object in the last tick, and its force on the hand, N;
  /// world. Without contact the force is zero.
  [[nodiscard]] ContactPatch touch(std::size_t object) const noexcept;

  /// An object's surface as a probe at `point` sees it, world frame; unknown if there is no such
  /// object. `assets` as of `next`.
  [[nodiscard]] NearSurface near_surface(std::size_t object,
                                         std::span<const AssetView* const> assets,
                                         const Vector3& point) const noexcept;

  /// Tells every later change of the objects; null for nobody. The listener must outlive this.
  void tell(SceneListener* listener) noexcept { listener_ = listener; }

  /// Forgets all state: at the start, and when the hand was away.
  void reset() noexcept;
  /// A tick without force. Motion, friction and what is under way are forgotten; a hand stays on
  /// its side of what it touched.
  void rest() noexcept;
  /// Takes up that an asset was exchanged: what was remembered of its samples is forgotten, and
  /// hands stay on their sides.
  void exchange() noexcept;

 private:
  struct Object {
    PlacedObject settings;  ///< as they were given; the object may have moved since
    PlacedObject felt;      ///< on their way from `begun` to the settings
    PlacedObject begun;
    PlacedContact contact;  ///< as it is felt
    bool is_there = true;
    bool under_way = false;  ///< `felt` is not the settings yet
    bool changed = false;    ///< since the last tick, but not on such a way
    Wrench reaction{};
    ContactForce found{};              ///< in the last tick
    double pressed = 0;                ///< m of the world, in the last tick
    double given = 0;                  ///< J, to the contact's spring by the last step of `felt`
    Vector3 normal = Vector3::Zero();  ///< unit, world, where it was pressed

    [[nodiscard]] bool touches() const noexcept { return is_there && !reaction.force.isZero(0); }
  };

  [[nodiscard]] std::optional<std::size_t> put(const PlacedObject& object) noexcept;
  void go_on(std::uint64_t ticks) noexcept;
  void remake(Object& object) noexcept;
  void settle() noexcept;
  [[nodiscard]] ContactForce blended(const ContactForce& law, const HandPose& hand,
                                     std::uint64_t ticks) noexcept;
  [[nodiscard]] WrenchSpring spring_of_last() const noexcept;
  void make_tools(const ForceScene& scene);
  [[nodiscard]] std::span<const ToolPush> meet_tools(
      std::span<const AssetView* const> assets) noexcept;
  [[nodiscard]] ContactForce next_with_tool(std::span<const AssetView* const> assets,
                                            const HandPose& hand, std::uint64_t ticks,
                                            const ForceBudget& budget) noexcept;
  [[nodiscard]] double most_stiffness(const PlacedObject& object) const noexcept;
  [[nodiscard]] PlacedContact contact_of(const PlacedObject& object) const noexcept;
  void ask(std::span<const AssetView* const> assets, const Vector3& point, std::uint64_t ticks,
           const ForceBudget& budget) noexcept;
  [[nodiscard]] ContactEnergy energy(const Vector3& point) noexcept;
  [[nodiscard]] double share_within_limits(double deepest) const noexcept;

  Eigen::Matrix3d rotation_;
  Vector3 position_;
  double scale_;
  double tick_, encoder_step_;
  FeltLimits limits_;                    ///< of the world
  StabilizationSettings stabilization_;  ///< with the delay that is counted with
  double asked_delay_;                   ///< ticks, that of the settings
  double measured_delay_ = 0;            ///< ticks; 0: not known
  Stabilizer stabilizer_;                ///< stabilization of the sum
  double share_ = 1;                     ///< of all forces that is felt, in the last tick
  double touched_stiffness_ = 0;
  double stored_ = 0;  ///< J, in the springs of what was touched in the last tick
  ForceBlend blend_;
  bool changed_ = false;  ///< what was touched in the last tick has changed since
  bool felt_ = false;     ///< there was a last tick
  Wrench law_, last_;  ///< in the last tick: what the law gave, and what was felt; the hand's frame
  HandPose last_hand_;
  Vector3 point_ = Vector3::Zero();  ///< m, world: a point or a ball in the last tick
  double last_stiffness_ = 0;        ///< N per metre of the hand, touched then
  std::vector<Object> objects_;      ///< never grows beyond its capacity
  SceneListener* listener_ = nullptr;
  ForceEffort effort_;
  std::size_t turn_ = 0;  ///< the object with which the next tick begins
  std::optional<ToolForce> tool_;
  std::vector<ToolObject> tool_objects_;  ///< by number, for the tool; the tools of hands come last
  std::size_t hand_number_;
  std::span<SceneForce* const> hands_;  ///< whose tools meet
  std::vector<PlacedObject> tools_;     ///< of these, as objects
  std::vector<std::uint64_t> seen_;     ///< how often these had begun in the last tick
  std::vector<ToolPush> pushes_;
};

}  // namespace spm
