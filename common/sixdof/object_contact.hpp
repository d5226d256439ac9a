// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "common/contact/surface_texture.hpp"
#include "common/query/query_cursor.hpp"
#include "common/sixdof/cluster_sums.hpp"
#include "common/sixdof/coarse_press.hpp"
#include "common/sixdof/contact_grip.hpp"
#include "common/sixdof/contact_step.hpp"
#include "common/sixdof/contact_sum.hpp"
#include "common/sixdof/sample_vectors.hpp"
#include "common/sixdof/surface_samples.hpp"
#include "common/sixdof/work_clock.hpp"

namespace spm {

/// An object that the tool may touch: its baked field, and the pose and scale that take its frame
/// to the world's: p_world = pose * (scale * p).
struct ContactObject {
  const AssetView* field = nullptr;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  double scale = 1;           ///< above 0
  double stiffness = 0;       ///< N/m3; 0: that of the settings
  double least_area = 0;      ///< m2: what a sample counts for at least
  GripSettings grip{};        ///< friction, of the finest samples alone
  TextureSettings texture{};  ///< m of the world; of the finest samples alone
};

struct ObjectContactSettings {
  double stiffness = 1e9;            ///< N/m3: N/m for a square metre of contact
  std::uint32_t objects = 1;         ///< largest number of objects, below 2048
  std::uint32_t max_active = 65536;  ///< largest number of samples above the finest that may touch
                                     ///< at once; beyond it coarser ones are used
};

/// Result of a tick.
struct ObjectContactReport {
  ContactSum sum;           ///< on the tool, world frame, torques about the tool's origin
  std::uint32_t level = 0;  ///< of SurfaceSamples: all contact was resolved to this level
  double refined = 0;       ///< part of the contact that was resolved to the next level, below 1
  /// m: no sample touches before tool and objects have moved this far relative to each other; 0 in
  /// contact
  double clearance = std::numeric_limits<double>::infinity();
  std::uint64_t asked = 0;       ///< queries of a field
  std::uint64_t tested = 0;      ///< samples whose distance was evaluated
  std::uint32_t worked = 0;      ///< samples below the coarsest level, as TickBudget counts them
  std::uint32_t unresolved = 0;  ///< objects that time ran out for, before the finest level
  bool stopped = false;          ///< there was one
  bool degraded = false;         ///< time or space ran out before the finest level
};

/// What pushes the tool at one object within one cluster of samples; world frame, about the tool's
/// origin.
struct PressedPatch {
  std::uint32_t object = 0;
  std::uint32_t cluster = 0;         ///< a sample that all of its samples are below
  double pressing = 0;               ///< N, sum of the sizes of all forces of springs
  double depth = 0;                  ///< m, of the deepest sample
  Vector3 force = Vector3::Zero();   ///< N, on the tool
  Vector3 torque = Vector3::Zero();  ///< N m
  /// N, N m: of springs alone, in the axes that its object is summed in.
  Vector3 springs = Vector3::Zero(), springs_torque = Vector3::Zero();
  Vector3 moment = Vector3::Zero();       ///< N m: pressing times place
  Vector3 pressure = Vector3::Zero();     ///< N: pressing times normal, out of the object
  Vector3 grip = Vector3::Zero();         ///< N, of bristles, before their sum is bounded
  Vector3 grip_torque = Vector3::Zero();  ///< N m, of the same
};

inline void add(PressedPatch& patch, double force, double depth, const Vector3& along,
                const Vector3& normal, const Vector3& arm) noexcept {
  patch.pressing += force;
  patch.depth = std::max(patch.depth, depth);
  patch.springs += force * along;
  patch.springs_torque += force * arm.cross(along);
  patch.moment += force * arm;
  patch.pressure += force * normal;
}

/// Contact of a tool's sampled surface with the fields of other objects. Each sample of area a at
/// depth d pushes with the stiffness times a d along the field's normal: the gradient of the
/// potential 1/2 k a d^2. Friction and texture act on the finest samples.
///
/// The samples form a tree of spheres. A node that the field shows to be clear, or below which all
/// samples are, is skipped with everything below it, until the objects could have moved far enough
/// to touch; so is an object that a support plane parts from the tool. Of each object coarse levels
/// are evaluated first, so that there is an answer when time runs out: first of those that pressed
/// before. A coarse sample represents a patch, and only the part of the patch below the surface
/// counts. Below the field's band the depth stays that of the band's end.
///
/// A tick that is told an accuracy (TickBudget::accuracy) stops at a level whose sum the next one
/// would hardly change, object by object and cluster by cluster; between two levels both count, so
/// that the force does not jump. There a finest sample is a small square, as coarse ones are
/// patches, and where few touch it is divided into smaller ones; a coarse one counts what the field
/// bends by over its patch, and of the last two levels above the finest one that the field's plane
/// parts from the object is let go, without being called clear.
///
/// A tick that is told how far the next ones go (TickBudget::ahead) lists the samples of each
/// object that may touch by then; within that way the next ones look at these alone.
///
/// Built at load time (allocates); `tick` neither allocates nor throws, and reads the clock every
/// few samples. To be used by one thread at a time.
class ObjectContact {
 public:
  /// `tool` must outlive this.
  ObjectContact(const SurfaceSamples& tool, const ObjectContactSettings& settings);

