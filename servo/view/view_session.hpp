// SPDX-License-Identifier: Apache-2.0
#pragma once

// Boost's coroutines use <utility> without naming it.
// clang-format off
#include <utility>
#include <boost/asio/awaitable.hpp>
// clang-format on
#include <boost/asio/ip/tcp.hpp>
#include <map>
#include <string>

#include "servo/view/view_desk.hpp"
#include "servo/view/view_pages.hpp"

namespace spm::servo {

/// What connections are answered from. All of it outlives them.
struct ViewContent {
  const std::map<std::string, PageFile>* page = nullptr;
  std::string token;
  unsigned port = 0;
  ViewDesk* desk = nullptr;
};

/// Answers one connection to its end: files of the page, meshes, the scene as TOML, and the
/// WebSocket. What has not the token, comes to a name of another host, or is opened by a page of
/// another origin gets 403.
boost::asio::awaitable<void> serve_connection(boost::asio::ip::tcp::socket socket,
                                              ViewContent content);

}  // namespace spm::servo
