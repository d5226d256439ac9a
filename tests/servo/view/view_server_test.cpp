// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <future>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "tests/servo/support/shape_asset.hpp"

namespace view_server_test {

using namespace spm;
using namespace spm::servo;

namespace {

boost::asio::awaitable<void> failing() {
  throw std::runtime_error("a grid without cells");
  co_return;
}

/// Sentences of another thread.
class Told {
 public:
  void add(const std::string& sentence) {
    const std::lock_guard lock(mutex_);
    sentences_ += sentence;
  }
  [[nodiscard]] std::string all() {
    const std::lock_guard lock(mutex_);
    return sentences_;
  }

 private:
  std::mutex mutex_;
  std::string sentences_;
};

/// All handles that the process may have, but one.
class NoHandles {
 public:
  NoHandles() {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit few{256, before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &few);
    for (int handle = 0; (handle = ::open("/dev/null", O_RDONLY)) >= 0;) taken_.push_back(handle);
    ::close(taken_.back());
    taken_.pop_back();
  }
  NoHandles(const NoHandles&) = delete;
  NoHandles& operator=(const NoHandles&) = delete;
  ~NoHandles() {
    for (const int handle : taken_) ::close(handle);
    ::setrlimit(RLIMIT_NOFILE, &before_);
  }

 private:
  rlimit before_{};
  std::vector<int> taken_;
};

int connected_to(std::uint16_t port) {
  const int handle = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(port);
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(handle >= 0);
  REQUIRE(::connect(handle, reinterpret_cast<sockaddr*>(&place), sizeof place) == 0);
  return handle;
}

}  // namespace

TEST_CASE("An exception that ends a connection's coroutine is told, and the others go on") {
  boost::asio::io_context context(1);
  std::string told;
  const EndTold end{[&told](const std::string& sentence) { told += sentence; }};
  boost::asio::co_spawn(context, failing(), end);
  CHECK_NOTHROW(context.run());
  CHECK(told ==
        "a connection of the view ended by a defect (a grid without cells): open the page again, "
        "and report it as a bug");
  end(nullptr);
  CHECK(told.size() < 200);
}

TEST_CASE("An exception that ends a coroutine without which there is no view ends the view") {
  boost::asio::io_context context(1);
  boost::asio::co_spawn(context, failing(), EndsView{});
  CHECK_THROWS_WITH(context.run(), "a grid without cells");
}

TEST_CASE("A view that runs out of handles says so, and answers once one is free") {
  const spm::test::TemporaryFolder folder;
  for (const char* name : {"index.html", "view.js", "view.css", "icon.svg"}) {
    std::ofstream(folder.file(name)) << "page";
  }
  Told told;
  ViewSettings settings;
  settings.page = folder.file("");
  settings.feed.socket = folder.file("none.sock");
  settings.tell = [&told](const std::string& sentence) { told.add(sentence); };
  std::atomic<bool> stop{false};
  std::promise<std::string> address;
  std::thread server([&] {
    const auto served = serve_view(
        settings, stop, [&](const ViewAddresses& addresses) { address.set_value(addresses.page); });
    CHECK(served.has_value());
  });
  const std::string url = address.get_future().get();
  const std::string host = url.substr(7, url.find('/', 7) - 7), path = url.substr(7 + host.size());
  const auto port = static_cast<std::uint16_t>(std::stoi(host.substr(host.find(':') + 1)));
  int page = -1;
  {
    const NoHandles none;
    page = connected_to(port);
    while (told.all().empty()) std::this_thread::yield();
  }
  CHECK_THAT(told.all(), Catch::Contains("has no handle left for another page"));
  const std::string request = "GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n";
  REQUIRE(::send(page, request.data(), request.size(), 0) == static_cast<ssize_t>(request.size()));
  std::array<char, 64> answer{};
  REQUIRE(::recv(page, answer.data(), answer.size() - 1, 0) > 0);
  CHECK_THAT(answer.data(), Catch::StartsWith("HTTP/1.1 200"));
  ::close(page);
  stop = true;
  server.join();
}

}  // namespace view_server_test
