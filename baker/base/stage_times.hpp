// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "baker/base/stopwatch.hpp"

namespace spm::baker {

/// What the stages of a bake take, one after the other.
class StageTimes {
 public:
  /// Ends a stage, which began when the one before ended.
  void end(const char* stage) {
    seconds_.emplace_back(stage, seconds_since(begun_));
    begun_ = Clock::now();
  }
  /// Of each stage that ended, s, in their order.
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& seconds() const {
    return seconds_;
  }

 private:
  std::vector<std::pair<std::string, double>> seconds_;
  Clock::time_point begun_ = Clock::now();
};

}  // namespace spm::baker
