// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/hand_pose.hpp"
#include "common/base/wrench.hpp"

namespace spm::servo {

/// One tick of one device, as viewers are told it: world frame, SI units.
struct HandSample {
  std::uint64_t tick = 0, time_ns = 0;
  HandPose hand;
  std::optional<HandPose> tool;    ///< that the hand holds
  Vector3 held = Vector3::Zero();  ///< m, where the surface holds the hand
  Wrench sent;                     ///< on the hand
  double depth = 0;                ///< m
  bool contact = false;
  std::string cause = "none", cure;        ///< why there was no force, and what to do
  std::optional<double> wake_us, busy_us;  ///< of the loop in this tick, where it is known
};

/// What a channel's messages are about.
enum class Stream : std::uint8_t { hand, held, tool, tick, force, log };

/// A channel in the words of MCAP and of the Foxglove protocol. Messages are JSON.
struct FoxgloveChannel {
  std::uint32_t id = 0;  ///< above 0
  Stream stream = Stream::hand;
  std::size_t device = 0;
  std::string topic;        ///< such as /hand/0/pose
  std::string schema_name;  ///< one of Foxglove's own, or spm.Tick
  std::string schema;       ///< JSON Schema

  [[nodiscard]] bool operator==(const FoxgloveChannel&) const = default;
};

/// The channels of some devices; `has_tool` says of each whether its hand holds a tool. Their ids
/// count from 1.
[[nodiscard]] std::vector<FoxgloveChannel> channels_of(const std::vector<bool>& has_tool);

/// The message of a channel about a tick. Empty where the tick has nothing for it: a channel of a
/// tool that is not held, or the log, which log_message() writes.
[[nodiscard]] std::string message_of(const FoxgloveChannel& channel, const HandSample& sample);

/// What the log says of a tick after one with the cause `before`; empty where nothing changed.
[[nodiscard]] std::string log_message(const HandSample& sample, const std::string& before);

}  // namespace spm::servo
