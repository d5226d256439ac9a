// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/base/device_profile.hpp"
#include "common/base/error.hpp"
#include "common/base/placement.hpp"
#include "common/contact/effect_settings.hpp"
#include "common/contact/force_law.hpp"
#include "common/contact/stabilization_settings.hpp"
#include "formats/files/open_as.hpp"

namespace spm {

/// The device that a scene is made for.
struct SceneDevice {
  std::string driver;                      ///< as `spm-servo run --device` takes it; may be empty
  const DeviceProfile* profile = nullptr;  ///< null where the scene names none
  std::optional<double> force_cap;         ///< N, above 0, at most the profile's
  int driver_line = 0;                     ///< of `driver` in the file
};

/// A tool that is an object of its own, which the hand holds and turns.
struct SceneTool {
  std::string asset;    ///< baked file, made relative to the scene's folder; may be empty
  std::string mesh;     ///< the mesh it is baked from, likewise; one of the two is given
  Placement placement;  ///< of the asset's frame in the frame of the device's tool
  std::optional<double> coupling;    ///< N/m of the hand; empty: chosen for the device
  std::optional<double> turning;     ///< N m/rad, likewise
  std::optional<double> torque_cap;  ///< N m
  double spacing = 0;                ///< m of the world, between samples; 0: chosen
  std::size_t samples = 0;           ///< at most; 0: no limit of its own
  double budget = 0;                 ///< s of a tick; 0: no limit of its own
  int line = 0;                      ///< of its `asset`, or its `mesh`, in the file
};

/// One object of a scene.
struct SceneObject {
  std::string asset;    ///< baked file, made relative to the scene's folder; may be empty
  std::string mesh;     ///< the mesh it is baked from, likewise; one of the two is given
  Placement placement;  ///< of the asset's frame
  /// N/m, of the contact; where it is not given, what suits the scene's device, or the default
  double stiffness = default_stiffness;
  bool stiffness_given = false;
  bool stiffness_chosen = false;  ///< chosen for the device: the scene says "auto"
  std::optional<Method> method;   ///< empty: the default
  PaperRule rule = PaperRule::closest_plane;
  double density = 1;          ///< d of eq. 12, of method paper against a tool that is an object
  EffectSettings effects;      ///< lengths, forces and damping in the world's units
  bool movable = false;        ///< an application may move it
  std::optional<OpenAs> open;  ///< what a bake takes open parts of the mesh for
  int line = 0;                ///< of its `[[object]]` in the file

  static constexpr double default_stiffness = 1000;
};

/// A scene: the objects, the probe or the tool, and the device and its workspace.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): what belongs together stands together.
struct Scene {
  std::string path;
  SceneDevice device;
  std::optional<ProbeShape> probe;
  std::optional<PaperProbeForm> probe_form;  ///< for objects of method `paper`
  std::optional<SceneTool> tool;             ///< in place of a probe
  /// Of the second device and the next, where each has a tool of its own; empty: all have that one.
  std::vector<SceneTool> more_tools;
  Placement workspace;  ///< of the device's frame, whose origin is its tool's centre
  StabilizationSettings stabilization;
  std::vector<SceneObject> objects;  ///< at least one
  bool stabilization_given = false;
  bool delay_given = false;  ///< the stabilization's delay; otherwise it is measured
};

/// Reads a scene (TOML); formats/scene/KEYS.md lists its keys. Lengths, forces and stiffnesses are
/// strings with a unit. A pose is an array of bare numbers, metres and a quaternion w first, as in
/// a trajectory. Errors: file_or_device; invalid_input with the line, the cause and the remedy, and
/// for a misspelt key the key that was probably meant.
[[nodiscard]] Result<Scene> read_scene(const std::string& path);

/// The same of a text that was read before; `path` is its file, from whose folder the files lie
/// that it names. Errors: invalid_input, as above.
[[nodiscard]] Result<Scene> parse_scene(const std::string& path, const std::string& text);

}  // namespace spm
