// SPDX-License-Identifier: Apache-2.0
#include "servo/record/run_recorder.hpp"

#include <fmt/format.h>

#include <utility>

namespace spm::servo {

Result<RunRecorder> RunRecorder::create(Settings settings, StepRing& steps) {
  RunRecorder recorder(std::move(settings), steps);
  if (!recorder.settings_.record.empty()) {
    auto file = RecordingWriter::create(recorder.settings_.record, recorder.header_now());
    if (!file) return tl::make_unexpected(std::move(file.error()));
    recorder.file_.emplace(std::move(*file));
  }
  return recorder;
}

RunRecorder::RunRecorder(Settings settings, StepRing& steps)
    : settings_(std::move(settings)),
      steps_(&steps),
      scene_{settings_.scene, std::vector<bool>(settings_.scene.objects.size(), false)} {
  if (settings_.memory == nullptr || settings_.black_box.empty()) return;
  black_box_.emplace(settings_.black_box, *settings_.memory, settings_.warn);
}

RecordingHeader RunRecorder::header_now() const {
  RecordingHeader header = settings_.header;
  header.scene = text_of(scene_);
  return header;
}

void RunRecorder::take(const RecordingRow& row) {
  // The loop wrote the changes before a tick's rows into their ring before these rows.
  while (const SceneStep* step = steps_->peek()) {
    if (step->tick > row.tick) break;
    take(*step);
    steps_->pop();
  }
  if ((row.flags & recorded_exchanged) != 0) look_at_assets(row.tick);
  part_.clear();
  append_part(part_, row);
  if (black_box_) {
    black_box_->take(row, part_, [this] { return header_now(); });
  }
  write(part_, row.tick);
}

void RunRecorder::take(const SceneStep& step) {
  if (step.settings.asset >= settings_.header.assets.size()) look_at_assets(step.tick);
  // In this order, because a recording that begins here has the scene before the step.
  keep(recorded(step));
  scene_.follow(step);
}

/// Records the list of assets if it is another one than before.
void RunRecorder::look_at_assets(std::uint64_t tick) {
  if (!settings_.assets) return;
  std::vector<RecordedAsset> now = settings_.assets();
  if (now == settings_.header.assets) return;
  RecordedChange change;
  change.tick = tick;
  change.kind = RecordedKind::assets;
  change.assets = now;
  keep(change);
  settings_.header.assets = std::move(now);
}

void RunRecorder::keep(const RecordedChange& change) {
  part_.clear();
  append_part(part_, change);
  if (black_box_) {
    black_box_->take(part_, [this] { return header_now(); });
  }
  write(part_, change.tick);
}

void RunRecorder::write(std::string_view part, std::uint64_t tick) {
  if (!file_ || full_reported_) return;
  file_->append(part);
  if (file_->ok()) return;
  full_reported_ = true;
  settings_.warn(fmt::format(
      "tick {}: the recording could not be written any further and is given up; free the disk, or "
      "record elsewhere. The loop goes on",
      tick));
}

Result<void> RunRecorder::finish() {
  if (black_box_) black_box_->finish();
  return file_ ? file_->commit() : Result<void>();
}

}  // namespace spm::servo
