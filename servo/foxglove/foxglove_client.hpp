// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "servo/foxglove/foxglove_channels.hpp"

namespace spm::servo {

/// The subprotocols of a WebSocket that are spoken, by their names in the handshake. What is spoken
/// here is the same in both.
inline constexpr std::string_view foxglove_protocols[] = {"foxglove.sdk.v1",
                                                          "foxglove.websocket.v1"};

/// The one to answer a client with that names some (the header Sec-WebSocket-Protocol); empty where
/// it names none of them.
[[nodiscard]] std::string_view chosen_protocol(std::string_view offered);

/// The server's side of the Foxglove WebSocket protocol, for one client: channels that it may
/// subscribe to, nothing that it may change. It knows texts and bytes, no socket.
class FoxgloveClient {
 public:
  /// What is sent first: who serves.
  [[nodiscard]] static std::string greeting(const std::string& name, std::uint64_t session);

  /// Offers channels in the place of those before. What is to be sent for it: nothing where they
  /// are the same.
  [[nodiscard]] std::vector<std::string> offer(const std::vector<FoxgloveChannel>& channels);

  /// Follows a client's text. What is to be answered; empty where nothing is wrong.
  [[nodiscard]] std::string hear(const std::string& text);

  /// The channels that it subscribed to, by the client's own numbers of its subscriptions.
  [[nodiscard]] const std::map<std::uint32_t, std::uint32_t>& subscriptions() const noexcept {
    return subscriptions_;
  }
  [[nodiscard]] const FoxgloveChannel* channel(std::uint32_t id) const noexcept;

  /// A message for a subscription, as it is sent.
  [[nodiscard]] static std::string message(std::uint32_t subscription, std::uint64_t time_ns,
                                           std::string_view payload);

 private:
  std::vector<FoxgloveChannel> channels_;
  std::map<std::uint32_t, std::uint32_t> subscriptions_;
};

}  // namespace spm::servo
