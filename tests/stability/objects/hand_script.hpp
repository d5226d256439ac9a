// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "servo/devices/sim/hand_model.hpp"
#include "tests/stability/objects/stability_case.hpp"

namespace spm::stability {

/// Where a case's hand wants the tool: leg after leg, straight at each leg's speed, with that leg's
/// rest at the end. After the last leg it stays.
class HandScript {
 public:
  /// From `start` (m) along the legs, all of them moved by `offset` (m).
  HandScript(const StabilityCase& tried, const Vector3& offset);

  /// The target at a time, s, 0 or more.
  [[nodiscard]] servo::HandTarget at(double time) const noexcept;

 private:
  /// A straight motion, or a rest where it begins and ends at the same place.
  struct Segment {
    double from_time, to_time;  ///< s
    Vector3 from, to;           ///< m
  };
  std::vector<Segment> segments_;
  Vector3 end_;
};

}  // namespace spm::stability