  /// `tool_pose` takes the tool's frame to the world's. `objects` must have the same order every
  /// tick, and all must be `sparse`; those without a field, and objects beyond the number in the
  /// settings, are ignored. A pose may mirror. A pose that scales (for example one made of a
  /// quaternion that is not of unit length), shears or is not finite gives no contact.
  [[nodiscard]] ObjectContactReport tick(const Eigen::Isometry3d& tool_pose,
                                         std::span<const ContactObject> objects,
                                         const TickBudget& budget = {}) noexcept;

  /// Must be called when an object's field was replaced by another.
  void forget(std::uint32_t object) noexcept;
  /// Forgets all, as if it were new.
  void forget() noexcept;

  /// Keeps what pressed in the last tick as `patches`, until the next `keep` or `drop`.
  void keep() noexcept;
  /// Samples within `TickBudget::near` of touching in the look that was kept, and in the last one;
  /// the world's frame, about the tool's origin. Null where they are not known: there was no time
  /// to look at all, coarse ones count as patches, or they were too many.
  [[nodiscard]] const std::vector<NearContact>* kept_near() const noexcept {
    return kept_near_known_ ? &kept_contacts_ : nullptr;
  }
  [[nodiscard]] const std::vector<NearContact>* last_near() const noexcept {
    return near_known_ ? &contacts_ : nullptr;
  }
  /// Room for planes of a caller, who must not make it grow.
  [[nodiscard]] std::vector<NearContact>& room() noexcept { return room_; }
  void drop() noexcept {
    kept_near_known_ = false;
    kept_.clear();
    kept_touches_.clear();
  }
  [[nodiscard]] std::span<const PressedPatch> patches() const noexcept { return kept_; }
  /// Ends a tick of friction: anchors move with what was kept. Once a tick of the loop.
  void settle() noexcept;
  /// Whether that changed what friction holds the tool with: then a look anew tells another sum.
  [[nodiscard]] bool grip_moved() const noexcept { return grip_.moved(); }
  /// The sum that a look anew would tell where the tool was kept, if nothing has changed since but
  /// friction; `patches` tell it too. False where not all samples are known that friction holds.
  [[nodiscard]] bool grip_anew(ContactSum& sum) noexcept;

