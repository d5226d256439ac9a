// SPDX-License-Identifier: Apache-2.0
#include "servo/client/spm_client.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <exception>
#include <memory>
#include <string>

#include "servo/base/clock.hpp"
#include "servo/client/client.hpp"
#include "servo/client/last_error.hpp"
#include "servo/client/state_reader.hpp"
#include "servo/shared/fixed_text.hpp"
#include "servo/shared/refusal.hpp"
#include "servo/shared/socket_path.hpp"

namespace {

using namespace spm::servo;

constexpr int default_timeout_ms = 1000;
/// For finding a daemon again: one that is there answers within a millisecond.
constexpr std::chrono::milliseconds find_timeout{50};
/// A daemon is not looked for again sooner.
constexpr std::int64_t find_every_ns = 20'000'000;
/// The loop counts as stalled after this time without a tick: a hundred ticks, which is longer than
/// any process is kept from its processor on a machine that is fit for a servo.
constexpr double stalled_ns = 1e8;

void give_message(char* message, size_t size, const std::string& text) noexcept {
  if (message == nullptr || size == 0) return;
  const size_t count = std::min(size - 1, text.size());
  std::memcpy(message, text.data(), count);
  message[count] = '\0';
}

/// Copies a name of the daemon's. `find(info)` returns it, or null.
template <class Find>
int give_name(const spm_client* client, char* name, std::size_t size, const Find& find) noexcept {
  if (client == nullptr || name == nullptr || size == 0) return SPM_CLIENT_BAD_ARGUMENT;
  name[0] = '\0';
  char text[SPM_NAME_BYTES] = {};
  bool found = false;
  const bool read = read_info(client->connection().state(), [&](const spm_shared_info& info) {
    const char* const from = find(info);
    found = from != nullptr;
    if (found) load_words(text, from, sizeof text);
  });
  if (!read) return SPM_CLIENT_BUSY;
  if (!found) return SPM_CLIENT_NOT_THERE;
  give_message(name, size, std::string(text, strnlen(text, sizeof text - 1)));
  return SPM_CLIENT_OK;
}

template <std::size_t Most>
const char* name_at(const char (&names)[Most][SPM_NAME_BYTES], std::uint32_t count,
                    std::uint64_t index) noexcept {
  return index < std::min<std::uint64_t>(count, Most) ? names[index] : nullptr;
}

void keep_causes(spm_client& client) {
  static_cast<void>(read_info(client.connection().state(), [&](const spm_shared_info& info) {
    client.cause_count = std::min<std::uint32_t>(load_relaxed(info.cause_count), SPM_MAX_CAUSES);
    load_words(client.causes.data(), info.causes, sizeof info.causes);
  }));
  for (spm_shared_cause& cause : client.causes) {
    cause.name[SPM_NAME_BYTES - 1] = '\0';
    cause.cure[SPM_CURE_BYTES - 1] = '\0';
  }
}

/// What a caller of this version or of the first one asks for. False if the size is that of none.
bool read_options(const spm_client_options* options, spm_client_options& known) noexcept {
  if (options == nullptr) return true;
  if (options->size < offsetof(spm_client_options, role)) return false;
  std::memcpy(&known, options, std::min<std::size_t>(options->size, sizeof known));
  return true;
}

int connect(const spm_client_options& options, spm_client** client, char* message,
            size_t message_size) {
  const std::string name(options.name != nullptr ? options.name : usual_daemon_name());
  if (options.path == nullptr && !valid_daemon_name(name)) {
    give_message(message, message_size,
                 "'" + name +
                     "' is no name of a daemon: take 1 to 32 letters, digits, '-', '_' "
                     "and '.', the first a letter or digit");
    return SPM_CLIENT_BAD_ARGUMENT;
  }
  ConnectionRequest request;
  request.path = options.path != nullptr ? options.path : socket_path(name);
  request.application = options.application != nullptr ? options.application : "";
  request.role = options.role;
  request.server_user = options.server_user;
  request.timeout =
      std::chrono::milliseconds(options.timeout_ms > 0 ? options.timeout_ms : default_timeout_ms);
  if (options.path == nullptr && request.path.empty()) {
    give_message(message, message_size,
                 std::string(no_socket_folder) + ", or name the daemon's socket by its path");
    return SPM_CLIENT_NO_DAEMON;
  }
  auto opened = Connection::open(request);
  if (!opened) {
    give_message(message, message_size, opened.error().sentence);
    return opened.error().code;
  }
  // A daemon that hangs while it is found again may not hold a frame of the application up for
  // long.
  request.timeout = std::min(request.timeout, find_timeout);
  auto made = std::make_unique<spm_client>(std::move(*opened), request, options.reconnect != 0);
  keep_causes(*made);
  *client = made.release();
  return SPM_CLIENT_OK;
}

/// Connects again where the daemon is gone. The calling thread must hold the client's mutex.
int find(spm_client& client) {
  if (!is_gone(client.connection())) return SPM_CLIENT_OK;
  client.tried_ns = now_ns();
  auto opened = Connection::open(client.request);
  if (!opened) return failed(opened.error().code, opened.error().sentence.c_str());
  // The numbers of commands and objects are of a connection.
  client.head = 0;
  client.objects_added = 0;
  client.events = {};
  client.found = true;
  client.take(std::move(*opened));
  return SPM_CLIENT_OK;
}

}  // namespace

