// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "servo/view/coroutine_end.hpp"
#include "servo/view/view_feed.hpp"

namespace spm::servo {

struct ViewSettings {
  std::string address = "127.0.0.1";    ///< in digits
  std::uint16_t port = 0;               ///< 0: any
  std::string page;                     ///< folder of the built page
  FeedSettings feed;                    ///< the daemon that is watched; unused with recordings
  std::vector<std::string> recordings;  ///< files that are played instead: one, or two to compare
  TellUser tell = [](const std::string&) {};  ///< gets warnings, at most one in 10 s
  /// Origins of pages of others, such as https://app.foxglove.dev, that may watch by the Foxglove
  /// protocol with the token.
  std::vector<std::string> origins;
};

/// Where it is served; both have the token in them.
struct ViewAddresses {
  std::string page;      ///< http://...
  std::string foxglove;  ///< ws://..., for Foxglove viewers; empty with recordings
};

/// Serves the page by HTTP, and what the live one shows and sends by WebSocket, until `stop` is
/// set. It has one thread, beside one that makes meshes. `started` gets the addresses once the port
/// is open. Where handles run out it says so, and goes on when some are free again. Errors:
/// unsupported, where the page was not built; file_or_device, where the port
/// cannot be opened; usage, for an address that is none; those of ViewRecordings::open().
[[nodiscard]] Result<void> serve_view(const ViewSettings& settings, const std::atomic<bool>& stop,
                                      const std::function<void(const ViewAddresses&)>& started);

/// Whether an address reaches this machine alone.
[[nodiscard]] bool is_loopback(const std::string& address);

}  // namespace spm::servo
