// SPDX-License-Identifier: Apache-2.0
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <string>
#include <thread>
#include <utility>

#include "servo/client/spm_client.h"
#include "servo/shared/socket_messages.h"
#include "tests/servo/support/connected_client.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace client_connect_test {

using namespace spm::test;

namespace {

/// Something that is no daemon of ours, listening at a path: it sends every client the same bytes.
class Impostor {
 public:
  Impostor(const std::string& path, std::string says) : says_(std::move(says)) {
    listener_ = new_socket();
    const sockaddr_un address = address_of(path);
    REQUIRE(bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    REQUIRE(listen(listener_, 4) == 0);
    if (says_.empty()) return;
    thread_ = std::thread([this] {
      const int client = accept(listener_, nullptr, nullptr);
      static_cast<void>(send(client, says_.data(), says_.size(), MSG_NOSIGNAL));
      char byte = 0;
      static_cast<void>(recv(client, &byte, 1, 0));
      close(client);
    });
  }
  Impostor(const Impostor&) = delete;
  Impostor& operator=(const Impostor&) = delete;
  ~Impostor() {
    if (thread_.joinable()) thread_.join();
    close(listener_);
  }

 private:
  std::string says_;
  int listener_ = -1;
  std::thread thread_;
};

}  // namespace

TEST_CASE("Without a daemon the message names the state and the cure") {
  const SocketFolder folder;
  const std::string path = folder.path("a.sock");
  {
    const Connected none(path);
    REQUIRE(none.code == SPM_CLIENT_NO_DAEMON);
    REQUIRE(none.client == nullptr);
    REQUIRE(contains(none.message, "no daemon answers at " + path));
    REQUIRE(contains(none.message, "spm-servo run"));
  }
  { const Impostor left_behind(path, ""); }
  const Connected ended(path);
  REQUIRE(ended.code == SPM_CLIENT_NO_DAEMON);
  REQUIRE(contains(ended.message, "has ended"));
}

TEST_CASE("A daemon that does not answer is told from one that is not there") {
  const SocketFolder folder;
  const Impostor silent(folder.path("a.sock"), "");
  const Connected here(folder.path("a.sock"), 50);
  REQUIRE(here.code == SPM_CLIENT_NO_DAEMON);
  REQUIRE(contains(here.message, "did not answer within 50 ms"));
}

TEST_CASE("What is no daemon, or of another version, is told so in a sentence") {
  const SocketFolder folder;
  {
    const Impostor stranger(folder.path("a.sock"), "220 smtp ready");
    const Connected here(folder.path("a.sock"));
    REQUIRE(here.code == SPM_CLIENT_VERSION_DIFFERS);
    REQUIRE(contains(here.message, "is no spm-servo"));
  }
  spm_socket_answer answer{};
  answer.magic = SPM_SOCKET_MAGIC;
  answer.socket_version = SPM_SOCKET_VERSION;
  answer.layout_version = 99;
  const Impostor newer(folder.path("b.sock"),
                       std::string(reinterpret_cast<const char*>(&answer), sizeof answer));
  const Connected here(folder.path("b.sock"));
  REQUIRE(here.code == SPM_CLIENT_VERSION_DIFFERS);
  REQUIRE(contains(here.message, "layout 99"));
  REQUIRE(contains(here.message, "same version"));
}

TEST_CASE("A message is cut to its buffer, and wrong arguments are told") {
  const SocketFolder folder;
  const std::string path = folder.path("a.sock");
  auto options = sized<spm_client_options>();
  options.path = path.c_str();
  spm_client* client = nullptr;
  std::array<char, 10> message{};
  message.fill('x');
  REQUIRE(spm_client_connect(&options, &client, message.data(), 6) == SPM_CLIENT_NO_DAEMON);
  REQUIRE(std::string(message.data()) == "no da");
  REQUIRE(message[6] == 'x');
  REQUIRE(spm_client_connect(&options, &client, nullptr, 0) == SPM_CLIENT_NO_DAEMON);
  REQUIRE(spm_client_connect(&options, nullptr, nullptr, 0) == SPM_CLIENT_BAD_ARGUMENT);
  options.size = 3;
  REQUIRE(spm_client_connect(&options, &client, nullptr, 0) == SPM_CLIENT_BAD_ARGUMENT);
  options = sized<spm_client_options>();
  options.name = "no/name";
  REQUIRE(spm_client_connect(&options, &client, nullptr, 0) == SPM_CLIENT_BAD_ARGUMENT);
  spm_client_disconnect(nullptr);
  REQUIRE(spm_client_daemon_state(nullptr, nullptr) == SPM_CLIENT_GONE);
  auto device = sized<spm_client_device>();
  REQUIRE(spm_client_read_device(nullptr, 0, &device) == SPM_CLIENT_BAD_ARGUMENT);
}

}  // namespace client_connect_test
