// SPDX-License-Identifier: Apache-2.0
#include "servo/foxglove/mcap_export.hpp"

#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "formats/mcap/mcap_writer.hpp"
#include "formats/motion/recording_salvage.hpp"
#include "formats/motion/row_vectors.hpp"
#include "servo/foxglove/foxglove_channels.hpp"
#include "servo/playback/playback_marks.hpp"
#include "servo/record/recorded_scene.hpp"

namespace spm::servo {

namespace {

constexpr double arrows_a_second = 60, ns_per_s = 1e9, us_per_ns = 1e-3;

/// Where the surface held the hand is not recorded: it is at the depth along the law's force, but
/// for what friction and stabilization turn it.
Vector3 held_place(const RecordingRow& row, const HandPose& hand, const Placement& workspace) {
  const Vector3 wanted = workspace.rotation * vector_of(row.wanted);
  const double size = wanted.norm();
  if (size == 0) return hand.position;
  return hand.position + (row.depth / size) * wanted;
}

HandSample sample_of(const RecordingRow& row, const RecordingHeader& header,
                     const Placement& workspace) {
  HandSample sample;
  sample.tick = row.tick;
  sample.time_ns =
      static_cast<std::uint64_t>(std::llround(double(row.tick) * (ns_per_s / header.rate_hz)));
  sample.hand = {workspace.to_world(vector_of(row.position)),
                 workspace.rotation * turn_of(row.orientation)};
  if ((row.flags & recorded_tool) != 0) {
    sample.tool = HandPose{vector_of(row.tool_position), turn_of(row.tool_orientation)};
  }
  sample.held = held_place(row, sample.hand, workspace);
  sample.sent = {workspace.rotation * vector_of(row.sent),
                 workspace.rotation * vector_of(row.sent_torque)};
  sample.depth = row.depth;
  sample.contact = (row.flags & recorded_contact) != 0;
  sample.cause = header.causes[row.cause];
  sample.cure = cure_of_cause(sample.cause);
  sample.wake_us = row.wake_ns * us_per_ns;
  sample.busy_us = row.busy_ns * us_per_ns;
  return sample;
}

/// Writes the messages of one recording.
class Export {
 public:
  Export(McapWriter& writer, const Recording& recording) : writer_(writer) {
    std::vector<bool> has_tool(recording.header.devices.size(), false);
    for (const RecordingRow& row : recording.rows) {
      if ((row.flags & recorded_tool) != 0) has_tool[row.device] = true;
    }
    channels_ = channels_of(has_tool);
    std::map<std::string, std::uint16_t> schemas;
    for (const FoxgloveChannel& channel : channels_) {
      auto known = schemas.find(channel.schema_name);
      if (known == schemas.end()) {
        const std::uint16_t number =
            writer.add_schema(channel.schema_name, "jsonschema", channel.schema);
        known = schemas.emplace(channel.schema_name, number).first;
      }
      numbers_.push_back(writer.add_channel(known->second, channel.topic, "json"));
    }
    causes_.resize(has_tool.size(), "none");
    arrows_.resize(has_tool.size());
    arrow_gap_ =
        static_cast<std::uint64_t>(std::llround(recording.header.rate_hz / arrows_a_second));
  }

  void add(const HandSample& sample, std::size_t device) {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      if (channels_[i].device != device) continue;
      const std::string message = message_about(channels_[i], sample);
      if (message.empty()) continue;
      writer_.write(numbers_[i], sample.time_ns, message);
      ++done_.messages;
    }
    causes_[device] = sample.cause;
    ++done_.ticks;
  }

  [[nodiscard]] McapExport done() const {
    McapExport done = done_;
    for (const FoxgloveChannel& channel : channels_) done.topics.push_back(channel.topic);
    return done;
  }

 private:
  std::string message_about(const FoxgloveChannel& channel, const HandSample& sample) {
    if (channel.stream == Stream::log) return log_message(sample, causes_[channel.device]);
    if (channel.stream == Stream::force) {
      std::uint64_t& next = arrows_[channel.device];
      if (sample.tick < next) return "";
      next = sample.tick + arrow_gap_;
    }
    return message_of(channel, sample);
  }

  McapWriter& writer_;
  std::vector<FoxgloveChannel> channels_;
  std::vector<std::uint16_t> numbers_;
  std::vector<std::string> causes_;    ///< of each device's last tick
  std::vector<std::uint64_t> arrows_;  ///< of each device, the tick of the next arrow
  std::uint64_t arrow_gap_ = 0;
  McapExport done_;
};

}  // namespace

Result<McapExport> export_mcap(const std::string& path, const std::string& out) {
  Result<SalvagedRecording> salvaged = salvage_recording(path);
  if (!salvaged) return tl::make_unexpected(std::move(salvaged.error()));
  const Recording& recording = salvaged->recording;
  const RecordingHeader& header = recording.header;
  const auto scene = recorded_scene(header.scene, assets_of(recording).size());
  if (!scene) return fail(scene.error().code, path + ": " + scene.error().message);
  auto writer = McapWriter::create(out, "", std::string("spm-servo ") + SPM_VERSION);
  if (!writer) return tl::make_unexpected(std::move(writer.error()));
  writer->add_metadata("spm_recording", {{"spm_version", header.spm_version},
                                         {"rate_hz", std::to_string(header.rate_hz)},
                                         {"loss", salvaged->loss.empty() ? "none" : "cut short"}});
  Export exported(*writer, recording);
  for (const RecordingRow& row : recording.rows) {
    exported.add(sample_of(row, header, scene->scene.workspace), row.device);
  }
  if (auto written = writer->commit(); !written) {
    return tl::make_unexpected(std::move(written.error()));
  }
  McapExport done = exported.done();
  done.loss = salvaged->loss;
  return done;
}

}  // namespace spm::servo
