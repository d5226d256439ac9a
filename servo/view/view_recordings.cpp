// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_recordings.hpp"

#include <charconv>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "servo/view/mesh_bytes.hpp"

namespace spm::servo {

using nlohmann::ordered_json;

namespace {

/// Takes a number from the front of a text, with the slash after it.
std::optional<std::size_t> take_number(std::string_view& text) {
  std::size_t number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (parsed.ec != std::errc{}) return {};
  text.remove_prefix(static_cast<std::size_t>(parsed.ptr - text.data()));
  if (text.starts_with('/')) text.remove_prefix(1);
  return number;
}

/// Takes a word from the front of a text.
bool take_word(std::string_view& text, std::string_view word) {
  if (!text.starts_with(word)) return false;
  text.remove_prefix(word.size());
  return true;
}

}  // namespace

Result<ViewRecordings> ViewRecordings::open(const std::vector<std::string>& paths) {
  ViewRecordings opened;
  for (const std::string& path : paths) {
    auto playback = Playback::open(path);
    if (!playback) return tl::make_unexpected(std::move(playback.error()));
    opened.recordings_.push_back(std::move(*playback));
  }
  return opened;
}

std::optional<PageFile> ViewRecordings::file(const std::string& path) {
  if (path == "recordings.json") {
    ordered_json list = ordered_json::array();
    for (const Playback& recording : recordings_) list.push_back(recording.summary());
    // Names of others may hold bytes that are no UTF-8.
    return PageFile{"application/json",
                    list.dump(-1, ' ', false, ordered_json::error_handler_t::replace)};
  }
  auto found = bytes(path);
  if (!found) return {};
  return PageFile{"application/octet-stream", std::move(*found)};
}

std::optional<std::string> ViewRecordings::bytes(const std::string& path) {
  std::string_view rest = path;
  if (!take_word(rest, "recording/")) return {};
  const auto number = take_number(rest);
  if (!number || *number >= recordings_.size()) return {};
  const Playback& recording = recordings_[*number];
  if (rest == "steps") return recording.steps();
  if (take_word(rest, "rows/")) {
    const auto device = take_number(rest);
    if (!device || !rest.empty() || *device >= recording.devices()) return {};
    return recording.rows(*device);
  }
  if (take_word(rest, "mesh/")) {
    const auto asset = take_number(rest);
    if (!asset || !rest.empty()) return {};
    return mesh(*number, *asset);
  }
  return {};
}

std::optional<std::string> ViewRecordings::mesh(std::size_t recording, std::size_t asset) {
  const std::vector<PlayedAsset>& assets = recordings_[recording].assets();
  if (asset >= assets.size() || assets[asset].asset == nullptr) return {};
  const auto made = meshes_.find({recording, asset});
  if (made != meshes_.end()) return made->second;
  std::string bytes = to_bytes(contour_mesh(assets[asset].asset->view(), picture_cells));
  meshes_[{recording, asset}] = bytes;
  return bytes;
}

}  // namespace spm::servo
