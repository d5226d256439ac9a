// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "formats/asset/asset.hpp"
#include "formats/scene/scene.hpp"
#include "servo/force/default_settings.hpp"
#include "servo/force/scene_force.hpp"

namespace spm::servo {

[[nodiscard]] const char* to_string(Method method) noexcept;
[[nodiscard]] const char* to_string(PaperRule rule) noexcept;
[[nodiscard]] const char* to_string(PaperProbeForm form) noexcept;
[[nodiscard]] const char* to_string(AssetForm form) noexcept;

/// What a command line says of forces. What it leaves out comes from the scene, or is the default.
/// What it gives holds for every object.
struct ForceOptions {
  std::string asset;  ///< a baked file; empty if a scene is given
  std::string scene;  ///< a scene; empty if an asset is given
  std::optional<Method> method;
  std::optional<PaperRule> rule;
  std::optional<double> stiffness;  ///< N/m
  bool stiffness_chosen = false;    ///< what suits the device, whatever the scene says
  std::optional<ProbeShape> probe;
  std::optional<PaperProbeForm> probe_form;
  /// Replace those of the scene, but delay and device stay the scene's.
  std::optional<StabilizationSettings> stabilization;
  /// The device that is served. Empty: there is none, as in a replay of positions; then the scene's
  /// profile counts.
  std::optional<ForceDevice> device;
};

/// What forces come from.
struct ForceChoice {
  std::string scene_path;  ///< empty if an asset was given
  ForceScene scene;
  std::vector<std::string> assets;  ///< the objects' baked files and the tool's, each once
  /// of the objects, for messages: file and line; empty if an asset was given
  std::vector<std::string> places;
  std::string tool_place;                     ///< of the tool, likewise
  std::vector<std::string> more_tool_places;  ///< of the other hands' tools
  std::vector<std::string> unfelt;            ///< sentences: what a tool feels objects without
  ProbeShape probe;                           ///< in lengths of the world
  SceneDevice device;                         ///< what the scene says of the device

  [[nodiscard]] PaperProbeForm probe_form() const { return scene.objects.front().force.form; }
};

/// Decides what forces come from: reads the scene, or makes one of the asset alone. Errors: usage,
/// for the command line; those of read_scene; invalid_input, for an object without a baked file or
/// with settings that no asset could serve.
[[nodiscard]] Result<ForceChoice> choose_forces(const ForceOptions& options);

/// File and line of the tool of a hand, as a prefix for a message about it.
[[nodiscard]] const std::string& place_of_tool(const ForceChoice& choice, std::size_t hand);

/// File and line of the first object of an asset, or of the tool, as a prefix for a message about
/// it; empty if no scene was given.
[[nodiscard]] std::string place_of_asset(const ForceChoice& choice, std::size_t which);

/// Refuses settings that no asset could serve, such as effects that their method does not have.
/// `place`: file and line of a scene; empty for a command line. Errors: usage, or invalid_input if
/// there is a place.
[[nodiscard]] Result<void> check_settings(const ForceSettings& settings,
                                          const EffectSettings& effects = {},
                                          const std::string& place = {});

/// Refuses an asset that cannot serve the settings: `paper` on a sparse asset, or a probe whose
/// radius is larger than the asset was baked for. `path` is for the message. `scale` is that of the
/// object, by which the probe is divided. Errors: invalid_input.
[[nodiscard]] Result<void> check_asset(const AssetMetadata& asset, const ForceSettings& settings,
                                       const std::string& path, double scale = 1);

/// The same for all objects of a scene that are of one of its assets, and for its tool.
[[nodiscard]] Result<void> check_asset(const AssetMetadata& asset, const ForceChoice& choice,
                                       std::size_t which);

}  // namespace spm::servo
