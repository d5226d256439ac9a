// SPDX-License-Identifier: Apache-2.0
#define XXH_STATIC_LINKING_ONLY
#include "formats/motion/recording.hpp"

#include <xxhash.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <utility>

#include "formats/files/host.hpp"
#include "formats/motion/recording_parts.hpp"

namespace spm {

namespace {

using Json = nlohmann::ordered_json;
using namespace recording_parts;

constexpr std::size_t buffer_bytes = std::size_t{1} << 16U;

void append_bytes(std::string& to, const void* from, std::size_t count) {
  to.append(static_cast<const char*>(from), count);
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
    entry["turns"] = device.turns;
    if (std::isfinite(device.torque_cap)) entry["torque_cap_n_m"] = device.torque_cap;
    entry["turn_step_rad"] = device.turn_step;
    entry["turning_inertia_kg_m2"] = device.turning_inertia;
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
       {"tick u64",
        "position f64 x3 m",
        "orientation f64 x4 w first",
        "wanted f64 x3 N",
        "wanted_torque f64 x3 N m",
        "added f64 x3 N",
        "added_torque f64 x3 N m",
        "sent f64 x3 N",
        "sent_torque f64 x3 N m",
        "tool_position f64 x3 m",
        "tool_orientation f64 x4 w first",
        "depth f64 m",
        "wake_ns i32",
        "busy_ns i32",
        "buttons u32",
        "level u32",
        "refined u32",
        "worked u32",
        "culled u32",
        "reserved u32",
        "device u16",
        "flags u16: 1 contact, 2 forgot, 4 lost, 8 touched, 16 edited, 32 exchanged, 64 force "
        "capped, 128 torque capped, 256 tool capped, 512 tool, 1024 kept",
        "cause u16",
        "patches u16",
        "first u16",
        "exact u16",
        "held u16",
        "shortened u16"}}};
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
  Result<OutputFile> file = OutputFile::create(path, WhileOpen::named);
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

Result<void> write_recording(const std::string& path, std::string_view start,
                             std::span<const std::string_view> parts) {
  auto writer = RecordingWriter::create_with(path, start);
  if (!writer) return tl::make_unexpected(std::move(writer.error()));
  for (const std::string_view piece : parts) writer->append(piece);
  return writer->commit();
}

}  // namespace spm
