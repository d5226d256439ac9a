// SPDX-License-Identifier: Apache-2.0
#include "servo/commands/replay_recording.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "common/base/instruction_set.hpp"

namespace spm::servo {

namespace {

std::array<double, 3> numbers(const Vector3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

std::array<double, 4> numbers(const Eigen::Quaterniond& turn) {
  return {turn.w(), turn.x(), turn.y(), turn.z()};
}

std::array<double, 3> sum(const std::array<double, 3>& one, const std::array<double, 3>& other) {
  return {one[0] + other[0], one[1] + other[1], one[2] + other[2]};
}

RecordingHeader header_of(const ReplaySource& source, std::span<const std::string> hashes,
                          const std::vector<Played>& all) {
  RecordingHeader header;
  if (source.recording) {
    header = source.recording->header;
  } else {
    header.rate_hz = all.front().options.rate_hz;
    header.devices.resize(1);
    header.devices[0].name = "trajectory";
    header.devices[0].encoder_step = all.front().options.encoder_step;
    header.causes = {"none"};
  }
  header.spm_version = SPM_VERSION;
  header.instruction_set = instruction_set();
  header.scene_path = source.choice.scene_path;
  RecordedScene scene{source.choice.scene, source.recorded.gone};
  scene.gone.resize(source.own_scene ? scene.gone.size() : 0);
  scene.gone.resize(scene.scene.objects.size(), false);
  header.scene = text_of(scene);
  if (source.own_scene) return header;
  header.assets.clear();
  std::error_code ignored;
  for (std::size_t i = 0; i < source.choice.assets.size(); ++i) {
    const std::string& path = source.choice.assets[i];
    const std::filesystem::path whole = std::filesystem::absolute(path, ignored);
    header.assets.push_back({whole.empty() ? path : whole.string(), hashes[i]});
  }
  return header;
}

/// Gives a row the forces of a replay.
void take(RecordingRow& row, const ReplayResult& result, std::size_t at) {
  const ContactForce& contact = result.contacts[at];
  row.wanted = numbers(contact.force);
  row.wanted_torque = numbers(contact.torque);
  row.depth = contact.depth;
  const bool on = row.cause == 0;
  row.sent = on ? sum(row.wanted, row.added) : std::array<double, 3>{};
  row.sent_torque = on ? sum(row.wanted_torque, row.added_torque) : std::array<double, 3>{};
  constexpr unsigned own = recorded_contact | recorded_force_capped | recorded_torque_capped |
                           recorded_tool_capped | recorded_tool;
  unsigned flags = row.flags & ~own;
  if (contact.contact) flags |= recorded_contact;
  row.tool_position = {};
  row.tool_orientation = {1, 0, 0, 0};
  row.patches = 0;
  if (at < result.tools.size()) {
    const TickOfTool& tool = result.tools[at];
    row.tool_position = numbers(tool.pose.position);
    row.tool_orientation = numbers(tool.pose.orientation);
    row.patches = static_cast<std::uint16_t>(std::min<std::uint32_t>(tool.patches, UINT16_MAX));
    flags |= recorded_tool;
    if (tool.capped) flags |= recorded_tool_capped;
  }
  row.flags = static_cast<std::uint16_t>(flags);
}

std::vector<RecordingRow> rows_of(const Recording& recording, const std::vector<Played>& all) {
  std::vector<RecordingRow> rows;
  std::vector<std::size_t> next(recording.header.devices.size(), 0);
  for (RecordingRow row : recording.rows) {
    const auto played = std::find_if(all.begin(), all.end(),
                                     [&](const Played& one) { return one.device == row.device; });
    if (played == all.end()) continue;
    take(row, played->result, next[row.device]++);
    rows.push_back(row);
  }
  return rows;
}

std::vector<RecordingRow> rows_of(const Played& played) {
  std::vector<RecordingRow> rows;
  for (std::size_t i = 0; i < played.ticks.trajectory.size(); ++i) {
    const TrajectorySample& sample = played.ticks.trajectory[i];
    RecordingRow& row = rows.emplace_back();
    row.tick = i;
    row.position = numbers(sample.position);
    row.orientation = {sample.qw, sample.qx, sample.qy, sample.qz};
    take(row, played.result, i);
  }
  return rows;
}

}  // namespace

Recording replayed_recording(const ReplaySource& source, std::span<const std::string> hashes,
                             const std::vector<Played>& all) {
  Recording made;
  made.header = header_of(source, hashes, all);
  made.rows = source.recording ? rows_of(*source.recording, all) : rows_of(all.front());
  if (!source.own_scene) return made;
  made.changes = source.recording->changes;
  for (std::size_t i = 0; i < made.changes.size(); ++i) {
    // What the command line says holds for objects that came or changed as well.
    const bool has_settings = made.changes[i].kind == RecordedKind::added ||
                              made.changes[i].kind == RecordedKind::changed;
    if (has_settings) made.changes[i] = recorded(source.steps[i]);
  }
  return made;
}

Result<void> write_whole(const std::string& path, const Recording& recording) {
  auto writer = RecordingWriter::create(path, recording.header);
  if (!writer) return tl::make_unexpected(std::move(writer.error()));
  auto change = recording.changes.begin();
  for (const RecordingRow& row : recording.rows) {
    for (; change != recording.changes.end() && change->tick <= row.tick; ++change) {
      writer->append(*change);
    }
    writer->append(row);
  }
  for (; change != recording.changes.end(); ++change) writer->append(*change);
  return writer->commit();
}

}  // namespace spm::servo
