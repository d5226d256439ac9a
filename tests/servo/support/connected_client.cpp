// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/support/connected_client.hpp"

#include <sys/socket.h>

#include <array>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <utility>

namespace spm::test {

using namespace servo;

spm_client_pose pose_at(double x) {
  auto pose = sized<spm_client_pose>();
  pose.position[0] = x;
  pose.orientation[0] = 1;
  return pose;
}

std::unique_ptr<AppServer> started(AppState& state, AppServerOptions options) {
  auto server = AppServer::start(std::move(options), state);
  if (!server) throw std::runtime_error(server.error().message);
  return std::move(*server);
}

std::unique_ptr<AppServer> started(AppState& state, const std::string& path) {
  AppServerOptions options;
  options.path = path;
  return started(state, std::move(options));
}

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return address;
}

int new_socket() { return socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0); }

Connected::Connected(const std::string& path, int timeout_ms, spm_client_role role) {
  auto options = sized<spm_client_options>();
  options.path = path.c_str();
  options.timeout_ms = timeout_ms;
  options.application = "test";
  options.role = role;
  std::array<char, 400> text{};
  code = spm_client_connect(&options, &client, text.data(), text.size());
  message = text.data();
}

Connected::~Connected() { spm_client_disconnect(client); }

bool Connected::commands_work() const {
  const spm_client_pose pose = pose_at(0);
  auto counts = sized<spm_client_command_counts>();
  if (spm_client_refusals(client, &counts) != SPM_CLIENT_OK) return false;
  const std::uint64_t before = counts.taken;
  if (spm_client_move_object(client, 0, &pose) != SPM_CLIENT_OK) return false;
  return eventually([&] {
    return spm_client_refusals(client, &counts) == SPM_CLIENT_OK && counts.taken > before;
  });
}

}  // namespace spm::test
