// SPDX-License-Identifier: Apache-2.0
#include <xxhash.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "formats/files/host.hpp"
#include "formats/files/json_fields.hpp"
#include "formats/files/json_text.hpp"
#include "formats/files/text_file.hpp"
#include "formats/motion/recording.hpp"
#include "formats/motion/recording_parts.hpp"
#include "formats/motion/recording_salvage.hpp"

namespace spm {

namespace {

using Json = nlohmann::ordered_json;
using namespace recording_parts;

constexpr std::size_t end_bytes = 16;
constexpr std::size_t max_header_bytes = std::size_t{1} << 24U;
constexpr std::uint32_t max_objects = 1U << 16U;
constexpr double rotation_slack = 1e-6;
constexpr double slowest = 1, fastest = 1e5;  // Hz

template <class Number>
Number number_at(std::string_view bytes, std::size_t at) {
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

std::vector<std::string> texts(JsonFields& fields, const char* key) {
  std::vector<std::string> list;
  for (const Json& entry : fields.array(key)) {
    if (entry.is_string()) {
      list.push_back(entry.get<std::string>());
    } else {
      fields.wrong(key, "a list of texts");
    }
  }
  return list;
}

std::vector<RecordedAsset> assets_of(JsonFields& fields, std::string& problem) {
  std::vector<RecordedAsset> list;
  for (const Json& entry : fields.array("assets")) {
    JsonFields asset(entry, "assets", problem);
    list.push_back({asset.text("path"), asset.text("content_sha256")});
  }
  return list;
}

/// `problem` stays empty where all fields are there.
RecordingHeader header_of(const Json& json, std::string& problem) {
  RecordingHeader header;
  JsonFields fields(json, "", problem);
  header.spm_version = fields.text("spm_version");
  header.instruction_set = fields.text("instruction_set");
  header.rate_hz = fields.number("rate_hz", slowest, fastest);
  header.causes = texts(fields, "causes");
  header.assets = assets_of(fields, problem);
  header.scene_path = fields.text("scene_path");
  header.scene = fields.text("scene");
  static_cast<void>(fields.integer("row_bytes", sizeof(RecordingRow), sizeof(RecordingRow)));
  for (const Json& entry : fields.array("devices")) {
    JsonFields device(entry, "devices", problem);
    RecordedDevice& read = header.devices.emplace_back();
    read.name = device.text("name");
    read.encoder_step = device.number("encoder_step_m", 0);
    const auto given = [&device](const char* key) { return !device.optional(key).is_null(); };
    if (given("stiffness_cap_n_m")) read.stiffness_cap = device.number("stiffness_cap_n_m", 0);
    if (given("force_cap_n")) read.force_cap = device.number("force_cap_n", 0);
    if (given("profile")) read.profile = device.text("profile");
    if (!given("turns")) continue;
    read.turns = device.flag("turns");
    read.torque_cap = given("torque_cap_n_m") ? device.number("torque_cap_n_m", 0)
                                              : std::numeric_limits<double>::infinity();
    read.turn_step = device.number("turn_step_rad", 0);
    read.turning_inertia = device.number("turning_inertia_kg_m2", 0);
  }
  return header;
}

tl::unexpected<Error> bad(const std::string& path, const std::string& cause) {
  return fail(ExitCode::invalid_input, path + ": " + cause + "; record it again");
}

/// Why a file of another form is not read; empty if it is of this form.
std::string objection_to_form(const Json& json) {
  const Json form = json.value("form", Json(1));
  if (form == recording_form) return {};
  if (form.is_number_integer() && form > recording_form) {
    return "is of a form that a newer spm-servo writes; replay it with that version";
  }
  const Json version = json.value("spm_version", Json());
  return "is of an older form, of spm-servo " +
         (version.is_string() ? version.get<std::string>() : "of unknown version") +
         ", which has not all that forces come from, such as torque; replay it with that "
         "version, or record it again";
}

/// One part that is no row. `problem` stays empty where it is whole.
RecordedChange change_of(std::uint32_t kind, std::string_view bytes, std::string& problem) {
  RecordedChange change;
  change.kind = static_cast<RecordedKind>(kind);
  if (change.kind == RecordedKind::placed) {
    PlacedPart part;
    if (bytes.size() != sizeof part) {
      problem = "a pose has not its size";
      return change;
    }
    std::memcpy(&part, bytes.data(), sizeof part);
    double norm = 0, size = 0;
    for (std::size_t i = 0; i < part.pose.size(); ++i)
      (i < 3 ? size : norm) += part.pose[i] * part.pose[i];
    if (!(std::abs(norm - 1) <= rotation_slack) || !std::isfinite(size) ||
        part.object >= max_objects) {
      problem = "a pose is none";
    }
    change.tick = part.tick;
    change.object = static_cast<std::uint32_t>(part.object);
    change.pose = part.pose;
    return change;
  }
  if (change.kind < RecordedKind::placed || change.kind > RecordedKind::lost) {
    problem = "a part is of no known kind";
    return change;
  }
  const Json json = parse_json<Json>(bytes);
  if (!json.is_object()) {
    problem = "a change is no JSON object";
    return change;
  }
  JsonFields fields(json, "change", problem);
  change.tick = fields.integer("tick", 0, std::numeric_limits<std::uint64_t>::max());
  if (change.kind == RecordedKind::assets) change.assets = assets_of(fields, problem);
  if (change.kind <= RecordedKind::removed) {
    change.object = static_cast<std::uint32_t>(fields.integer("object", 0, max_objects));
  }
  const bool has_settings = change.kind == RecordedKind::added ||
                            change.kind == RecordedKind::changed ||
                            change.kind == RecordedKind::stabilized;
  if (has_settings) change.settings = fields.text("settings");
  return change;
}

/// Reads parts while they are whole, and returns their number; `bytes` keeps what follows them.
/// `problem` stays empty where none was wrong.
std::uint64_t read_parts(std::string_view& bytes, Recording& recording, std::string& problem) {
  std::uint64_t found = 0;
  for (std::size_t size = part_bytes(bytes); size > 0; size = part_bytes(bytes)) {
    const auto kind = number_at<std::uint32_t>(bytes, 0);
    const std::string_view part = bytes.substr(head_bytes, size - head_bytes);
    if (kind != row_kind) {
      RecordedChange change = change_of(kind, part, problem);
      if (!problem.empty()) return found;
      recording.changes.push_back(std::move(change));
    } else {
      RecordingRow row;
      if (part.size() != sizeof row) {
        problem = "a row has not its size";
        return found;
      }
      std::memcpy(&row, part.data(), sizeof row);
      if (row.device >= recording.header.devices.size() ||
          row.cause >= recording.header.causes.size()) {
        problem = "names a device or a cause that it does not list";
        return found;
      }
      recording.rows.push_back(row);
    }
    bytes.remove_prefix(size);
    ++found;
  }
  return found;
}

/// A file whose header was read.
struct Opened {
  std::string bytes;
  std::size_t parts_from = 0;  ///< where its parts begin
  bool intact = false;         ///< its checksum is that of its bytes
  Recording recording;         ///< without rows and changes
};

/// `only_intact`: a checksum that is wrong is an error.
Result<Opened> open_recording(const std::string& path, bool only_intact) {
  if (auto good = check_host(path); !good) return tl::make_unexpected(std::move(good.error()));
  Result<std::string> read = read_text_file(path, "a recording");
  if (!read) return tl::make_unexpected(std::move(read.error()));
  Opened opened;
  opened.bytes = std::move(*read);
  const std::string& bytes = opened.bytes;
  if (bytes.size() < start_bytes + end_bytes || bytes.compare(0, magic.size(), magic) != 0) {
    return bad(path, "is no recording of spm-servo run --record");
  }
  const std::size_t header_bytes = number_at<std::uint32_t>(bytes, magic.size());
  const std::size_t covered = bytes.size() - sizeof(std::uint64_t);
  opened.intact = number_at<std::uint64_t>(bytes, covered) == XXH3_64bits(bytes.data(), covered);
  if (only_intact && !opened.intact)
    return bad(path, "was cut short or changed since it was written");
  if (header_bytes > max_header_bytes || header_bytes > bytes.size() - start_bytes - end_bytes) {
    return bad(path, "has not as many bytes as it says");
  }
  opened.parts_from = start_bytes + header_bytes;
  const std::string_view text = std::string_view(bytes).substr(start_bytes, header_bytes);
  const Json json = parse_json<Json>(text);
  if (!json.is_object()) return bad(path, "has a header that is no JSON object");
  if (const std::string problem = objection_to_form(json); !problem.empty()) {
    return fail(ExitCode::invalid_input, path + ": " + problem);
  }
  std::string problem;
  opened.recording.header = header_of(json, problem);
  if (!problem.empty()) return bad(path, "its header: " + problem);
  return opened;
}

/// What follows the parts of an intact file. `problem` stays empty where all are whole.
void read_intact(const Opened& opened, Recording& recording, std::string& problem) {
  const std::string_view bytes = opened.bytes;
  const auto parts = number_at<std::uint64_t>(bytes, bytes.size() - end_bytes);
  std::string_view body =
      bytes.substr(opened.parts_from, bytes.size() - opened.parts_from - end_bytes);
  const std::uint64_t found = read_parts(body, recording, problem);
  if (problem.empty() && (!body.empty() || found != parts)) {
    problem = "has not as many bytes as it says";
  }
}

}  // namespace

bool is_recording(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, magic.size()> first{};
  return file.read(first.data(), first.size()) && std::string_view(first.data(), 8) == magic;
}

Result<Recording> read_recording(const std::string& path) {
  Result<Opened> opened = open_recording(path, true);
  if (!opened) return tl::make_unexpected(std::move(opened.error()));
  std::string problem;
  read_intact(*opened, opened->recording, problem);
  if (!problem.empty()) return bad(path, problem);
  return std::move(opened->recording);
}

Result<SalvagedRecording> salvage_recording(const std::string& path) {
  Result<Opened> opened = open_recording(path, false);
  if (!opened) return tl::make_unexpected(std::move(opened.error()));
  SalvagedRecording salvaged;
  Recording& recording = opened->recording;
  std::string problem;
  if (opened->intact) {
    read_intact(*opened, recording, problem);
    if (!problem.empty()) return bad(path, problem);
  } else {
    std::string_view body = std::string_view(opened->bytes).substr(opened->parts_from);
    read_parts(body, recording, problem);
    if (recording.rows.empty()) {
      return bad(path, "was cut short before its first tick, or changed since it was written");
    }
    salvaged.loss = path + ": was cut short or changed since it was written; its first " +
                    std::to_string(recording.rows.size()) +
                    " rows are whole and shown, what followed is lost; record it again";
  }
  salvaged.recording = std::move(recording);
  return salvaged;
}

}  // namespace spm
