// SPDX-License-Identifier: Apache-2.0
#include "servo/foxglove/foxglove_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace spm::servo {

using nlohmann::ordered_json;

namespace {

constexpr std::uint64_t ns_per_s = 1'000'000'000;
constexpr const char* frame_name = "world";
// Levels of foxglove.Log.
constexpr int log_info = 2, log_warning = 3;
// The arrow of a force in a viewer's scene.
constexpr double metres_per_newton = 0.01, shaft_share = 0.8, shaft_width = 0.002,
                 head_width = 0.005, smallest_force = 1e-6;

ordered_json time_of(std::uint64_t time_ns) {
  return {{"sec", time_ns / ns_per_s}, {"nsec", time_ns % ns_per_s}};
}

ordered_json to_json(const Vector3& vector) {
  return {{"x", vector.x()}, {"y", vector.y()}, {"z", vector.z()}};
}

ordered_json to_json(const Eigen::Quaterniond& turn) {
  return {{"x", turn.x()}, {"y", turn.y()}, {"z", turn.z()}, {"w", turn.w()}};
}

ordered_json to_json(const HandPose& pose) {
  return {{"position", to_json(pose.position)}, {"orientation", to_json(pose.orientation)}};
}

/// Names of others may hold bytes that are no UTF-8.
std::string text_of(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::string pose_message(std::uint64_t time_ns, const HandPose& pose) {
  return text_of(
      {{"timestamp", time_of(time_ns)}, {"frame_id", frame_name}, {"pose", to_json(pose)}});
}

std::string tick_message(const HandSample& sample) {
  ordered_json json = {{"timestamp", time_of(sample.time_ns)},
                       {"tick", sample.tick},
                       {"force", to_json(sample.sent.force)},
                       {"torque", to_json(sample.sent.torque)},
                       {"force_size", sample.sent.force.norm()},
                       {"depth", sample.depth},
                       {"contact", sample.contact},
                       {"cause", sample.cause}};
  if (sample.wake_us) json["wake_us"] = *sample.wake_us;
  if (sample.busy_us) json["busy_us"] = *sample.busy_us;
  return text_of(json);
}

std::string force_message(const HandSample& sample) {
  const double size = sample.sent.force.norm();
  const double length = size * metres_per_newton;
  ordered_json arrows = ordered_json::array();
  if (size > smallest_force) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(Vector3::UnitX(), sample.sent.force);
    arrows.push_back({{"pose", to_json(HandPose{sample.held, turn})},
                      {"shaft_length", shaft_share * length},
                      {"shaft_diameter", shaft_width},
                      {"head_length", (1 - shaft_share) * length},
                      {"head_diameter", head_width},
                      {"color", {{"r", 0.71}, {"g", 0.19}, {"b", 0.16}, {"a", 1}}}});
  }
  ordered_json entity = {{"timestamp", time_of(sample.time_ns)},
                         {"frame_id", frame_name},
                         {"id", "force"},
                         {"lifetime", time_of(0)},
                         {"frame_locked", false},
                         {"metadata", ordered_json::array()},
                         {"arrows", std::move(arrows)}};
  for (const char* none :
       {"cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"}) {
    entity[none] = ordered_json::array();
  }
  return text_of({{"deletions", ordered_json::array()},
                  {"entities", ordered_json::array({std::move(entity)})}});
}

ordered_json object_schema(std::initializer_list<std::pair<const char*, ordered_json>> fields) {
  ordered_json schema = {{"type", "object"}, {"properties", ordered_json::object()}};
  for (const auto& [name, field] : fields) schema["properties"][name] = field;
  return schema;
}

ordered_json number_schema(const char* description) {
  return {{"type", "number"}, {"description", description}};
}

ordered_json vector_schema(const char* description) {
  ordered_json schema = object_schema(
      {{"x", {{"type", "number"}}}, {"y", {{"type", "number"}}}, {"z", {{"type", "number"}}}});
  schema["description"] = description;
  return schema;
}

ordered_json time_schema() {
  ordered_json schema =
      object_schema({{"sec", {{"type", "integer"}}}, {"nsec", {{"type", "integer"}}}});
  schema["title"] = "time";
  return schema;
}

ordered_json pose_schema() {
  const ordered_json number = {{"type", "number"}};
  return object_schema(
      {{"position", vector_schema("m")},
       {"orientation",
        object_schema({{"x", number}, {"y", number}, {"z", number}, {"w", number}})}});
}

ordered_json pose_in_frame_schema() {
  return object_schema(
      {{"timestamp", time_schema()}, {"frame_id", {{"type", "string"}}}, {"pose", pose_schema()}});
}

ordered_json tick_schema() {
  return object_schema({{"timestamp", time_schema()},
                        {"tick", {{"type", "integer"}, {"description", "on the loop's grid"}}},
                        {"force", vector_schema("N, on the hand, in the world")},
                        {"torque", vector_schema("N m, about the hand's position")},
                        {"force_size", number_schema("N")},
                        {"depth", number_schema("m, below the surface; 0 or more")},
                        {"contact", {{"type", "boolean"}}},
                        {"cause", {{"type", "string"}, {"description", "why there was no force"}}},
                        {"wake_us", number_schema("us, how late the loop woke up")},
                        {"busy_us", number_schema("us, that the tick took")}});
}

ordered_json scene_schema() {
  const ordered_json number = {{"type", "number"}};
  const ordered_json list = {{"type", "array"}};
  ordered_json arrow = object_schema(
      {{"pose", pose_schema()},
       {"shaft_length", number},
       {"shaft_diameter", number},
       {"head_length", number},
       {"head_diameter", number},
       {"color", object_schema({{"r", number}, {"g", number}, {"b", number}, {"a", number}})}});
  ordered_json entity = object_schema({{"timestamp", time_schema()},
                                       {"frame_id", {{"type", "string"}}},
                                       {"id", {{"type", "string"}}},
                                       {"lifetime", time_schema()},
                                       {"frame_locked", {{"type", "boolean"}}},
                                       {"metadata", list},
                                       {"arrows", {{"type", "array"}, {"items", arrow}}}});
  for (const char* none :
       {"cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"}) {
    entity["properties"][none] = list;
  }
  return object_schema(
      {{"deletions", list}, {"entities", {{"type", "array"}, {"items", std::move(entity)}}}});
}

ordered_json log_schema() {
  const ordered_json text = {{"type", "string"}};
  const ordered_json number = {{"type", "integer"}};
  return object_schema({{"timestamp", time_schema()},
                        {"level", number},
                        {"message", text},
                        {"name", text},
                        {"file", text},
                        {"line", number}});
}

/// The name and the schema of a stream's messages.
std::pair<const char*, ordered_json> schema_of(Stream stream) {
  switch (stream) {
    case Stream::hand:
    case Stream::held:
    case Stream::tool:
      return {"foxglove.PoseInFrame", pose_in_frame_schema()};
    case Stream::tick:
      return {"spm.Tick", tick_schema()};
    case Stream::force:
      return {"foxglove.SceneUpdate", scene_schema()};
    case Stream::log:
      break;
  }
  return {"foxglove.Log", log_schema()};
}

}  // namespace

