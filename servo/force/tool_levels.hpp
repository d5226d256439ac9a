// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace spm {

/// What a tick of a sampled tool tells of whether its time sufficed.
struct ToolEffort {
  bool looks_late = false;       ///< time ran out for contacts on finer levels
  bool steps_late = false;       ///< time ran out for steps of the virtual tool, far from balance
  std::uint32_t level = 0;       ///< to which all contact was resolved; 0: the coarsest
  std::uint32_t worked = 0;      ///< samples that were looked at
  std::uint32_t looks = 0;       ///< of the virtual tool at the contact
  std::uint32_t unresolved = 0;  ///< objects that time ran out for
};

/// How fine the samples of a tool are that the next tick may look at. It is coarser where ticks had
/// too little time, and a finer level is tried after a while; where that is in vain again and
/// again, more and more seldom. Decides by counts alone, so that a recording can be replayed.
class ToolLevels {
 public:
  static constexpr std::uint32_t every = std::numeric_limits<std::uint32_t>::max();

  /// The finest level; `every`: no limit.
  [[nodiscard]] std::uint32_t finest() const noexcept { return finest_; }
  /// Takes up a tick of a tool whose finest level is `last`.
  void note(const ToolEffort& effort, std::uint32_t last) noexcept;

 private:
  /// Ticks after one without enough time in which another makes the next coarser, and until the
  /// next finer level is tried; each time in vain that is twice as long, up to the longest.
  static constexpr std::uint32_t waiting_ticks = 8, longest_wait = 1024;
  /// Ticks after a finer level was allowed that do not tell whether time suffices for it.
  static constexpr std::uint32_t settling_ticks = 4;

  void use_coarser(std::uint32_t level, std::uint32_t last) noexcept;
  void try_finer(std::uint32_t last) noexcept;

  std::uint32_t finest_ = every;
  std::uint32_t unresolved_ = 0;        ///< objects that time ran out for in the last tick
  std::uint32_t alarm_ = 0;             ///< ticks until one without enough time counts as the first
  std::uint32_t patience_ = 0;          ///< ticks until a finer level is tried
  std::uint32_t wait_ = waiting_ticks;  ///< ticks from one trial to the next
  std::uint32_t settling_ = 0;          ///< ticks of these that are left
  bool tried_ = false;                  ///< the last change of the level was such a trial
};

}  // namespace spm
