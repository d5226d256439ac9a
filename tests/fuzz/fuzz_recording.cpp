// SPDX-License-Identifier: Apache-2.0
// Recordings with a right sum and any content, and trajectories.
#include <xxhash.h>

#include <cstring>

#include "formats/motion/recording.hpp"
#include "formats/motion/recording_salvage.hpp"
#include "formats/motion/trajectory.hpp"
#include "servo/record/recorded_scene.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace spm::fuzz {

namespace {

RecordingHeader header() {
  RecordingHeader made;
  made.spm_version = "1.2.3";
  made.instruction_set = "AVX2";
  made.rate_hz = 1000;
  made.devices.resize(1);
  made.devices[0].name = "sim";
  made.causes = {"none", "starting"};
  made.assets = {{"a.spm.exr", "abc"}};
  servo::RecordedScene scene;
  scene.scene.objects.resize(2);
  scene.gone = {false, true};
  made.scene = servo::text_of(scene);
  return made;
}

/// All that a program does with a recording before it looks for the assets.
void follow(const Recording& recording) {
  const std::size_t assets = recording.header.assets.size();
  static_cast<void>(servo::recorded_scene(recording.header.scene, assets));
  for (const RecordedChange& change : recording.changes) {
    static_cast<void>(servo::step_of(change, assets));
  }
}

}  // namespace

std::vector<std::string> seeds() {
  const test::TemporaryFolder folder;
  auto writer = RecordingWriter::create(folder.file("seed.spmrec"), header());
  if (!writer) return {};
  for (std::uint64_t tick = 0; tick < 3; ++tick) {
    RecordingRow row;
    row.tick = tick;
    writer->append(row);
    RecordedChange change;
    change.tick = tick;
    change.kind = tick == 0 ? RecordedKind::placed : RecordedKind::removed;
    change.pose = {0.1, -0.2, 1e-9, 0.6, 0, -0.8, 0};
    writer->append(change);
  }
  if (!writer->commit()) return {};
  return {bytes_of(folder.file("seed.spmrec")), "0 0 0\n1 0 0\n# what\n0.5 1e-3 -2 1 0 0 0\n"};
}

std::vector<std::string> endings() { return {".spmrec", ".txt"}; }

}  // namespace spm::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static spm::fuzz::ScratchFile file;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.size() > sizeof(std::uint64_t)) {
    const std::size_t covered = bytes.size() - sizeof(std::uint64_t);
    const std::uint64_t sum = XXH3_64bits(bytes.data(), covered);
    std::memcpy(bytes.data() + covered, &sum, sizeof sum);
  }
  file.write(bytes);
  if (const auto recording = spm::read_recording(file.path())) spm::fuzz::follow(*recording);
  // As it came, its sum is wrong.
  file.write({reinterpret_cast<const char*>(data), size});
  if (const auto saved = spm::salvage_recording(file.path())) spm::fuzz::follow(saved->recording);
  static_cast<void>(spm::read_trajectory(file.path()));
  return 0;
}
