// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "common/base/error.hpp"
#include "servo/view/view_feed.hpp"

namespace spm::servo {

struct ViewSettings {
  std::string address = "127.0.0.1";  ///< in digits
  std::uint16_t port = 0;             ///< 0: any
  std::string page;                   ///< folder of the built page
  FeedSettings feed;
};

/// Serves the live page by HTTP, and what it shows and sends by WebSocket, until `stop` is set. It
/// has one thread, beside one that makes meshes. `started` gets the page's address, which has the
/// token in it, once the port is open. Errors: unsupported, where the page was not built;
/// file_or_device, where the port cannot be opened; usage, for an address that is none.
[[nodiscard]] Result<void> serve_view(const ViewSettings& settings, const std::atomic<bool>& stop,
                                      const std::function<void(const std::string&)>& started);

/// Whether an address reaches this machine alone.
[[nodiscard]] bool is_loopback(const std::string& address);

}  // namespace spm::servo
