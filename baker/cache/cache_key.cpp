// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cache/cache_key.hpp"

#include "baker/mesh/mesh_files.hpp"
#include "baker/pipeline/algorithm_version.hpp"
#include "formats/asset/asset.hpp"
#include "formats/files/sha256.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace

CacheKey cache_key(const BuildRequest& request, const std::string& mesh_sha256) {
  const BakeOptions& bake = request.bake;
  CacheKey key;
  Json& parts = key.parts;
  parts["algorithm_version"] = algorithm_version;
  parts["format_version"] = asset_format_version;
  parts["mesh"] = mesh_sha256;
  parts["mesh_kind"] = mesh_extension(request.mesh);
  const bool unit_of_file = !request.load.unit && names_unit(request.mesh);
  parts["unit"] = unit_of_file ? Json() : Json(request.load.unit.value_or(1));
  parts["fit_diagonal"] = or_null(request.load.fit_diagonal);
  parts["open"] = open_as_words[static_cast<std::size_t>(request.load.open_as)];
  parts["sheet_thickness"] = or_null(bake.sheet_thickness);
  parts["form"] = bake.form == AssetForm::full ? "full" : "sparse";
  parts["tolerance"] = or_null(bake.tolerance);
  parts["direction_tolerance"] = bake.direction_tolerance;
  parts["max_bytes"] = or_null(bake.max_bytes);
  parts["max_depth"] = bake.max_depth;
  // One that is as deep as the whole object is refused where somebody asked for it.
  parts["max_depth_named"] = request.limits.max_depth_given || !request.limits.scene.empty();
  parts["margin"] = or_null(bake.margin);
  parts["probe_radius"] = bake.probe_radius;
  parts["workspace"] = bake.workspace ? to_json(*bake.workspace) : Json();
  parts["kind"] = static_cast<int>(bake.kind);
  parts["planes"] = or_null(bake.planes);
  parts["resolution"] = bake.resolution;
  parts["layers"] = static_cast<int>(bake.layers);
  parts["layer_limit"] = bake.layer_limit;
  parts["smooth"] = static_cast<int>(bake.smooth.kind);
  parts["smooth_sigma"] = bake.smooth.sigma;
  parts["smooth_angle"] = bake.smooth.angle;
  parts["smooth_maps"] = static_cast<int>(bake.smooth_maps.kind);
  parts["smooth_maps_sigma"] = bake.smooth_maps.sigma;
  parts["smooth_maps_angle"] = bake.smooth_maps.angle;
  parts["seed"] = bake.seed;
  parts["allow_inexact"] = request.allow_inexact;
  parts["fail_on"] = request.fail_on;
  key.digest = sha256_bytes(parts.dump());
  return key;
}

std::string difference(const Json& before, const Json& after) {
  std::string text;
  const auto add = [&text](const std::string& change) {
    text += (text.empty() ? "" : ", ") + change;
  };
  for (const auto& [name, value] : after.items()) {
    const Json old = before.is_object() && before.contains(name) ? before[name] : Json();
    if (old == value) continue;
    if (name == "mesh") {
      add("the mesh's bytes changed");
    } else {
      add(name + " was " + old.dump() + " and is " + value.dump());
    }
  }
  return text;
}

}  // namespace spm::baker
