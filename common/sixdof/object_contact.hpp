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

/// Limits on the work of a tick.
struct TickBudget {
  std::int64_t nanoseconds = 0;  ///< 0: no limit
  /// reading of a monotonic clock, ns; null: that of std::chrono::steady_clock.
  std::int64_t (*now)() noexcept = nullptr;
  std::uint32_t finest_level =
      std::numeric_limits<std::uint32_t>::max();  ///< finer levels are not used
};

struct ObjectContactSettings {
  double stiffness = 1e9;     ///< N/m3: N/m for a square metre of contact
  std::uint32_t objects = 1;  ///< largest number of objects
  std::uint32_t max_active =
      65536;  ///< largest number of samples that may touch at once; beyond it coarser ones are used
  /// largest validity radius, m: how far from a query its tangent plane may be used instead of the
  /// field, for a sample that moved or for one below it in the tree. Less where the field turns out
  /// to be curved. 0: never.
  double max_validity_radius = 5e-4;
  std::uint32_t remembered =
      65536;  ///< samples per object whose last answer is kept, a power of two
};

/// Result of a tick.
struct ObjectContactReport {
  ContactSum sum;           ///< on the tool, world frame, torques about the tool's origin
  std::uint32_t level = 0;  ///< of SurfaceSamples: all contact was resolved to this level
  double refined = 0;       ///< part of the contact that was resolved to the next level, below 1
  /// m: no sample touches before tool and objects have moved this far relative to each other; 0 in
  /// contact
  double clearance = std::numeric_limits<double>::infinity();
  std::uint64_t asked = 0;   ///< queries of a field
  std::uint64_t tested = 0;  ///< samples whose distance was evaluated
  bool degraded = false;     ///< time or space ran out before the finest level
};

/// Contact of a tool's sampled surface with the fields of other objects. Each sample of area a at
/// depth d pushes with the stiffness times a d along the field's normal: the gradient of the
/// potential 1/2 k a d^2.
///
/// The samples form a tree of spheres. A node that the field shows to be clear is skipped with
/// everything below it, until the objects could have moved far enough to touch. Coarse levels are
/// evaluated first, so that there is an answer when time runs out. A coarse sample represents a
/// patch, and only the part of the patch below the surface counts. Below the field's band the depth
/// stays that of the band's end.
///
/// Built at load time (allocates); `tick` neither allocates nor throws, and reads the clock every
/// few samples. To be used by one thread at a time.
class ObjectContact {
 public:
  /// `tool` must outlive this.
  ObjectContact(const SurfaceSamples& tool, const ObjectContactSettings& settings);

  /// `tool_pose` takes the tool's frame to the world's. `objects` must have the same order every
  /// tick, and all must be `sparse`; objects beyond the number in the settings are ignored. A pose
  /// may mirror. A pose that scales (for example one made of a quaternion that is not of unit
  /// length), shears or is not finite gives no contact.
  [[nodiscard]] ObjectContactReport tick(const Eigen::Isometry3d& tool_pose,
                                         std::span<const ContactObject> objects,
                                         const TickBudget& budget = {}) noexcept;

  /// Must be called when an object's field was replaced by another.
  void forget(std::uint32_t object) noexcept;

 private:
  /// A sample that may touch.
  struct Active {
    std::uint32_t sample = 0;
    std::uint32_t object = 0;
    double distance = 0;   ///< signed, m; meaningless where the reading is not known
    FieldReading reading;  ///< source of the distance: a reading of the sample, or of one above it
                           ///< in the tree
  };
  struct Pair {
    const AssetView* field = nullptr;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< tool's frame to the object's
    Eigen::Matrix3d to_world = Eigen::Matrix3d::Identity();
    double travelled =
        0;  ///< m: upper bound of the motion of any place of the tool relative to the object
    bool placed = false;
  };
  class Clock;

  const SurfaceSamples& tool_;
  ObjectContactSettings settings_;
  std::vector<Pair> pairs_;
  std::vector<FieldMemory> memories_;  ///< one per object
  /// One value per pair and sample: the sample need not be examined before the pair has travelled
  /// this far. Above 0: nothing below it in the tree can touch. Below 0: it cannot touch, but
  /// samples below it can.
  std::vector<double> until_;
  std::vector<Active> active_, next_;
  std::size_t left_ = 0;     ///< active samples from here on count, and all of `next_`
  double press_time_ = 100;  ///< ns per sample, measured in the ticks before

  void move(Pair& pair, const ContactObject& object, const Eigen::Isometry3d& tool) noexcept;
  void look(std::uint32_t sample, std::uint32_t object, const FieldReading& above,
            std::vector<Active>& found, ObjectContactReport& report) noexcept;
  [[nodiscard]] FieldReading read(std::uint32_t object, std::uint32_t sample, const Vector3& place,
                                  ObjectContactReport& report) noexcept;
  void press(const Active& active, ContactSum& sum) const noexcept;
  bool refine(std::uint32_t level, Clock& clock, ObjectContactReport& report) noexcept;
};

}  // namespace spm
