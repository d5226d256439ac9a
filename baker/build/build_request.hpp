// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "baker/build/scene_limits.hpp"
#include "baker/mesh/load.hpp"
#include "baker/mesh/mesh.hpp"
#include "baker/pipeline/bake.hpp"

namespace spm::baker {

/// The options of one `build`.
struct BuildRequest {
  std::string mesh;
  std::string output;
  BakeOptions bake;
  LoadOptions load;
  LimitSources limits;
  bool allow_inexact = false;
  FailOn fail_on{};
  std::uint64_t time_limit = 3600;  ///< s
};

/// Adds --fail-on.
void add_fail_on(CLI::App& command, FailOn& fail_on);

/// Adds MESH, -o and the options of a bake to a command, with their checks. Values out of range and
/// options that contradict each other are usage errors. The entries of a manifest go through the
/// same table. `request` must outlive the command.
void add_build_options(CLI::App& command, BuildRequest& request);

}  // namespace spm::baker
