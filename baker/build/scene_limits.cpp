// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/build/scene_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "baker/base/bake_error.hpp"
#include "common/base/units.hpp"
#include "formats/scene/scene.hpp"

namespace spm::baker {

namespace {

/// A float is rounded by up to 2^-24 of itself. At most places the largest coordinate is rounded by
/// no less than a quarter of that.
constexpr double float_share = 0x1p-26;

std::string length(double metres) { return format_quantity(metres, Quantity::length); }
std::string force(double newtons) { return format_quantity(newtons, Quantity::force); }

[[noreturn]] void refuse(ExitCode code, const std::string& message) {
  throw BakeError(code, message);
}

bool is_file(const std::string& named, const std::string& mesh) {
  std::error_code ignored;
  return !named.empty() && std::filesystem::equivalent(named, mesh, ignored);
}

/// The object of a scene that is made from a mesh file.
const SceneObject& object_of(const Scene& scene, const std::string& mesh) {
  std::vector<const SceneObject*> found;
  for (const SceneObject& object : scene.objects) {
    if (is_file(object.mesh, mesh)) found.push_back(&object);
  }
  if (found.size() == 1) return *found.front();
  if (found.size() > 1) {
    refuse(ExitCode::invalid_input,
           fmt::format("{}: lines {} and {}: {} is the mesh of both objects; give a scene in which "
                       "it lies once",
                       scene.path, found[0]->line, found[1]->line, mesh));
  }
  if (scene.objects.size() == 1) return scene.objects.front();
  refuse(ExitCode::invalid_input,
         fmt::format("{}: none of its {} objects has {} for its 'mesh'; name it in one of them",
                     scene.path, scene.objects.size(), mesh));
}

/// The device's workspace in the frame of an object's asset.
OrientedBox workspace_of(const DeviceProfile& profile, const Placement& workspace,
                         const Placement& object) {
  OrientedBox box;
  const Eigen::Quaterniond turn_back = object.rotation.conjugate();
  box.middle = turn_back * (workspace.position - object.position) / object.scale;
  box.axes = (turn_back * workspace.rotation).toRotationMatrix();
  const auto& edges = profile.workspace;
  box.half = Vector3(edges[0], edges[1], edges[2]) / 2 * (workspace.scale / object.scale);
  return box;
}

std::string edges_of(const OrientedBox& box) {
  return fmt::format("{} x {} x {}", length(2 * box.half.x()), length(2 * box.half.y()),
                     length(2 * box.half.z()));
}

/// How lengths of the world are scaled in the asset, in words; empty where they are the same.
std::string scaled(double scale) {
  return scale == 1 ? std::string() : fmt::format(", at a scale of 1 to {:.6g}", scale);
}

/// The scene's tool that is made of a mesh of which no object is; the largest, which asks for the
/// finest tolerance. Null where there is none.
const SceneTool* tool_alone(const Scene& scene, const std::string& mesh) {
  for (const SceneObject& object : scene.objects) {
    if (is_file(object.mesh, mesh)) return nullptr;
  }
  const SceneTool* found = nullptr;
  const auto take = [&](const SceneTool& tool) {
    if (!is_file(tool.mesh, mesh)) return;
    if (found == nullptr || tool.placement.scale > found->placement.scale) found = &tool;
  };
  if (scene.tool) take(*scene.tool);
  for (const SceneTool& tool : scene.more_tools) take(tool);
  return found;
}

void derive_tolerance(const DeviceProfile& profile, double scale, BakeOptions& options,
                      std::vector<std::string>& derived) {
  if (options.form != AssetForm::sparse || options.tolerance) return;
  options.tolerance = profile.encoder_step / 2 * scale;
  derived.push_back(fmt::format("tolerance {}: half of {}'s encoder step of {}{}",
                                length(*options.tolerance), profile.name,
                                length(profile.encoder_step), scaled(scale)));
}

void derive_from_scene(const Scene& scene, const SceneObject& object, const DeviceProfile* profile,
                       const LimitSources& sources, BakeOptions& options,
                       std::vector<std::string>& derived) {
  const double scale = 1 / object.placement.scale;  // lengths of the world in the asset
  double cap = scene.device.force_cap.value_or(0);
  if (profile != nullptr) {
    cap = cap > 0 ? std::min(cap, profile->force_cap) : profile->force_cap;
    if (object.stiffness > profile->stiffness_cap) {
      derived.push_back(fmt::format("stiffness {}: more than {} renders stably, {}",
                                    format_quantity(object.stiffness, Quantity::stiffness),
                                    profile->name,
                                    format_quantity(profile->stiffness_cap, Quantity::stiffness)));
    }
    options.workspace = workspace_of(*profile, scene.workspace, object.placement);
    derived.push_back(fmt::format("workspace {}: {}'s, as {} places it",
                                  edges_of(*options.workspace), profile->name, scene.path));
  }
  if (cap > 0 && !sources.max_depth_given) {
    options.max_depth = cap / object.stiffness * scale;
    derived.push_back(fmt::format(
        "max-depth {}: {} over {}{}{}", length(options.max_depth), force(cap),
        format_quantity(object.stiffness, Quantity::stiffness),
        object.stiffness_given ? "" : ", the stiffness where a scene gives none", scaled(scale)));
  }
  if (scene.probe && !sources.probe_given) {
    options.probe_radius = scene.probe->radius * scale;
    derived.push_back(fmt::format(
        "probe {}: the scene's{}",
        options.probe_radius > 0 ? "sphere of radius " + length(options.probe_radius) : "point",
        options.probe_radius > 0 ? scaled(scale) : ""));
  }
}

void check_band(const LimitSources& sources, const BakeOptions& options, const Mesh& mesh) {
  const std::string size = length(mesh.diagonal);
  // A default of 2 mm is not an error of the user.
  if (options.max_depth > mesh.diagonal && sources.max_depth_given) {
    refuse(
        ExitCode::usage,
        fmt::format("--max-depth: {} is more than the object's whole diagonal, {}; ask for less, "
                    "or give the mesh's --unit",
                    length(options.max_depth), size));
  }
  if (options.max_depth > mesh.diagonal && !sources.scene.empty()) {
    refuse(ExitCode::invalid_input,
           fmt::format("{}: its force cap over its stiffness makes a band {} deep, more than the "
                       "diagonal of {}, {}; raise 'stiffness', lower 'force_cap', or give "
                       "--max-depth or the mesh's --unit",
                       sources.scene, length(options.max_depth), mesh.path, size));
  }
  if (options.margin && *options.margin - options.probe_radius > mesh.diagonal) {
    refuse(ExitCode::usage,
           fmt::format("--margin: {} is more than the probe's radius and the object's whole "
                       "diagonal, {}; ask for less, or give the mesh's --unit",
                       length(*options.margin), size));
  }
}

void check_tolerance(const LimitSources& sources, const BakeOptions& options, const Mesh& mesh) {
  const double farthest =
      std::max(mesh.box_min.cwiseAbs().maxCoeff(), mesh.box_max.cwiseAbs().maxCoeff());
  const double least = farthest * float_share;
  if (!options.tolerance || *options.tolerance >= least) return;
  refuse(
      sources.tolerance_given ? ExitCode::usage : ExitCode::invalid_input,
      fmt::format("{}: a tolerance of {:.3g} m is finer than the floats of a baked file can hold "
                  "for coordinates of {}; ask for {:.2g} m or more, give the mesh's --unit, or "
                  "add --allow-inexact",
                  mesh.path, *options.tolerance, length(farthest), least));
}

void check_workspace(const LimitSources& sources, const BakeOptions& options, const Mesh& mesh) {
  const double margin = options.margin.value_or(options.probe_radius + options.max_depth / 4);
  const OrientedBox reached = grown(*options.workspace, std::max(margin, options.max_depth));
  const auto in_reach = [&](const Triangle& t) {
    return touches_triangle(reached, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  };
  if (std::any_of(mesh.triangles.begin(), mesh.triangles.end(), in_reach)) return;
  const Vector3& at = options.workspace->middle;
  const Vector3 middle = (mesh.box_min + mesh.box_max) / 2;
  refuse(ExitCode::invalid_input,
         fmt::format("{}: nothing of {} is in the device's workspace, {} about ({:.4g}, {:.4g}, "
                     "{:.4g}) m of the mesh, whose own middle is ({:.4g}, {:.4g}, {:.4g}) m; mend "
                     "'pose' or 'scale' in [workspace] or in the object",
                     sources.scene, mesh.path, edges_of(*options.workspace), at.x(), at.y(), at.z(),
                     middle.x(), middle.y(), middle.z()));
}

}  // namespace

std::vector<std::string> derive_limits(const LimitSources& sources, const std::string& mesh,
                                       BakeOptions& options, OpenAs& open) {
  std::vector<std::string> derived;
  const DeviceProfile* profile = find_device_profile(sources.device);
  double step_scale = 1;
  if (!sources.scene.empty()) {
    const Result<Scene> scene = read_scene(sources.scene);
    if (!scene) refuse(scene.error().code, scene.error().message);
    if (profile == nullptr) profile = scene->device.profile;
    // The hand's motion grows with the workspace, and shrinks on an object that was enlarged.
    if (const SceneTool* tool = tool_alone(*scene, mesh)) {
      // All of a tool's surface may touch, wherever the hand is.
      step_scale = scene->workspace.scale / tool->placement.scale;
      derived.push_back(
          fmt::format("the tool of {}: baked whole, with the default band", scene->path));
    } else {
      const SceneObject& object = object_of(*scene, mesh);
      step_scale = scene->workspace.scale / object.placement.scale;
      derive_from_scene(*scene, object, profile, sources, options, derived);
      if (object.open && !sources.open_given) {
        open = *object.open;
        derived.push_back(fmt::format("open {}: the object's in {}",
                                      open_as_words[static_cast<std::size_t>(open)], scene->path));
      }
    }
  }
  if (profile != nullptr) derive_tolerance(*profile, step_scale, options, derived);
  return derived;
}

void check_limits(const LimitSources& sources, const BakeOptions& options, const Mesh& mesh,
                  bool inexact) {
  check_band(sources, options, mesh);
  if (!inexact) check_tolerance(sources, options, mesh);
  if (options.workspace) check_workspace(sources, options, mesh);
}

}  // namespace spm::baker
