// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "servo/app/app_state.hpp"

namespace spm::test {

/// What an application sends, again and again.
enum class StreamKind : std::uint8_t {
  same_far,      ///< a material, unchanged, of an object that nobody touches
  same_touched,  ///< the same, of the object that is touched
  material,      ///< other stiffness, friction and damping of that object
  texture,       ///< another texture of it
  added_far,     ///< an object, half a metre away, is added and removed
  added_here,    ///< an object in the place of the one that is touched
  method,        ///< the method of the object that is touched
  stabilizers,   ///< on and off
  cap,           ///< of the force
  same_cap,      ///< one that is never met
  spring,        ///< whose point moves
  detents,       ///< whose stiffness changes
  push,          ///< a force on the hand
  clutch,        ///< taken and let go
  placed,        ///< the object that is touched is put elsewhere, and back
};
inline constexpr std::uint8_t stream_kinds = 15;
[[nodiscard]] std::string name_of(StreamKind kind);

/// One stream of commands of an application, and a hand that presses and slides on a box of 40 mm.
struct CommandStream {
  StreamKind kind = StreamKind::same_far;
  double rate_hz = 60;
  std::uint64_t seed = 0;  ///< of the hand's way, and of what is sent
  bool stabilized = true;  ///< as `run` has it by default; else the bare method
  bool still = false;      ///< the hand keeps one place inside the box
  double seconds = 1.5;
};

/// What the hand got.
struct StreamOutcome {
  double energy = 0;  ///< J, net, of the forces that were sent along the hand's way
  /// J, the most that changes of the potential give at the places where the hand was within half a
  /// second of them
  double allowed = 0;
  double largest_step = 0;   ///< N, between two ticks
  double largest_force = 0;  ///< N
};

/// Runs the servo's own loop on a scripted hand, tick by tick, without waiting for the clock.
[[nodiscard]] StreamOutcome run_stream(const CommandStream& stream);

/// The stream of a number: its kind, rate (15 to 1000 Hz) and the rest by chance.
[[nodiscard]] CommandStream stream_of(std::uint64_t number);

}  // namespace spm::test