namespace spm::servo {

int find_again(const spm_client& client) noexcept {
  if (!client.reconnects) return failed(SPM_CLIENT_NO_DAEMON);
  // What is exchanged is guarded, and readers only see a connection whole.
  auto& changed = const_cast<spm_client&>(client);
  try {
    const std::unique_lock lock(changed.mutex, std::try_to_lock);
    if (!lock.owns_lock() || now_ns() - changed.tried_ns < find_every_ns) {
      return failed(SPM_CLIENT_NO_DAEMON);
    }
    return find(changed) == SPM_CLIENT_OK ? SPM_CLIENT_OK : SPM_CLIENT_NO_DAEMON;
  } catch (const std::exception&) {
    return failed(SPM_CLIENT_INTERNAL);
  }
}

}  // namespace spm::servo

int spm_client_reconnect(spm_client* client) {
  if (client == nullptr) return failed(SPM_CLIENT_BAD_ARGUMENT);
  try {
    const std::lock_guard lock(client->mutex);
    return find(*client);
  } catch (const std::exception&) {
    return failed(SPM_CLIENT_INTERNAL);
  }
}

int spm_client_connect(const spm_client_options* options, spm_client** client, char* message,
                       size_t message_size) {
  give_message(message, message_size, "");
  spm_client_options known{};
  const bool asked = client != nullptr && read_options(options, known);
  if (!asked || known.role > SPM_CLIENT_OBSERVER) {
    give_message(message, message_size,
                 "spm_client_connect was called wrongly: give it a place for the client, and "
                 "options with their size and a role that there is");
    return SPM_CLIENT_BAD_ARGUMENT;
  }
  *client = nullptr;
  try {
    return connect(known, client, message, message_size);
  } catch (const std::exception&) {
    give_message(message, message_size, "no memory is left to connect: close other programs");
  } catch (...) {
    give_message(message, message_size, "an unknown failure: report it as a bug");
  }
  return SPM_CLIENT_INTERNAL;
}

void spm_client_disconnect(spm_client* client) { delete client; }

int spm_client_daemon_state(const spm_client* client, double* age) {
  if (age != nullptr) *age = -1;
  if (client == nullptr) return SPM_CLIENT_GONE;
  const spm_shared_state& state = look(*client);
  const bool ticked = load_acquire(state.published) > 0;
  // In doubles, since a daemon that is broken may have written any beat, also one yet to come.
  const double since =
      static_cast<double>(now_ns()) - static_cast<double>(load_relaxed(state.heartbeat_ns));
  if (ticked && age != nullptr) *age = std::max(0.0, since) * 1e-9;
  if (load_acquire(state.ended) != 0) return SPM_CLIENT_ENDED;
  if (!client->connection().daemon_is_there()) return SPM_CLIENT_GONE;
  return ticked && std::abs(since) < stalled_ns ? SPM_CLIENT_RUNNING : SPM_CLIENT_STALLED;
}

