// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "servo/force/scene_force.hpp"

namespace spm::stability {

/// A force law that the laboratory judges. Each tick takes the hand's reading and returns the
/// force; `object` moved by a translation (m) since the start. It remembers what it needs.
class Contestant {
 public:
  Contestant() = default;
  virtual ~Contestant() = default;
  Contestant(const Contestant&) = delete;
  Contestant& operator=(const Contestant&) = delete;

  /// Forgets all; the tool is at `start` (m), which is free.
  virtual void begin(const Vector3& start) = 0;
  /// Force on a probe centred at `measured` (m, world); `moved` is how far the object was moved.
  [[nodiscard]] virtual ContactForce next(const Vector3& measured, const Vector3& moved) = 0;
};

}  // namespace spm::stability
