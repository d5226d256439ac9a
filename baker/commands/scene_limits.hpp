// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/options/bake_options.hpp"

namespace spm::baker {

/// Where the limits of a bake come from, beside its options.
struct LimitSources {
  std::string device;  ///< name of a profile of device_profile.hpp; may be empty
  std::string scene;   ///< path of a scene; may be empty
  // What the command line gives wins over what a scene says.
  bool tolerance_given = false;
  bool max_depth_given = false;
  bool probe_given = false;
};

/// Fills in what the options leave to a device and a scene, in the frame of the asset of `mesh`:
/// tolerance, half the device's encoder step (`sparse` only); and from a scene the band's depth,
/// force cap over stiffness, the probe, and the device's workspace. `--device` wins over the
/// scene's profile. Returns what came from what, a sentence each. Throws BakeError: what read_scene
/// says; invalid_input where the scene does not tell which of its objects the mesh is.
[[nodiscard]] std::vector<std::string> derive_limits(const LimitSources& sources,
                                                     const std::string& mesh, BakeOptions& options);

/// Refuses limits that suit no bake of this mesh: a band wider than the object, a tolerance that
/// floats cannot hold (unless `inexact` is allowed), a workspace with nothing of the object in it.
/// Throws BakeError, usage for what the command line gave, invalid_input for what a scene did.
void check_limits(const LimitSources& sources, const BakeOptions& options, const Mesh& mesh,
                  bool inexact);

}  // namespace spm::baker
