// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_feed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <utility>

#include "formats/asset/mapped_asset.hpp"
#include "servo/view/mesh_bytes.hpp"

namespace spm::servo {

namespace {

constexpr std::chrono::milliseconds reconnect_interval{500};
constexpr std::chrono::milliseconds names_interval{250};
constexpr int connect_timeout_ms = 300;
/// How many reasons of refusal there can be.
constexpr std::size_t message_bytes = 512;

template <class Record>
Record sized() noexcept {
  Record record{};
  record.size = sizeof record;
  return record;
}

/// A text of the library, which `read(text, size)` copies.
template <std::size_t Bytes, class Read>
std::string text_of(const Read& read) {
  std::array<char, Bytes> text{};
  return read(text.data(), text.size()) == SPM_CLIENT_OK ? std::string(text.data()) : std::string();
}

/// Tells a file from one that was written in its place.
std::string stamp_of(const std::string& path) {
  std::error_code unknown;
  const auto time = std::filesystem::last_write_time(path, unknown);
  if (unknown) return "none";
  const auto size = std::filesystem::file_size(path, unknown);
  return fmt::format("{} {}", time.time_since_epoch().count(), size);
}

}  // namespace

ViewFeed::ViewFeed(FeedSettings settings) : settings_(std::move(settings)) {}

ViewFeed::~ViewFeed() = default;

void ViewFeed::connect() {
  const auto now = Clock::now();
  if (now < connect_again_) return;
  connect_again_ = now + reconnect_interval;
  auto options = sized<spm_client_options>();
  options.path = settings_.socket.empty() ? nullptr : settings_.socket.c_str();
  options.name = settings_.name.empty() ? nullptr : settings_.name.c_str();
  options.application = "spm-servo view";
  options.server_user = settings_.server_user;
  options.timeout_ms = connect_timeout_ms;
  std::array<char, message_bytes> message{};
  spm_client* client = nullptr;
  // What a supervisor changes does not become its own, so that other applications keep theirs.
  for (const std::uint32_t role : {SPM_CLIENT_SUPERVISOR, SPM_CLIENT_APPLICATION}) {
    options.role = role;
    const int code = spm_client_connect(&options, &client, message.data(), message.size());
    if (code != SPM_CLIENT_REFUSED) break;
  }
  state_.message = message.data();
  client_.reset(client);
  if (!client_) return;
  state_ = {};
  state_.daemon = SPM_CLIENT_STALLED;
  before_ = {};
  refused_ = 0;
  names_again_ = {};
}

void ViewFeed::drop(int daemon) {
  client_.reset();
  state_.daemon = daemon;
  state_.message = daemon == SPM_CLIENT_ENDED ? "the daemon ended: start it again to go on"
                                              : "the daemon hung up without a word: it crashed or "
                                                "was killed; start it again to go on";
  state_.applications.clear();
  connect_again_ = Clock::now() + reconnect_interval;
}

void ViewFeed::look() {
  if (!client_) connect();
  if (client_) {
    state_.daemon = spm_client_daemon_state(client_.get(), &state_.age);
    if (state_.daemon == SPM_CLIENT_ENDED || state_.daemon == SPM_CLIENT_GONE) drop(state_.daemon);
  }
  if (client_) {
    read_tick();
    const auto now = Clock::now();
    if (now >= names_again_) {
      names_again_ = now + names_interval;
      read_names();
      read_feels();
      load_meshes();
    }
  }
  frame_ = frame_of(state_, before_);
  before_ = state_.loop;
  tell_scene();
}

void ViewFeed::read_names() {
  const spm_client* const client = client_.get();
  auto info = sized<spm_client_info>();
  if (spm_client_read_info(client, &info) == SPM_CLIENT_OK) state_.info = info;
  state_.devices.resize(info.device_count);
  for (std::uint32_t i = 0; i < info.device_count; ++i) {
    ViewDevice& device = state_.devices[i];
    device.name = text_of<SPM_CLIENT_NAME_BYTES>(
        [&](char* to, std::size_t size) { return spm_client_device_name(client, i, to, size); });
    static_cast<void>(spm_client_border(client, i, &device.bare_border, &device.stabilized_border));
  }
  state_.assets.resize(info.asset_count);
  for (std::uint32_t i = 0; i < info.asset_count; ++i) {
    state_.assets[i].name = text_of<SPM_CLIENT_NAME_BYTES>(
        [&](char* to, std::size_t size) { return spm_client_asset_name(client, i, to, size); });
    state_.assets[i].path = text_of<message_bytes>(
        [&](char* to, std::size_t size) { return spm_client_asset_path(client, i, to, size); });
  }
  state_.causes.clear();
  for (std::uint32_t i = 0; i < info.cause_count; ++i) {
    const char *name = "", *cure = "";
    static_cast<void>(spm_client_cause(client, i, &name, &cure));
    state_.causes.push_back({name, cure});
  }
  state_.applications.clear();
  auto application = sized<spm_client_application>();
  for (std::uint32_t i = 0; spm_client_read_application(client, i, &application) == SPM_CLIENT_OK;
       ++i) {
    state_.applications.push_back(application);
  }
}

void ViewFeed::read_tick() {
  const spm_client* const client = client_.get();
  auto tick = sized<spm_client_tick>();
  std::array<spm_client_device, 8> devices{};
  std::array<spm_client_object, 64> objects{};
  devices[0].size = sizeof devices[0];
  objects[0].size = sizeof objects[0];
  if (spm_client_read_all(client, &tick, devices.data(), devices.size(), objects.data(),
                          objects.size()) != SPM_CLIENT_OK) {
    return;
  }
  state_.tick = tick;
  auto loop = sized<spm_client_loop>();
  if (spm_client_read_loop(client, &loop) == SPM_CLIENT_OK) state_.loop = loop;
  state_.devices.resize(std::min<std::size_t>(tick.device_count, devices.size()));
  state_.contacts.clear();
  for (std::uint32_t i = 0; i < state_.devices.size(); ++i) {
    state_.devices[i].state = devices[i];
    auto counts = sized<spm_client_device_counts>();
    if (spm_client_read_device_counts(client, i, &counts) == SPM_CLIENT_OK) {
      state_.devices[i].counts = counts;
    }
    std::array<spm_client_contact, SPM_CLIENT_MAX_CONTACTS> contacts{};
    contacts[0].size = sizeof contacts[0];
    std::size_t count = 0;
    static_cast<void>(
        spm_client_read_contacts(client, i, nullptr, contacts.data(), contacts.size(), &count));
    state_.contacts.insert(state_.contacts.end(), contacts.begin(),
                           contacts.begin() + static_cast<std::ptrdiff_t>(count));
  }
  state_.objects.resize(std::min<std::size_t>(tick.object_count, objects.size()));
  for (std::size_t i = 0; i < state_.objects.size(); ++i) {
    if (state_.objects[i].state.id != objects[i].id) names_again_ = {};
    state_.objects[i].state = objects[i];
  }
}

void ViewFeed::read_feels() {
  for (ViewObject& object : state_.objects) {
    auto feel = sized<spm_client_feel>();
    if (spm_client_read_feel(client_.get(), object.state.id, &feel) == SPM_CLIENT_OK) {
      object.feel = feel;
    }
    object.name = text_of<SPM_CLIENT_NAME_BYTES>([&](char* to, std::size_t size) {
      return spm_client_object_name(client_.get(), object.state.id, to, size);
    });
  }
}

ViewFeed::Mesh ViewFeed::load(const std::string& path, const std::string& stamp) {
  Mesh mesh;
  mesh.path = path;
  mesh.stamp = stamp;
  try {
    const auto asset = MappedAsset::open(path);
    if (!asset) {
      mesh.error = asset.error().message;
      return mesh;
    }
    const ContourMesh surface = contour_mesh((*asset)->view(), picture_cells);
    mesh.bytes = std::make_shared<const std::string>(to_bytes(surface));
    mesh.cell = surface.cell;
    mesh.triangles = surface.triangles.size() / 3;
  } catch (const std::exception& problem) {
    // Else it would end the view, which only shows the object.
    mesh.error = path + ": cannot be drawn (" + problem.what() + "); close other programs";
  }
  return mesh;
}

/// One after the other, in a thread of its own, so that frames go on.
void ViewFeed::load_meshes() {
  if (loading_.valid() && loading_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    Mesh made = loading_.get();
    made.number = ++meshes_made_;
    std::erase_if(meshes_, [&](const Mesh& mesh) { return mesh.path == made.path; });
    meshes_.push_back(std::move(made));
  }
  for (ViewAsset& asset : state_.assets) {
    const auto found = std::find_if(meshes_.begin(), meshes_.end(),
                                    [&](const Mesh& mesh) { return mesh.path == asset.path; });
    const std::string stamp = asset.path.empty() ? "" : stamp_of(asset.path);
    if (found == meshes_.end() || found->stamp != stamp) {
      if (!asset.path.empty() && !loading_.valid()) {
        loading_ = std::async(std::launch::async, load, asset.path, stamp);
      }
    }
    if (found == meshes_.end()) {
      asset.mesh = asset.path.empty() ? MeshState::failed : MeshState::loading;
      asset.error = asset.path.empty() ? "the path of this asset is too long to be told" : "";
      continue;
    }
    asset.mesh = found->bytes ? MeshState::ready : MeshState::failed;
    asset.error = found->error;
    asset.number = found->number;
    asset.cell = found->cell;
    asset.triangles = found->triangles;
  }
}

std::shared_ptr<const std::string> ViewFeed::mesh(std::size_t asset) const noexcept {
  if (asset >= state_.assets.size()) return nullptr;
  for (const Mesh& mesh : meshes_) {
    if (mesh.path == state_.assets[asset].path) return mesh.bytes;
  }
  return nullptr;
}

void ViewFeed::tell_scene() {
  std::string text = scene_json(state_);
  if (text == scene_) return;
  scene_ = std::move(text);
  ++scene_number_;
}

std::string ViewFeed::sent(int code) const {
  switch (code) {
    case SPM_CLIENT_OK:
      return "";
    case SPM_CLIENT_RING_FULL:
      return "the daemon has not come to earlier commands yet: try again";
    case SPM_CLIENT_BAD_ARGUMENT:
      return "a number is out of the range that the daemon takes";
    default:
      return "there is no daemon that could follow: start it again";
  }
}

std::string ViewFeed::lead(std::uint32_t device, const HandPose& hand) {
  if (!client_) return sent(SPM_CLIENT_NO_DAEMON);
  auto wanted = sized<spm_client_hand>();
  for (int axis = 0; axis < 3; ++axis) wanted.position[axis] = hand.position[axis];
  wanted.orientation[0] = hand.orientation.w();
  wanted.orientation[1] = hand.orientation.x();
  wanted.orientation[2] = hand.orientation.y();
  wanted.orientation[3] = hand.orientation.z();
  wanted.hold = std::chrono::duration<double>(hand_hold).count();
  return sent(spm_client_lead_hand(client_.get(), device, &wanted));
}

std::string ViewFeed::let_go(std::uint32_t device) {
  if (!client_) return "";
  return sent(spm_client_lead_hand(client_.get(), device, nullptr));
}

std::string ViewFeed::feel(std::uint64_t object, const WishedFeel& wished) {
  if (!client_) return sent(SPM_CLIENT_NO_DAEMON);
  auto material = sized<spm_client_material>();
  if (wished.stiffness) {
    material.fields |= SPM_CLIENT_STIFFNESS;
    material.stiffness = *wished.stiffness;
  }
  if (wished.friction) {
    material.fields |= SPM_CLIENT_FRICTION;
    material.friction_stick = (*wished.friction)[0];
    material.friction_slide = (*wished.friction)[1];
  }
  if (wished.damping) {
    material.fields |= SPM_CLIENT_DAMPING;
    material.damping = *wished.damping;
  }
  if (wished.texture) {
    material.fields |= SPM_CLIENT_TEXTURE;
    material.texture_amplitude = (*wished.texture)[0];
    material.texture_wavelength = (*wished.texture)[1];
  }
  names_again_ = {};
  return sent(spm_client_set_material(client_.get(), object, &material));
}

std::string ViewFeed::choose_method(std::uint64_t object, std::uint32_t method) {
  if (!client_) return sent(SPM_CLIENT_NO_DAEMON);
  names_again_ = {};
  return sent(spm_client_set_method(client_.get(), object, method));
}

std::string ViewFeed::stabilize(bool on) {
  if (!client_) return sent(SPM_CLIENT_NO_DAEMON);
  names_again_ = {};
  return sent(spm_client_stabilize(client_.get(), on ? 1 : 0));
}

std::string ViewFeed::cap(std::uint32_t device, double newtons) {
  if (!client_) return sent(SPM_CLIENT_NO_DAEMON);
  return sent(spm_client_set_force_cap(client_.get(), device, newtons));
}

std::string ViewFeed::acknowledge(std::uint32_t device) {
  if (!client_) return sent(SPM_CLIENT_NO_DAEMON);
  return sent(spm_client_acknowledge(client_.get(), device));
}

std::string ViewFeed::refusal() {
  if (!client_) return "";
  auto counts = sized<spm_client_command_counts>();
  if (spm_client_refusals(client_.get(), &counts) != SPM_CLIENT_OK) return "";
  if (std::exchange(refused_, counts.refused) >= counts.refused) return "";
  return spm_client_refusal(counts.last_refusal);
}

}  // namespace spm::servo
