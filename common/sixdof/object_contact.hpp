// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "common/sixdof/contact_sum.hpp"
#include "common/sixdof/field_memory.hpp"
#include "common/sixdof/surface_samples.hpp"

namespace spm {

/// An object that the tool may touch: its baked field, and the pose that takes its frame to the
/// world's.
struct ContactObject {
  const AssetView* field = nullptr;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

/// How much a tick may do.
struct TickBudget {
  std::int64_t nanoseconds = 0;  ///< 0: no limit
  /// ns of a clock that never goes back; null: that of std::chrono::steady_clock.
  std::int64_t (*now)() noexcept = nullptr;
  std::uint32_t finest_level = std::numeric_limits<std::uint32_t>::max();  ///< none below it
};

struct ObjectContactSettings {
  double stiffness = 1e9;     ///< N/m3: N/m for a square metre of contact
  std::uint32_t objects = 1;  ///< at most so many
  std::uint32_t most_active =
      65536;  ///< samples that may touch at once; beyond it coarser ones stand
  /// m: how far from where the field was asked its tangent plane may at most stand for it, for a
  /// sample that moved or one below it; less where the field turns out to be curved. 0: never.
  double most_reach = 5e-4;
  std::uint32_t remembered =
      65536;  ///< samples an object whose last answer is kept, a power of two
};

/// What a tick found.
struct ObjectContactReport {
  ContactSum sum;           ///< on the tool, world frame, torques about the tool's origin
  std::uint32_t level = 0;  ///< of SurfaceSamples: all contact was resolved to it
  double refined = 0;       ///< share of its contact that was resolved to the next level, below 1
  /// m: no sample touches before tool and objects have moved so far against each other; 0 in
  /// contact
  double clear = std::numeric_limits<double>::infinity();
  std::uint64_t asked = 0;   ///< queries of a field
  std::uint64_t tested = 0;  ///< samples whose distance was asked for
  bool degraded = false;     ///< time or room ran out before the finest level
};

/// Contact of a tool's sampled surface with the fields of other objects: each sample of area a that
/// lies d deep pushes with the stiffness times a d along the field's normal, the gradient of the
/// potential 1/2 k a d^2. Samples stand in a tree of spheres: a node that the field shows to be
/// clear is passed over with all below it, until the objects could have moved so far that it is
/// not. Levels are taken coarse first, so that an answer is there when time runs out. A coarse
/// sample stands for a patch, whose part below the surface counts. Deeper than the field's band the
/// depth stays its end.
///
/// Built at load time (allocates); `tick` neither allocates nor throws, and reads the clock every
/// few samples. One thread at a time.
class ObjectContact {
 public:
  /// `tool` must outlive this.
  ObjectContact(const SurfaceSamples& tool, const ObjectContactSettings& settings);

  /// `tool_pose` takes the tool's frame to the world's. `objects` in the same order every tick, all
  /// `sparse`; those beyond the settings' number are left out. A pose may mirror; one that scales
  /// (of a quaternion that is not unit, say), shears or is not finite gives no contact.
  [[nodiscard]] ObjectContactReport tick(const Eigen::Isometry3d& tool_pose,
                                         std::span<const ContactObject> objects,
                                         const TickBudget& budget = {}) noexcept;

  /// To be called when an object's field was replaced by another.
  void forget(std::uint32_t object) noexcept;

 private:
  /// A sample that may touch.
  struct Active {
    std::uint32_t sample = 0;
    std::uint32_t object = 0;
    double distance = 0;   ///< signed, m; means nothing where the reading is not known
    FieldReading reading;  ///< that the distance is from: of the sample, or of one above it
  };
  struct Pair {
    const AssetView* field = nullptr;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< tool's frame to the object's
    Eigen::Matrix3d to_world = Eigen::Matrix3d::Identity();
    double travelled = 0;  ///< m: no place of the tool has moved farther against the object
    bool placed = false;
  };
  class Clock;

  const SurfaceSamples& tool_;
  ObjectContactSettings settings_;
  std::vector<Pair> pairs_;
  std::vector<FieldMemory> memories_;  ///< one an object
  /// A word a pair and sample: until the pair has travelled so far the sample needs no look. Above
  /// 0: nothing below it can touch; below 0: it cannot touch, what is below it can.
  std::vector<double> until_;
  std::vector<Active> active_, next_;
  std::size_t left_ = 0;     ///< of the active samples those from here on count, and the next
  double press_time_ = 100;  ///< ns a sample, from the ticks before

  void move(Pair& pair, const ContactObject& object, const Eigen::Isometry3d& tool) noexcept;
  void look(std::uint32_t sample, std::uint32_t object, const FieldReading& above,
            std::vector<Active>& found, ObjectContactReport& report) noexcept;
  [[nodiscard]] FieldReading read(std::uint32_t object, std::uint32_t sample, const Vector3& place,
                                  ObjectContactReport& report) noexcept;
  void press(const Active& active, ContactSum& sum) const noexcept;
  bool refine(std::uint32_t level, Clock& clock, ObjectContactReport& report) noexcept;
};

}  // namespace spm
