// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "servo/loop/supervisor.hpp"
#include "servo/realtime/realtime.hpp"
#include "servo/record/black_box_memory.hpp"

namespace spm::servo {

/// How this program starts its supervisor again: as a program of its own, this one, with a first
/// argument that no user gives. `memory` may be null, and else outlives what is returned; `path`:
/// of the black box, as write_black_box takes it.
[[nodiscard]] Supervisor::StartAgain start_as_program(RealtimeMode realtime,
                                                      const BlackBoxMemory* memory,
                                                      const std::string& path);

/// What the supervisor does with the black box after the daemon was killed: the ticks before that
/// become a file. Returns a sentence for a person; empty if there were no ticks.
[[nodiscard]] Supervisor::Afterwards keep_black_box(const BlackBoxMemory* memory,
                                                    const std::string& path);

/// If the arguments of the program say that it is the supervisor: is it, and returns its exit code.
[[nodiscard]] std::optional<int> be_supervisor_program(std::span<char* const> arguments);

}  // namespace spm::servo
