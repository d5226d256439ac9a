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
#include <vector>

#include "servo/view/coroutine_end.hpp"
#include "servo/view/view_desk.hpp"
#include "servo/view/view_foxglove.hpp"
#include "servo/view/view_pages.hpp"
#include "servo/view/view_recordings.hpp"

namespace spm::servo {

/// What connections are answered from. All of it outlives them.
struct ViewContent {
  const std::map<std::string, PageFile>* page = nullptr;
  std::string token;
  unsigned port = 0;
  TellUser tell;                     ///< what ended by a defect
  std::vector<std::string> origins;  ///< of pages of others that may open the Foxglove WebSocket
  // Of a live view, or else null:
  ViewDesk* desk = nullptr;
  FoxgloveDesk* foxglove = nullptr;
  ViewRecordings* recordings = nullptr;  ///< of a view of recordings
};

/// Where the Foxglove WebSocket is, below the token.
inline constexpr const char* foxglove_path = "foxglove";

/// Answers one connection to its end: files of the page, meshes, recordings, the scene as TOML, and
/// both WebSockets. What has not the token, comes to a name of another host, or is opened by a page
/// of another origin gets 403; the Foxglove WebSocket, at which nothing can be changed, is also
/// there for programs that are no browser, and for the origins that were named.
boost::asio::awaitable<void> serve_connection(boost::asio::ip::tcp::socket socket,
                                              ViewContent content);

}  // namespace spm::servo