int spm_client_read_info(const spm_client* client, spm_client_info* info) {
  if (client == nullptr || info == nullptr) return SPM_CLIENT_BAD_ARGUMENT;
  const spm_shared_state& state = client->connection().state();
  spm_client_info found{};
  const bool read = read_info(state, [&](const spm_shared_info& from) {
    found.device_count = load_relaxed(from.device_count);
    found.asset_count = load_relaxed(from.asset_count);
    found.object_count = load_relaxed(from.object_count);
  });
  if (!read) return SPM_CLIENT_BUSY;
  found.cause_count = client->cause_count;
  found.process = state.process;
  found.rate_hz = state.rate_hz;
  copy_text(found.daemon_version,
            {state.daemon_version, strnlen(state.daemon_version, sizeof state.daemon_version)});
  copy_text(found.library_version, SPM_VERSION);
  return give(info, found);
}

int spm_client_device_name(const spm_client* client, uint32_t device, char* name, size_t size) {
  return give_name(client, name, size, [&](const spm_shared_info& info) {
    return name_at(info.devices, load_relaxed(info.device_count), device);
  });
}

int spm_client_asset_name(const spm_client* client, uint32_t asset, char* name, size_t size) {
  return give_name(client, name, size, [&](const spm_shared_info& info) {
    return name_at(info.assets, load_relaxed(info.asset_count), asset);
  });
}

int spm_client_object_name(const spm_client* client, uint64_t object, char* name, size_t size) {
  return give_name(client, name, size, [&](const spm_shared_info& info) {
    return name_at(info.objects, load_relaxed(info.object_count), object);
  });
}

int spm_client_cause(const spm_client* client, uint32_t cause, const char** name,
                     const char** cure) {
  if (client == nullptr || name == nullptr || cure == nullptr) return SPM_CLIENT_BAD_ARGUMENT;
  const bool known = cause < client->cause_count;
  *name = known ? client->causes[cause].name : "";
  *cure = known ? client->causes[cause].cure : "";
  return known ? SPM_CLIENT_OK : SPM_CLIENT_NOT_THERE;
}

const char* spm_client_refusal(uint32_t refusal) {
  // A newer daemon may have further reasons, which also get a sentence.
  return to_sentence(static_cast<Refusal>(std::min<uint32_t>(refusal, 255)));
}

int spm_client_next_event(spm_client* client, spm_client_event* event) {
  if (client == nullptr || event == nullptr || event->size < sizeof *event) {
    return SPM_CLIENT_BAD_ARGUMENT;
  }
  const int code = there(*client);
  const std::lock_guard lock(client->mutex);
  const auto told = [&](std::uint32_t kind) {
    spm_client_event made{};
    made.kind = kind;
    return give(event, made);
  };
  if (std::exchange(client->found, false)) {
    client->loss_told = false;
    return told(SPM_CLIENT_DAEMON_FOUND);
  }
  if (code != SPM_CLIENT_OK) {
    return std::exchange(client->loss_told, true) ? code : told(SPM_CLIENT_DAEMON_LOST);
  }
  if (client->events.empty()) {
    std::array<spm_shared_device, SPM_MAX_DEVICES> devices;
    std::uint64_t tick = 0;
    std::uint32_t count = 0;
    const ReadResult result = read_newest(look(*client), [&](const auto& snapshot) {
      tick = load_relaxed(snapshot.tick);
      count = device_count(snapshot);
      load_words(devices.data(), snapshot.devices, count * sizeof(spm_shared_device));
      return true;
    });
    if (result != ReadResult::fine) return code_of(result);
    client->events.look(tick, devices, count);
    if (client->events.empty()) return SPM_CLIENT_NOT_THERE;
  }
  return give(event, client->events.take());
}
