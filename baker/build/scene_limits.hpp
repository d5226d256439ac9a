// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/options/bake_options.hpp"

namespace spm::baker {

/// Where the limits of a bake come from, besides its options.
struct LimitSources {
  std::string device;  ///< name of a profile of device_profile.hpp; may be empty
  std::string scene;   ///< path of a scene; may be empty
  // What the command line gives wins over what a scene says.
  bool tolerance_given = false;
  bool max_depth_given = false;
  bool probe_given = false;
  bool open_given = false;
};

/// Fills in the limits that the options leave open, from a device and a scene, in the frame of the
/// asset of `mesh`. The tolerance is half the device's encoder step (`sparse` only). A scene also
/// gives the band's depth (force cap over stiffness), the probe, the device's workspace, and what
/// open parts are taken for.
/// `--device` wins over the scene's profile. Returns one sentence for each limit, which says where
/// it comes from. Throws BakeError: the errors of read_scene; invalid_input where the scene does
/// not say which of its objects the mesh is.
[[nodiscard]] std::vector<std::string> derive_limits(const LimitSources& sources,
                                                     const std::string& mesh, BakeOptions& options,
                                                     OpenAs& open);

/// Refuses limits that suit no bake of this mesh: a band wider than the object, a tolerance that
/// floats cannot hold (unless `inexact` is allowed), or a workspace that contains no part of the
/// object. Throws BakeError: usage where the command line gave the limit, invalid_input where a
/// scene did.
void check_limits(const LimitSources& sources, const BakeOptions& options, const Mesh& mesh,
                  bool inexact);

}  // namespace spm::baker
