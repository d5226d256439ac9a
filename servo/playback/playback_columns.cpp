// SPDX-License-Identifier: Apache-2.0
#include "servo/playback/playback_columns.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <utility>

#include "formats/motion/row_vectors.hpp"
#include "servo/playback/playback.hpp"

namespace spm::servo {

namespace {

constexpr double steps_a_second = 60;
constexpr double us_per_ns = 1e-3;

constexpr std::array<const char*, 31> columns{
    "x",     "y",     "z",     "qw",     "qx",     "qy",     "qz",      "fx",
    "fy",    "fz",    "tx",    "ty",     "tz",     "wx",     "wy",      "wz",
    "depth", "wake",  "busy",  "work",   "cause",  "flags",  "patches", "has_tool",
    "toolx", "tooly", "toolz", "toolqw", "toolqx", "toolqy", "toolqz"};
using Numbers = std::array<float, columns.size()>;

template <class Number>
void append(std::string& bytes, const Number* numbers, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(numbers), count * sizeof(Number));
}

double force_of(const RecordingRow& row) { return vector_of(row.sent).norm(); }

Numbers numbers_of(const RecordingRow& row, const Placement& workspace, double work) {
  const Eigen::Quaterniond hand = workspace.rotation * turn_of(row.orientation);
  Numbers numbers{};
  std::size_t at = 0;
  const auto add = [&](double value) { numbers[at++] = static_cast<float>(value); };
  const auto add3 = [&](const Vector3& value) {
    for (int axis = 0; axis < 3; ++axis) add(value[axis]);
  };
  add3(workspace.to_world(vector_of(row.position)));
  for (const double part : {hand.w(), hand.x(), hand.y(), hand.z()}) add(part);
  add3(workspace.rotation * vector_of(row.sent));
  add3(workspace.rotation * vector_of(row.sent_torque));
  add3(workspace.rotation * vector_of(row.wanted));
  add(row.depth);
  add(row.wake_ns * us_per_ns);
  add(row.busy_ns * us_per_ns);
  add(work);
  add(row.cause);
  add(row.flags);
  add(row.patches);
  add((row.flags & recorded_tool) != 0 ? 1 : 0);
  add3(vector_of(row.tool_position));
  for (const double part : row.tool_orientation) add(part);
  return numbers;
}

/// The rows of a device that are shown, each with the work done on the hand until then, J: the
/// force of a tick acts until the next one. Across missing ticks none is counted.
struct Shown {
  const RecordingRow* row = nullptr;
  double work = 0;
};

std::vector<Shown> shown_rows(const Recording& recording, std::size_t device, std::size_t most) {
  std::size_t count = 0;
  for (const RecordingRow& row : recording.rows) count += row.device == device ? 1 : 0;
  const std::size_t group = most == 0 ? 1 : std::max<std::size_t>(1, (count + most - 1) / most);
  std::vector<Shown> shown;
  const RecordingRow* before = nullptr;
  double work = 0;
  std::size_t number = 0;
  for (const RecordingRow& row : recording.rows) {
    if (row.device != device) continue;
    if (before != nullptr && (row.flags & recorded_lost) == 0) {
      work += vector_of(before->sent).dot(vector_of(row.position) - vector_of(before->position));
    }
    before = &row;
    if (number++ % group == 0) {
      shown.push_back({&row, work});
    } else if (force_of(row) > force_of(*shown.back().row)) {
      shown.back() = {&row, work};
    }
  }
  return shown;
}

}  // namespace

std::vector<std::string> column_names() { return {columns.begin(), columns.end()}; }

std::string columns_of(const Recording& recording, std::size_t device, const Placement& workspace,
                       std::size_t most) {
  const std::vector<Shown> shown = shown_rows(recording, device, most);
  const std::array<std::uint32_t, 2> head{static_cast<std::uint32_t>(shown.size()),
                                          static_cast<std::uint32_t>(columns.size())};
  std::string bytes;
  append(bytes, head.data(), head.size());
  for (const Shown& one : shown) {
    const auto tick = static_cast<double>(one.row->tick);
    append(bytes, &tick, 1);
  }
  std::vector<float> numbers(columns.size() * shown.size());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const Numbers row = numbers_of(*shown[i].row, workspace, shown[i].work);
    for (std::size_t k = 0; k < columns.size(); ++k) numbers[k * shown.size() + i] = row[k];
  }
  append(bytes, numbers.data(), numbers.size());
  return bytes;
}

std::string steps_bytes(RecordedScene scene, std::span<const SceneStep> steps, double rate_hz) {
  const auto slot = static_cast<std::uint64_t>(std::max(1.0, rate_hz / steps_a_second));
  using Step = std::array<double, Playback::step_numbers>;
  std::vector<Step> told;
  std::map<std::size_t, std::pair<std::uint64_t, std::size_t>> moved;  // slot, and where it is told
  for (const SceneStep& step : steps) {
    scene.follow(step);
    if (step.kind > RecordedKind::removed || step.object >= scene.scene.objects.size()) continue;
    const PlacedObject& object = scene.scene.objects[step.object];
    const Vector3& place = object.placement.position;
    const Eigen::Quaterniond& turn = object.placement.rotation;
    const Step numbers{double(step.tick),
                       double(step.kind),
                       double(step.object),
                       place.x(),
                       place.y(),
                       place.z(),
                       turn.w(),
                       turn.x(),
                       turn.y(),
                       turn.z(),
                       object.placement.scale,
                       double(object.asset)};
    const auto last = moved.find(step.object);
    if (step.kind == RecordedKind::placed && last != moved.end() &&
        last->second.first == step.tick / slot) {
      told[last->second.second] = numbers;
      continue;
    }
    if (step.kind == RecordedKind::placed) {
      moved[step.object] = {step.tick / slot, told.size()};
    } else {
      moved.erase(step.object);
    }
    told.push_back(numbers);
  }
  // A move that took the place of an earlier one in its slot may come after others.
  std::stable_sort(told.begin(), told.end(),
                   [](const Step& one, const Step& other) { return one[0] < other[0]; });
  std::string bytes;
  for (const Step& numbers : told) append(bytes, numbers.data(), numbers.size());
  return bytes;
}

}  // namespace spm::servo
