// SPDX-License-Identifier: Apache-2.0
#include "formats/motion/recording.hpp"

#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <utility>

#include "formats/files/host.hpp"
#include "formats/files/json_fields.hpp"
#include "formats/files/text_file.hpp"

namespace spm {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view magic = "SPM-REC1";
constexpr std::size_t start_bytes = magic.size() + 8;
constexpr std::size_t end_bytes = 16;
constexpr std::size_t buffer_bytes = std::size_t{1} << 16U;
constexpr std::size_t max_header_bytes = std::size_t{1} << 24U;
constexpr std::uint32_t row_kind = 1;
constexpr std::size_t head_bytes = 8;
constexpr std::uint32_t max_objects = 1U << 16U;
constexpr double rotation_slack = 1e-6;
constexpr double slowest = 1, fastest = 1e5;  // Hz

void append_bytes(std::string& to, const void* from, std::size_t count) {
  to.append(static_cast<const char*>(from), count);
}

template <class Number>
Number number_at(std::string_view bytes, std::size_t at) {
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

Json to_json(const std::vector<RecordedAsset>& assets) {
  Json list = Json::array();
  for (const RecordedAsset& asset : assets) {
    list.push_back({{"path", asset.path}, {"content_sha256", asset.content_sha256}});
  }
  return list;
}

Json to_json(const RecordingHeader& header) {
  Json devices = Json::array();
  for (const RecordedDevice& device : header.devices) {
    devices.push_back({{"name", device.name}, {"encoder_step_m", device.encoder_step}});
    Json& entry = devices.back();
    if (std::isfinite(device.stiffness_cap)) entry["stiffness_cap_n_m"] = device.stiffness_cap;
    if (std::isfinite(device.force_cap)) entry["force_cap_n"] = device.force_cap;
    if (!device.profile.empty()) entry["profile"] = device.profile;
  }
  Json json = {
      {"form", header.form},
      {"spm_version", header.spm_version},
      {"instruction_set", header.instruction_set},
      {"rate_hz", header.rate_hz},
      {"devices", std::move(devices)},
      {"causes", header.causes},
      {"assets", to_json(header.assets)},
      {"scene_path", header.scene_path},
      {"scene", header.scene},
      {"row_bytes", sizeof(RecordingRow)},
      {"row",
       {"tick u64", "position f64 x3 m", "wanted f64 x3 N", "added f64 x3 N", "sent f64 x3 N",
        "depth f64 m", "wake_ns i32", "busy_ns i32", "buttons u32", "device u16", "cause u8",
        "flags u8: 1 contact, 2 forgot, 4 lost, 8 touched, 16 edited, 32 exchanged", "first u16",
        "exact u16", "held u16", "shortened u16"}}};
  return json;
}

/// JSON of bytes that may be anything; a path need not be UTF-8.
std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void pad(std::string& text) { text.append((8 - text.size() % 8) % 8, ' '); }

void append_head(std::string& to, std::uint32_t kind, std::size_t bytes) {
  const auto size = static_cast<std::uint32_t>(bytes);
  append_bytes(to, &kind, sizeof kind);
  append_bytes(to, &size, sizeof size);
}

/// The size of the first part of some bytes, with its head; 0 where no whole part is left.
std::size_t part_bytes(std::string_view bytes) {
  if (bytes.size() < head_bytes) return 0;
  std::array<std::uint32_t, 2> head{};
  std::memcpy(head.data(), bytes.data(), head_bytes);
  const bool whole = head[1] % 8 == 0 && head[1] <= bytes.size() - head_bytes;
  return whole ? head_bytes + head[1] : 0;
}

/// A change of pose in the file.
struct PlacedPart {
  std::uint64_t tick = 0;
  std::uint64_t object = 0;
  std::array<double, 7> pose{};
};

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
  }
  return header;
}

tl::unexpected<Error> bad(const std::string& path, const std::string& cause) {
  return fail(ExitCode::invalid_input, path + ": " + cause + "; record it again");
}

}  // namespace

std::string recording_start(const RecordingHeader& header) {
  std::string text = dumped(to_json(header));
  pad(text);
  const auto size = static_cast<std::uint32_t>(text.size());
  constexpr std::uint32_t nothing = 0;
  std::string bytes(magic);
  append_bytes(bytes, &size, sizeof size);
  append_bytes(bytes, &nothing, sizeof nothing);
  return bytes + text;
}

void append_part(std::string& bytes, const RecordingRow& row) {
  append_head(bytes, row_kind, sizeof row);
  append_bytes(bytes, &row, sizeof row);
}

void append_part(std::string& bytes, const RecordedChange& change) {
  const auto kind = static_cast<std::uint32_t>(change.kind);
  if (change.kind == RecordedKind::placed) {
    const PlacedPart part{change.tick, change.object, change.pose};
    append_head(bytes, kind, sizeof part);
    append_bytes(bytes, &part, sizeof part);
    return;
  }
  Json json = {{"tick", change.tick}};
  if (change.kind == RecordedKind::assets) json["assets"] = to_json(change.assets);
  if (change.kind <= RecordedKind::removed) json["object"] = change.object;
  if (!change.settings.empty()) json["settings"] = change.settings;
  std::string text = dumped(json);
  pad(text);
  append_head(bytes, kind, text.size());
  bytes += text;
}

/// The hash of everything that was written.
struct RecordingWriter::Hash {
  XXH3_state_t state;
};

RecordingWriter::RecordingWriter(OutputFile file)
    : file_(std::move(file)), hash_(std::make_unique<Hash>()) {
  XXH3_64bits_reset(&hash_->state);
  buffer_.reserve(2 * buffer_bytes);
}

