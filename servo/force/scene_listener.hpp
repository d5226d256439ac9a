// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "common/base/placement.hpp"
#include "servo/force/placed_contact.hpp"

namespace spm {

/// Learns each change of a SceneForce's objects, in order. Called in a tick: no call may allocate,
/// lock or throw.
class SceneListener {
 public:
  SceneListener() = default;
  SceneListener(const SceneListener&) = default;
  SceneListener& operator=(const SceneListener&) = default;
  virtual ~SceneListener() = default;

  /// m and a unit quaternion; may be where it was.
  virtual void placed(std::size_t object, const Vector3& position,
                      const Eigen::Quaterniond& rotation) noexcept = 0;
  virtual void added(std::size_t object, const PlacedObject& settings) noexcept = 0;
  virtual void changed(std::size_t object, const PlacedObject& settings) noexcept = 0;
  virtual void removed(std::size_t object) noexcept = 0;
  virtual void stabilized(const StabilizationSettings& stabilization) noexcept = 0;
};

}  // namespace spm