  /// Bytes that answers come from, beside the tool's samples.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  /// A sample that may touch.
  struct Active {
    std::uint32_t sample = 0;
    std::uint16_t object = 0, cluster = 0;
    /// Signed, m; a lower bound where the normal is zero, and minus infinity where it is not known.
    float distance = -std::numeric_limits<float>::infinity();
    /// Unit, outward; object's frame, or the tool's where levels are settled: there it is zero
    /// also where nothing presses (needs_normal).
    std::array<float, 3> normal{};
    // Where levels are settled:
    float half = 0;    ///< m: how far parts of its patch are deeper or higher
    float weight = 1;  ///< how much it, and all below it, counts
    /// 1/m: trace of the field's bend, where there is a normal; not a number where the distance is
    /// a bound.
    float bend = std::numeric_limits<float>::quiet_NaN();
    [[nodiscard]] bool exact() const noexcept { return !std::isnan(bend); }
    [[nodiscard]] bool known() const noexcept {
      return distance > -std::numeric_limits<float>::infinity();
    }
    [[nodiscard]] bool has_normal() const noexcept {
      return normal[0] != 0 || normal[1] != 0 || normal[2] != 0;
    }
  };
  /// A finest sample that may touch before the way `TickBudget::ahead` is over.
  struct Near {
    std::uint32_t sample = 0;
    std::uint16_t object = 0, cluster = 0;
    float until = 0;  ///< it need not be asked before its cluster's way is this long
    /// The plane that was met last, object's frame, unit and m; zero where it is not known.
    std::array<float, 3> normal{};
    float offset = 0;
  };
  /// The sum over an object's contacts of a level, tool's axes, about the tool's origin.
  struct LevelSum {
    Vector3 force = Vector3::Zero();   ///< N
    Vector3 torque = Vector3::Zero();  ///< N m
    double pressing = 0;               ///< N: of the sizes of forces
    double contacts = 0;               ///< the parts of patches that press, added up
  };
  /// How a level of an object's contacts is settled.
  struct Settling {
    double few = 1;     ///< how much it says nothing of its own error, for want of contacts
    double silent = 1;  ///< the same of clusters in which nothing presses
    double most = 1;    ///< how much is to be refined at most, where it does
    double per_force = 0, per_torque = 0;  ///< 1/N, 1/(N m): over the sizes of its sums
    double changes = 0, squares = 0;       ///< of those of its clusters, their sum, of squares too
    [[nodiscard]] double change(const ClusterChange& of) const noexcept {
      return std::max(static_cast<double>(of.force) * per_force,
                      static_cast<double>(of.torque) * per_torque);
    }
  };
  struct Pair {
    /// Tool's frame to the object's, in metres of the world.
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d kept = Eigen::Isometry3d::Identity();     ///< the same of what was kept
    Eigen::Isometry3d settled = Eigen::Isometry3d::Identity();  ///< the same at the last settling
    Eigen::Isometry3d looked_at =
        Eigen::Isometry3d::Identity();  ///< the same in the last look at all
    const AssetView* field = nullptr;
    double scale = 1;  ///< metres of the world for one of the field
    double stiffness = 0, least_area = 0;
    double doubt = 0;       ///< m, of a clearance
    double lift = 0;        ///< m, by which texture may raise the surface
    double field_ends = 0;  ///< m: the field tells nothing of places that are farther away
    GripSettings grip;
    TextureSettings texture;
    Eigen::Matrix3d to_world = Eigen::Matrix3d::Identity();
    /// Takes the axes of `sum` and of patches to the world's.
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    double side = 1;          ///< -1 where these axes mirror
    ContactSum sum;           ///< in this tick, object's or tool's axes, about the tool's origin
    ContactSum kept_sum;      ///< the same of what was kept
    ContactSum grip_sum;      ///< of its bristles
    double gripped = 0;       ///< N: the sum of the forces at which these give way
    double pressed = 0;       ///< N, by all samples that friction may hold
    double kept_pressed = 0;  ///< N: the same of what was kept
    double clear = 0;         ///< m: no sample touched before it had moved this far from there
    double spare = 0;         ///< m: the same of this look, as far as it is known
    double since = 0;      ///< m: upper bound of how far the cluster in hand has moved from there
    double since_all = 0;  ///< m: the same of all of the tool
    QueryCursor cursor;
    LevelSum level_sum, sum_before;  ///< of the level in hand, and of the one above it
    Settling settling;
    std::int32_t slot = -1;    ///< of `finest_until_`; below 0: none
    std::uint32_t absent = 0;  ///< settlings since it was present
    std::uint32_t level = 0;   ///< to which the last first look of a tick resolved it
    bool presses = false;      ///< the tool, in what was kept
    bool asleep = false;       ///< the last look at all samples left it out
    bool listed = false;       ///< samples of it that are near are listed
    bool looked = false;       ///< in this look all of its samples are looked at
    bool mirrored = false;     ///< `to_world` mirrors
    bool settles = false;      ///< its levels are refined as far as that changes the sum
    bool placed = false;
    bool present = false;  ///< in this tick
    bool in_grip = false;  ///< `settled` is known

