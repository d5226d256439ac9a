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
constexpr std::size_t max_header_bytes = std::size_t{1} << 20U;
constexpr double slowest = 1, fastest = 1e5;  // Hz

void append_bytes(std::string& to, const void* from, std::size_t count) {
  to.append(static_cast<const char*>(from), count);
}

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

Json to_json(const RecordingHeader& header) {
  Json devices = Json::array();
  for (const RecordedDevice& device : header.devices) {
    devices.push_back({{"name", device.name}, {"encoder_step_m", device.encoder_step}});
    if (std::isfinite(device.stiffness_cap)) {
      devices.back()["stiffness_cap_n_m"] = device.stiffness_cap;
    }
  }
  Json json;
  if (header.form > 1) json["form"] = header.form;
  json.update({{"spm_version", header.spm_version},
               {"instruction_set", header.instruction_set},
               {"rate_hz", header.rate_hz},
               {"devices", std::move(devices)},
               {"causes", header.causes},
               {"assets", header.assets},
               {"row_bytes", sizeof(RecordingRow)},
               {"row",
                {"tick u64", "position f64 x3 m", "wanted f64 x3 N", "sent f64 x3 N", "depth f64 m",
                 "wake_ns i32", "busy_ns i32", "buttons u32", "device u16", "cause u8",
                 "flags u8: 1 contact, 2 forgot, 4 lost, 8 touched, 16 edited"}}});
  return json;
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

/// `problem` stays empty where all fields are there.
RecordingHeader header_of(const Json& json, std::string& problem) {
  RecordingHeader header;
  JsonFields fields(json, "", problem);
  // The first version did not name itself.
  header.form = fields.optional("form").is_null()
                    ? 1
                    : static_cast<std::uint32_t>(fields.integer("form", 1, recording_form));
  header.spm_version = fields.text("spm_version");
  header.instruction_set = fields.text("instruction_set");
  header.rate_hz = fields.number("rate_hz", slowest, fastest);
  header.causes = texts(fields, "causes");
  header.assets = texts(fields, "assets");
  static_cast<void>(fields.integer("row_bytes", sizeof(RecordingRow), sizeof(RecordingRow)));
  for (const Json& entry : fields.array("devices")) {
    JsonFields device(entry, "devices", problem);
    header.devices.push_back({device.text("name"), device.number("encoder_step_m", 0)});
    if (device.optional("stiffness_cap_n_m").is_null()) continue;
    header.devices.back().stiffness_cap = device.number("stiffness_cap_n_m", 0);
  }
  return header;
}

tl::unexpected<Error> bad(const std::string& path, const std::string& cause) {
  return fail(ExitCode::invalid_input, path + ": " + cause + "; record it again");
}

}  // namespace

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

Result<RecordingWriter> RecordingWriter::create(const std::string& path,
                                                const RecordingHeader& header) {
  if (auto good = check_host(path); !good) return tl::make_unexpected(std::move(good.error()));
  Result<OutputFile> file = OutputFile::create(path);
  if (!file) return tl::make_unexpected(std::move(file.error()));
  RecordingWriter writer(std::move(*file));
  std::string text = to_json(header).dump();
  text.append((8 - text.size() % 8) % 8, ' ');
  const auto size = static_cast<std::uint32_t>(text.size());
  constexpr std::uint32_t nothing = 0;
  writer.buffer_ = magic;
  append_bytes(writer.buffer_, &size, sizeof size);
  append_bytes(writer.buffer_, &nothing, sizeof nothing);
  writer.buffer_ += text;
  return writer;
}

void RecordingWriter::append(const RecordingRow& row) {
  append_bytes(buffer_, &row, sizeof row);
  ++rows_;
  if (buffer_.size() >= buffer_bytes) flush();
}

void RecordingWriter::flush() {
  XXH3_64bits_update(&hash_->state, buffer_.data(), buffer_.size());
  if (state_) state_ = file_.write_at(written_, std::as_bytes(std::span(buffer_)));
  written_ += buffer_.size();
  buffer_.clear();
}

Result<void> RecordingWriter::commit() {
  append_bytes(buffer_, &rows_, sizeof rows_);
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
  const auto rows = number_at<std::uint64_t>(*bytes, covered - sizeof(std::uint64_t));
  const std::size_t row_bytes = bytes->size() - start_bytes - end_bytes;
  if (header_bytes > max_header_bytes || header_bytes > row_bytes ||
      rows > row_bytes / sizeof(RecordingRow) ||
      rows * sizeof(RecordingRow) != row_bytes - header_bytes) {
    return bad(path, "has not as many bytes as it says");
  }
  const Json json = Json::parse(
      bytes->begin() + start_bytes,
      bytes->begin() + static_cast<std::ptrdiff_t>(start_bytes + header_bytes), nullptr, false);
  if (!json.is_object()) return bad(path, "has a header that is no JSON object");
  if (json.contains("form") && json["form"].is_number_integer() && json["form"] > recording_form) {
    return fail(ExitCode::invalid_input,
                path + ": is of a form that a newer spm-servo writes; read it with that version");
  }
  Recording recording;
  std::string problem;
  recording.header = header_of(json, problem);
  if (!problem.empty()) return bad(path, "its header: " + problem);
  recording.rows.resize(rows);
  if (rows > 0) {
    std::memcpy(recording.rows.data(), bytes->data() + start_bytes + header_bytes,
                rows * sizeof(RecordingRow));
  }
  for (const RecordingRow& row : recording.rows) {
    if (row.device >= recording.header.devices.size() ||
        row.cause >= recording.header.causes.size()) {
      return bad(path, "names a device or a cause that it does not list");
    }
  }
  return recording;
}

}  // namespace spm