std::vector<FoxgloveChannel> channels_of(const std::vector<bool>& has_tool) {
  std::vector<FoxgloveChannel> channels;
  const auto add = [&](Stream stream, std::size_t device, std::string topic) {
    auto [name, schema] = schema_of(stream);
    schema["title"] = name;
    const auto id = static_cast<std::uint32_t>(channels.size() + 1);
    channels.push_back({id, stream, device, std::move(topic), name, schema.dump()});
  };
  for (std::size_t i = 0; i < has_tool.size(); ++i) {
    add(Stream::hand, i, fmt::format("/hand/{}/pose", i));
    add(Stream::held, i, fmt::format("/hand/{}/held", i));
    add(Stream::tick, i, fmt::format("/hand/{}/tick", i));
    add(Stream::force, i, fmt::format("/hand/{}/force", i));
    if (has_tool[i]) add(Stream::tool, i, fmt::format("/hand/{}/tool", i));
    add(Stream::log, i, fmt::format("/hand/{}/log", i));
  }
  return channels;
}

std::string message_of(const FoxgloveChannel& channel, const HandSample& sample) {
  switch (channel.stream) {
    case Stream::hand:
      return pose_message(sample.time_ns, sample.hand);
    case Stream::held:
      return pose_message(sample.time_ns, {sample.held, sample.hand.orientation});
    case Stream::tool:
      return sample.tool ? pose_message(sample.time_ns, *sample.tool) : "";
    case Stream::tick:
      return tick_message(sample);
    case Stream::force:
      return force_message(sample);
    case Stream::log:
      break;
  }
  return "";
}

std::string log_message(const HandSample& sample, const std::string& before) {
  if (sample.cause == before) return "";
  const bool on = sample.cause == "none";
  const std::string text =
      on ? "the force is on again" : fmt::format("no force: {}; {}", sample.cause, sample.cure);
  return text_of({{"timestamp", time_of(sample.time_ns)},
                  {"level", on ? log_info : log_warning},
                  {"message", text},
                  {"name", "spm-servo"},
                  {"file", ""},
                  {"line", 0}});
}

}  // namespace spm::servo