    /// What the way of a sample, `way` so far, will be at the least before it has gone `more` from
    /// here; m, rounded down.
    [[nodiscard]] float after(double way, double more) const noexcept {
      constexpr double rounded_down = 1 - 0x1p-22, longest = 1;
      return static_cast<float>((way - 2 * since + std::min(more, longest)) * rounded_down);
    }
  };
  /// A finest sample that friction may hold.
  struct Touch {
    std::uint32_t sample = 0, object = 0;
    std::array<float, 3> normal{};  ///< object's frame
    float force = 0, spring = 0;    ///< N, N/m
    std::uint32_t patch = 0;        ///< its number
  };

  const SurfaceSamples& tool_;
  ObjectContactSettings settings_;
  std::uint32_t coarse_ = 0;     ///< number of samples above the finest
  std::uint32_t clustered_ = 0;  ///< samples below this number are clusters of their own
  std::uint32_t summed_level_ =
      0;                        ///< the finest of the clusters: the sums of levels count from it
  std::uint32_t by_plane_ = 0;  ///< from this sample on, above the finest, planes part patches
  std::vector<Pair> pairs_;
  ContactGrip grip_;
  /// Of each pair and cluster, m: upper bound of the way of any of its samples relative to the
  /// object, from one look at all samples to the next; and how far those that were not listed were
  /// from touching.
  std::vector<double> ways_;
  std::vector<float> spares_;
  /// One value per pair and sample above the finest: the sample need not be examined before its
  /// cluster's way is this long. Above 0: nothing below it in the tree can touch. Below 0: what it
  /// would tell changes nothing.
  std::vector<float> until_;
  /// The same for the finest samples, of the pairs that have a slot: those that were near last.
  std::vector<float> finest_until_;
  std::vector<std::int32_t> slots_;  ///< the pair of each; below 0: free
  std::vector<Active> active_, next_;
  ClusterSums clusters_;    ///< of the level in hand
  std::vector<Near> near_;  ///< in the order of the look that listed them
  std::vector<NearContact> contacts_, kept_contacts_, room_;
  double near_reach_ = 0;  ///< m: of this look; nearer samples are in `contacts_`
  bool near_known_ = false, kept_near_known_ = false;
  bool as_points_ = false;   ///< as TickBudget says
  double ahead_ = 0;         ///< m: of this look; what is nearer is listed
  double listed_ahead_ = 0;  ///< m: of the looks that listed
  std::vector<PressedPatch> patches_, kept_;
  /// Where in `patches_` that of a pair and cluster stands, if it stands there.
  std::vector<std::uint8_t> patch_at_;
  std::vector<Touch> touches_, kept_touches_;
  std::size_t left_ = 0;  ///< active samples from here on count, and all of `next_`
  double press_time_ =
      WorkClock::least_press_time;  ///< ns per sample, measured in the ticks before