RecordingWriter::RecordingWriter(RecordingWriter&&) noexcept = default;
RecordingWriter& RecordingWriter::operator=(RecordingWriter&&) noexcept = default;
RecordingWriter::~RecordingWriter() = default;

Result<RecordingWriter> RecordingWriter::create_with(const std::string& path,
                                                     std::string_view start) {
  if (auto good = check_host(path); !good) return tl::make_unexpected(std::move(good.error()));
  Result<OutputFile> file = OutputFile::create(path);
  if (!file) return tl::make_unexpected(std::move(file.error()));
  RecordingWriter writer(std::move(*file));
  writer.buffer_ = start;
  return writer;
}

void RecordingWriter::append(const RecordingRow& row) {
  append_part(buffer_, row);
  ++parts_;
  if (buffer_.size() >= buffer_bytes) flush();
}

void RecordingWriter::append(const RecordedChange& change) {
  append_part(buffer_, change);
  ++parts_;
  if (buffer_.size() >= buffer_bytes) flush();
}

void RecordingWriter::append(std::string_view parts) {
  std::size_t whole = 0;
  for (std::size_t size = part_bytes(parts); size > 0; size = part_bytes(parts.substr(whole))) {
    whole += size;
    ++parts_;
  }
  buffer_ += parts.substr(0, whole);
  if (buffer_.size() >= buffer_bytes) flush();
}

void RecordingWriter::flush() {
  XXH3_64bits_update(&hash_->state, buffer_.data(), buffer_.size());
  if (state_) state_ = file_.write_at(written_, std::as_bytes(std::span(buffer_)));
  written_ += buffer_.size();
  buffer_.clear();
}

Result<void> RecordingWriter::commit() {
  append_bytes(buffer_, &parts_, sizeof parts_);
  flush();
  if (!state_) return state_;
  const std::uint64_t checksum = XXH3_64bits_digest(&hash_->state);
  append_bytes(buffer_, &checksum, sizeof checksum);
  flush();
  if (!state_) return state_;
  return file_.commit();
}

bool is_recording(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, magic.size()> first{};
  return file.read(first.data(), first.size()) && std::string_view(first.data(), 8) == magic;
}

Result<void> write_recording(const std::string& path, std::string_view start,
                             std::span<const std::string_view> parts) {
  auto writer = RecordingWriter::create_with(path, start);
  if (!writer) return tl::make_unexpected(std::move(writer.error()));
  for (const std::string_view piece : parts) writer->append(piece);
  return writer->commit();
}

namespace {

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
         ", which does not say all that its forces came from; replay it with that version, or "
         "record "
         "it again";
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
  const Json json = Json::parse(bytes.begin(), bytes.end(), nullptr, false);
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

/// Reads the parts after the start. `problem` stays empty where all are whole.
void read_parts(std::string_view bytes, std::uint64_t parts, Recording& recording,
                std::string& problem) {
  std::uint64_t found = 0;
  for (std::size_t size = part_bytes(bytes); size > 0 && problem.empty();
       size = part_bytes(bytes)) {
    const auto kind = number_at<std::uint32_t>(bytes, 0);
    const std::string_view part = bytes.substr(head_bytes, size - head_bytes);
    bytes.remove_prefix(size);
    ++found;
    if (kind != row_kind) {
      recording.changes.push_back(change_of(kind, part, problem));
      continue;
    }
    RecordingRow row;
    if (part.size() != sizeof row) {
      problem = "a row has not its size";
      return;
    }
    std::memcpy(&row, part.data(), sizeof row);
    if (row.device >= recording.header.devices.size() ||
        row.cause >= recording.header.causes.size()) {
      problem = "names a device or a cause that it does not list";
    }
    recording.rows.push_back(row);
  }
  if (problem.empty() && (!bytes.empty() || found != parts)) {
    problem = "has not as many bytes as it says";
  }
}

}  // namespace

Result<Recording> read_recording(const std::string& path) {
  if (auto good = check_host(path); !good) return tl::make_unexpected(std::move(good.error()));
  const Result<std::string> bytes = read_text_file(path, "a recording");
  if (!bytes) return tl::make_unexpected(bytes.error());
  if (bytes->size() < start_bytes + end_bytes || bytes->compare(0, magic.size(), magic) != 0) {
    return bad(path, "is no recording of spm-servo run --record");
  }
  const std::size_t header_bytes = number_at<std::uint32_t>(*bytes, magic.size());
  const std::size_t covered = bytes->size() - sizeof(std::uint64_t);
  if (number_at<std::uint64_t>(*bytes, covered) != XXH3_64bits(bytes->data(), covered)) {
    return bad(path, "was cut short or changed since it was written");
  }
  const auto parts = number_at<std::uint64_t>(*bytes, covered - sizeof(std::uint64_t));
  const std::string_view body =
      std::string_view(*bytes).substr(start_bytes, bytes->size() - start_bytes - end_bytes);
  if (header_bytes > max_header_bytes || header_bytes > body.size()) {
    return bad(path, "has not as many bytes as it says");
  }
  const std::string_view text = body.substr(0, header_bytes);
  const Json json = Json::parse(text.begin(), text.end(), nullptr, false);
  if (!json.is_object()) return bad(path, "has a header that is no JSON object");
  if (const std::string problem = objection_to_form(json); !problem.empty()) {
    return fail(ExitCode::invalid_input, path + ": " + problem);
  }
  Recording recording;
  std::string problem;
  recording.header = header_of(json, problem);
  if (!problem.empty()) return bad(path, "its header: " + problem);
  read_parts(body.substr(header_bytes), parts, recording, problem);
  if (!problem.empty()) return bad(path, problem);
  return recording;
}

}  // namespace spm
