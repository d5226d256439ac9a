// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/scene_keeper.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace spm::servo {

using std::chrono::steady_clock;

namespace {

/// How many changes are described in a message, so that a person reads it to its end.
constexpr std::size_t max_told = 8;

std::int64_t nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

FileStamp stamp_of(const std::string& path) {
  struct stat now {};
  if (::stat(path.c_str(), &now) != 0) return {};
  return {true,
          now.st_dev,
          now.st_ino,
          now.st_size,
          nanoseconds(now.st_mtim),
          nanoseconds(now.st_ctim)};
}

/// Whether both have the same tools; their assets may have other numbers.
bool same_tools(const ForceChoice& before, const ForceChoice& after) {
  if (tools_of(before.scene) != tools_of(after.scene)) return false;
  for (std::size_t k = 0; k < tools_of(before.scene); ++k) {
    const ToolSettings& old_tool = *tool_of(before.scene, k);
    ToolSettings new_tool = *tool_of(after.scene, k);
    if (before.assets[old_tool.asset] != after.assets[new_tool.asset]) return false;
    new_tool.asset = old_tool.asset;
    if (old_tool != new_tool) return false;
  }
  return true;
}

/// Which change of an edited scene needs a restart; null if none does.
const char* fixed_part(const ForceChoice& before, const ForceChoice& after) {
  if (before.device.driver != after.device.driver) return "'driver' of [device]";
  if (before.device.profile != after.device.profile) return "'profile' of [device]";
  if (before.device.force_cap != after.device.force_cap) return "'force_cap' of [device]";
  if (before.probe != after.probe) return "'probe' of [tool]";
  if (before.probe_form() != after.probe_form()) return "'paper_probe' of [tool]";
  if (!same_tools(before, after)) return "[tool]";
  const Placement& old_place = before.scene.workspace;
  const Placement& new_place = after.scene.workspace;
  const bool same = old_place.position == new_place.position &&
                    old_place.rotation.coeffs() == new_place.rotation.coeffs() &&
                    old_place.scale == new_place.scale;
  return same ? nullptr : "[workspace]";
}

std::string in_words(const SceneEdit& edit, const SceneDifference& difference,
                     const ServedScene& after) {
  std::vector<std::string> parts;
  for (const KeptObject& object : difference.kept) {
    if (object.aspects == 0) continue;
    parts.push_back("object " + std::to_string(after.ids[object.after]) + ": " +
                    names_of_aspects(object.aspects));
  }
  if (edit.stabilization) parts.emplace_back("stabilization");
  for (const EditedObject& object : edit.added) {
    const std::filesystem::path asset = after.choice.assets[object.settings.asset];
    parts.push_back("object " + std::to_string(object.id) + " added (" + asset.filename().string() +
                    ")");
  }
  for (const std::uint64_t id : edit.removed) {
    parts.push_back("object " + std::to_string(id) + " removed");
  }
  std::string text;
  for (std::size_t i = 0; i < std::min(parts.size(), max_told); ++i) {
    text += (i > 0 ? "; " : "") + parts[i];
  }
  if (parts.size() > max_told) {
    text += "; and " + std::to_string(parts.size() - max_told) + " more";
  }
  return text;
}

}  // namespace

SceneKeeper::SceneKeeper(SceneKeeperOptions options, SceneAssets& assets)
    : assets_(assets), options_(std::move(options)) {
  served_.choice = assets_.choice();
  served_.ids = first_ids(served_.choice.scene.objects.size());
}

SceneKeeper::~SceneKeeper() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void SceneKeeper::watch() { thread_ = std::thread(&SceneKeeper::run, this); }

void SceneKeeper::run() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, options_.poll, [this] { return stop_; })) {
    lock.unlock();
    look();
    lock.lock();
  }
}