  /// Whether the sum of its level counts.
  [[nodiscard]] bool is_summed(std::uint32_t sample) const noexcept {
    return sample >= tool_.levels[summed_level_].first;
  }
  [[nodiscard]] bool is_finest(std::uint32_t sample) const noexcept { return sample >= coarse_; }
  [[nodiscard]] bool is_by_plane(std::uint32_t sample) const noexcept {
    return sample >= by_plane_ && !is_finest(sample);
  }
  void set_out(const ContactObject& object, Pair& pair, const Eigen::Isometry3d& tool) noexcept;
  [[nodiscard]] std::size_t first_way(const Pair& pair) const noexcept {
    return static_cast<std::size_t>(&pair - pairs_.data()) * clustered_;
  }
  [[nodiscard]] double way_of(const Pair& pair, std::uint32_t cluster) const noexcept {
    return ways_[first_way(pair) + cluster] + pair.since;
  }
  /// Tells how far a sample is from touching, m; one that is not listed.
  double spare_of(Pair& pair, std::uint32_t cluster, double spare) noexcept {
    float& least = spares_[first_way(pair) + cluster];
    least = std::min(least, static_cast<float>(spare));
    pair.spare = std::min(pair.spare, spare);
    return spare;
  }
  [[nodiscard]] double left_of_list(const Pair& pair, double most) const noexcept;
  [[nodiscard]] bool look_at_all(Pair& pair) noexcept;
  [[nodiscard]] double extent(std::uint32_t sample, double along) const noexcept;
  [[nodiscard]] double extent(std::uint32_t sample, double along, double across) const noexcept;
  [[nodiscard]] double parted_by(const Pair& pair, const SupportPlane& plane,
                                 double enough) const noexcept;
  [[nodiscard]] double parted(const Pair& pair) const noexcept;
  void begin_travel(Pair& pair) noexcept;
  void begin_slot(const Pair& pair) noexcept;
  [[nodiscard]] float* finest_until(std::uint32_t object) noexcept;
  /// Where a sample is, object's frame, in metres of the world.
  [[nodiscard]] Vector3 place_of(const Pair& pair, std::uint32_t sample) const noexcept {
    return turned(pair.pose.linear(), tool_.places[sample].position) + pair.pose.translation();
  }
  [[nodiscard]] double from_above(std::uint32_t sample, std::uint32_t above) const noexcept;
  [[nodiscard]] double ask(Pair& pair, const Vector3& place, Vector3& normal,
                           ObjectContactReport& report) noexcept;
  double look(std::uint32_t sample, std::uint32_t object, const Active& above,
              std::vector<Active>& found, ObjectContactReport& report) noexcept;
  double touch(std::uint32_t sample, std::uint32_t object, const Active& above,
               ObjectContactReport& report) noexcept;
  void note_clear(const Active& above, double spare) noexcept;
  void take_plane(const Pair& pair, double way, const Vector3& place, double distance,
                  const Vector3& normal, Near& near) const noexcept;
  void note(const Pair& pair, std::uint32_t sample, const Vector3& place, double distance,
            const Vector3& normal) noexcept;
  void press_by(std::uint32_t sample, std::uint32_t object, std::uint32_t cluster,
                const Vector3& place, double distance, const Vector3& normal) noexcept;
  void choose_looks(const TickBudget& budget) noexcept;
  void drop_lists() noexcept;
  void end_list(Pair& pair, std::size_t first, bool resolved) noexcept;
  void look_near(WorkClock* clock, ObjectContactReport& report) noexcept;
  void look_to_finest(std::size_t count, const TickBudget& budget, WorkClock& clock,
                      ObjectContactReport& report) noexcept;
  [[nodiscard]] double reach_of(std::uint32_t sample) const noexcept;
  [[nodiscard]] bool can_settle(const TickBudget& budget) const noexcept;
  void weigh(Active& active, Pair& pair) noexcept;
  void press(const Active& active, float weight) noexcept;
  void press_part(const Active& active, double spring, const CoarsePress& press,
                  const Vector3& normal, const Vector3& lever) noexcept;
  /// A finest sample, or a part of one; tool's axes, about the tool's origin.
  struct Square {
    Vector3 middle = Vector3::Zero();
    Vector3 first = Vector3::Zero(), second = Vector3::Zero();  ///< unit, along its sides
    double side = 0;                                            ///< m
    double distance = 0;  ///< m, signed, of the object's surface from its middle
    Vector3 normal = Vector3::Zero();
  };
  void press_finest_square(const Active& active, ObjectContactReport& report) noexcept;
  void press_square(const Active& active, const Square& square, double weight) noexcept;
  void divide(const Active& active, const Square& square, double weight,
              std::span<const double> divided, ObjectContactReport& report) noexcept;
  [[nodiscard]] QueriedDistance query_at(Pair& pair, const Arm& at, Vector3& place,
                                         ObjectContactReport& report) noexcept;
  [[nodiscard]] bool needs_normal(const Active& active) const noexcept;
  [[nodiscard]] double above_plane(const Active& active) const noexcept;
  [[nodiscard]] double meet(Active& active, Pair& pair, double way, float* until,
                            ObjectContactReport& report) noexcept;
  void ask_of(Active& active, Pair& pair, ObjectContactReport& report) noexcept;
  [[nodiscard]] double look_at(Active& active, Pair& pair, double way, float* until,
                               const Active& above, ObjectContactReport& report) noexcept;
  double look_over(std::uint32_t first, std::uint32_t count, const Active& above,
                   ObjectContactReport& report) noexcept;
  [[nodiscard]] static std::uint32_t key_of(const Active& active) noexcept {
    return std::uint32_t{active.object} << 16U | active.cluster;
  }
  [[nodiscard]] Settling settling_of(const Pair& pair, std::uint32_t level,
                                     double accuracy) const noexcept;
  [[nodiscard]] static float left_to_refine(const Settling& settling, const ClusterChange* change,
                                            double accuracy) noexcept;
  [[nodiscard]] bool settle_level(std::uint32_t level, double accuracy) noexcept;
  void look_by_levels(const TickBudget& budget, WorkClock& clock,
                      ObjectContactReport& report) noexcept;
  void press_coarse(Active& active, ObjectContactReport& report) noexcept;
  void press_finest(std::uint32_t sample, std::uint32_t object, std::uint32_t cluster,
                    const Vector3& place, double distance, const Vector3& normal) noexcept;
  void hold(std::uint32_t sample, std::uint32_t object, const Vector3& normal, double force,
            double spring, PressedPatch& patch) noexcept;
  void pull_by(const Touch& touch, const Eigen::Isometry3d& pose, PressedPatch& patch) noexcept;
  /// The patch that a sample belongs to. Samples come mostly cluster by cluster.
  [[nodiscard]] PressedPatch& patch_of(std::uint32_t object, std::uint32_t cluster) noexcept {
    const bool goes_on =
        !patches_.empty() && patches_.back().object == object && patches_.back().cluster == cluster;
    return goes_on ? patches_.back() : other_patch_of(object, cluster);
  }
  [[nodiscard]] PressedPatch& other_patch_of(std::uint32_t object, std::uint32_t cluster) noexcept;
  void start_over() noexcept;
  void start_over(Pair& pair, std::size_t patches, std::size_t touches) noexcept;
  void sum_up(ContactSum& all) noexcept;
  void add_up(Pair& pair, const ContactSum& springs, ContactSum& all) const noexcept;
  void tell(PressedPatch& patch) const noexcept;
  bool refine(std::uint32_t level, const TickBudget& budget, WorkClock& clock, std::size_t waiting,
              ObjectContactReport& report) noexcept;
  void look_at_object(std::uint32_t object, const TickBudget& budget, WorkClock& clock,
                      std::size_t waiting, ObjectContactReport& report) noexcept;
  void press_coarser(Pair& pair, WorkClock& clock, ObjectContactReport& report) noexcept;
};

}  // namespace spm
