// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <toml++/toml.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "servo/view/view_state.hpp"

namespace spm::servo {

using nlohmann::ordered_json;

namespace {

const char* name_of(MeshState state) noexcept {
  switch (state) {
    case MeshState::loading:
      return "loading";
    case MeshState::ready:
      return "ready";
    case MeshState::failed:
      break;
  }
  return "failed";
}

const char* method_of(const spm_client_feel& feel) noexcept {
  switch (feel.method) {
    case SPM_CLIENT_METHOD_SPM:
      return "spm";
    case SPM_CLIENT_METHOD_PAPER:
      return "paper";
    default:
      return "proxy";
  }
}

ordered_json to_json(const ViewObject& object) {
  const spm_client_feel& feel = object.feel;
  return {{"id", object.state.id},
          {"name", object.name},
          {"asset", object.state.asset},
          {"method", method_of(feel)},
          {"stabilized", feel.stabilized != 0},
          {"stiffness", feel.stiffness},
          {"friction", {feel.friction_stick, feel.friction_slide}},
          {"damping", feel.damping},
          {"texture", {feel.texture_amplitude, feel.texture_wavelength}}};
}

toml::array pose_of(const spm_client_object& object) {
  toml::array pose;
  for (const double value : object.position) pose.push_back(value);
  for (const double value : object.orientation) pose.push_back(value);
  return pose;
}

toml::table object_table(const ViewState& state, const ViewObject& object) {
  const spm_client_feel& feel = object.feel;
  toml::table table;
  if (object.state.asset < state.assets.size()) {
    const ViewAsset& asset = state.assets[object.state.asset];
    table.insert("asset", asset.path.empty() ? asset.name : asset.path);
  }
  table.insert("pose", pose_of(object.state));
  table.insert("scale", object.state.scale);
  table.insert("stiffness", fmt::format("{}N/m", feel.stiffness));
  table.insert("method", method_of(feel));
  table.insert("movable", object.state.movable != 0);
  // The paper's own effects are not told.
  if (feel.method == SPM_CLIENT_METHOD_PAPER) return table;
  if (feel.friction_stick > 0) {
    table.insert("friction",
                 toml::table{{"stick", feel.friction_stick}, {"slide", feel.friction_slide}});
  }
  if (feel.damping > 0) table.insert("damping", fmt::format("{}Ns/m", feel.damping));
  if (feel.texture_amplitude > 0) {
    table.insert("texture", toml::table{{"amplitude", fmt::format("{}m", feel.texture_amplitude)},
                                        {"wavelength", fmt::format("{}m", feel.texture_wavelength)},
                                        {"seed", std::int64_t(feel.texture_seed)}});
  }
  return table;
}

toml::table device_table(const ViewState& state) {
  toml::table table;
  if (state.devices.empty()) return table;
  const ViewDevice& device = state.devices.front();
  const bool led = device.state.hand != SPM_CLIENT_HAND_OWN;
  table.insert("driver", led ? device.name + ":hand=live" : device.name);
  return table;
}

}  // namespace

std::string scene_json(const ViewState& state) {
  ordered_json json = {{"t", "scene"},
                       {"daemon", state.daemon},
                       {"message", state.message},
                       {"version", state.info.daemon_version},
                       {"process", state.info.process},
                       {"rate_hz", state.info.rate_hz}};
  json["devices"] = ordered_json::array();
  for (const ViewDevice& device : state.devices) {
    json["devices"].push_back({{"name", device.name},
                               {"bare_border", device.bare_border},
                               {"stabilized_border", device.stabilized_border}});
  }
  json["objects"] = ordered_json::array();
  for (const ViewObject& object : state.objects) json["objects"].push_back(to_json(object));
  json["assets"] = ordered_json::array();
  for (const ViewAsset& asset : state.assets) {
    json["assets"].push_back({{"name", asset.name},
                              {"mesh", name_of(asset.mesh)},
                              {"number", asset.number},
                              {"error", asset.error},
                              {"cell", asset.cell},
                              {"triangles", asset.triangles}});
  }
  json["causes"] = ordered_json::array();
  for (const ViewCause& cause : state.causes) {
    json["causes"].push_back({{"name", cause.name}, {"cure", cause.cure}});
  }
  json["applications"] = ordered_json::array();
  for (const spm_client_application& application : state.applications) {
    json["applications"].push_back({{"name", application.name},
                                    {"process", application.process},
                                    {"supervisor", application.role == SPM_CLIENT_SUPERVISOR},
                                    {"observer", application.role == SPM_CLIENT_OBSERVER}});
  }
  // Names of others may hold bytes that are no UTF-8.
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::string scene_toml(const ViewState& state) {
  toml::table scene;
  scene.insert("device", device_table(state));
  toml::array objects;
  bool stabilized = true;
  for (const ViewObject& object : state.objects) {
    stabilized = stabilized && object.feel.stabilized != 0;
    objects.push_back(object_table(state, object));
  }
  scene.insert("stabilization", toml::table{{"recommended", stabilized}});
  scene.insert("object", std::move(objects));
  std::ostringstream text;
  text << "# A scene as it was felt, saved by spm-servo view. Run it by: spm-servo run --scene "
          "FILE\n\n"
       << scene << "\n";
  return text.str();
}

}  // namespace spm::servo