void SceneKeeper::look() {
  if (offered_) {
    const EditAnswer answer = slot_.answer();
    if (answer == EditAnswer::none) return;
    finish(answer);
  }
  const FileStamp now = stamp_of(options_.force.scene);
  const bool settled = now == std::exchange(seen_, now);
  if (!settled) return;
  const bool due = retry_wanted_ && steady_clock::now() >= next_try_;
  if (tried_ == now && !due) return;
  if (tried_ != now) last_refusal_.clear();
  // At the first look the file may have been edited since the daemon read it.
  const bool first = !tried_;
  tried_ = now;
  try_scene(first);
}

void SceneKeeper::try_scene(bool first) {
  retry_wanted_ = false;
  Result<ForceChoice> edited = read_edited();
  if (!edited) return refuse(edited.error().message);
  const SceneDifference difference =
      scene_difference(served_.choice.scene.objects, edited->scene.objects);
  const bool same_stabilization = served_.choice.scene.stabilization == edited->scene.stabilization;
  if (!difference.empty() || !same_stabilization) return offer(difference, std::move(*edited));
  // A different order, and different lines for messages.
  served_.ids = edited_ids(difference, served_.ids, edited->scene.objects.size());
  served_.choice = std::move(*edited);
  assets_.serve(served_.choice);
  if (!first && options_.tell) {
    options_.tell(served_.choice.scene_path + ": read again, nothing is different");
  }
}

/// The scene that is in the file now. Its assets are opened, and given by the indices of their
/// slots.
Result<ForceChoice> SceneKeeper::read_edited() {
  Result<ForceChoice> edited = choose_forces(options_.force);
  if (!edited) return edited;
  if (const char* part = fixed_part(served_.choice, *edited); part != nullptr) {
    return fail(ExitCode::unsupported,
                edited->scene_path + ": " + part +
                    " is another now, which a running daemon cannot take up; start it again, or "
                    "put back what it was");
  }
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < edited->assets.size(); ++i) {
    const Result<std::size_t> number = assets_.number_of(edited->assets[i]);
    if (!number) return at_place(place_of_asset(*edited, i), number.error());
    numbers.push_back(*number);
  }
  for (PlacedObject& object : edited->scene.objects) object.asset = numbers[object.asset];
  if (edited->scene.tool) edited->scene.tool->asset = numbers[edited->scene.tool->asset];
  for (ToolSettings& tool : edited->scene.more_tools) tool.asset = numbers[tool.asset];
  edited->assets = assets_.paths();
  if (auto checked = assets_.check(*edited); !checked) {
    return tl::make_unexpected(std::move(checked.error()));
  }
  return edited;
}

void SceneKeeper::offer(const SceneDifference& difference, ForceChoice edited) {
  const std::vector<PlacedObject>& objects = edited.scene.objects;
  next_.ids = edited_ids(difference, served_.ids, objects.size());
  edit_ = scene_edit(difference, served_.ids, objects, next_.ids);
  edit_.assets = edited.assets.size();
  if (edited.scene.stabilization != served_.choice.scene.stabilization) {
    edit_.stabilization = edited.scene.stabilization;
  }
  next_.choice = std::move(edited);
  change_ = in_words(edit_, difference, next_);
  // An asset that is loaded again from here on has to serve the edited scene.
  assets_.serve(next_.choice);
  offered_ = true;
  slot_.offer(edit_);
}

void SceneKeeper::finish(EditAnswer answer) {
  offered_ = false;
  if (answer == EditAnswer::no_room) {
    assets_.serve(served_.choice);
    return refuse(served_.choice.scene_path +
                  ": there is no room for so many objects beside those that applications added; "
                  "remove some, or start the daemon again");
  }
  served_ = std::move(next_);
  if (options_.tell) options_.tell(served_.choice.scene_path + ": taken up again: " + change_);
  if (options_.taken_up) options_.taken_up(served_);
}

void SceneKeeper::refuse(const std::string& message) {
  retry_wanted_ = true;
  next_try_ = steady_clock::now() + options_.retry;
  if (message == last_refusal_) return;
  last_refusal_ = message;
  if (options_.warn) options_.warn("not taken up, the scene stays as it was: " + message);
}

}  // namespace spm::servo
