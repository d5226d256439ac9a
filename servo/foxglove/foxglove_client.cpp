// SPDX-License-Identifier: Apache-2.0
#include "servo/foxglove/foxglove_client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/files/json_text.hpp"

namespace spm::servo {

using nlohmann::json;
using nlohmann::ordered_json;

namespace {

constexpr std::size_t most_subscriptions = 256;
constexpr char message_opcode = 1;
constexpr int status_warning = 1, status_error = 2;

std::string dumped(const ordered_json& message) {
  return message.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string status(int level, const std::string& text) {
  return dumped({{"op", "status"}, {"level", level}, {"message", text}});
}

template <class Number>
void append(std::string& bytes, Number number) {
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    bytes += static_cast<char>(static_cast<std::uint64_t>(number) >> (8 * i));
  }
}

/// A number of a message; 0 to 2^32 - 1. Nothing where it is none.
std::optional<std::uint32_t> number_of(const json& value) {
  if (!value.is_number_unsigned()) return {};
  const auto number = value.get<std::uint64_t>();
  if (number > std::numeric_limits<std::uint32_t>::max()) return {};
  return static_cast<std::uint32_t>(number);
}

}  // namespace

std::string_view chosen_protocol(std::string_view offered) {
  for (const std::string_view known : foxglove_protocols) {
    std::string_view rest = offered;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(','), rest.size());
      std::string_view name = rest.substr(0, end);
      rest.remove_prefix(std::min(end + 1, rest.size()));
      while (name.starts_with(' ')) name.remove_prefix(1);
      while (name.ends_with(' ')) name.remove_suffix(1);
      if (name == known) return known;
    }
  }
  return {};
}

std::string FoxgloveClient::greeting(const std::string& name, std::uint64_t session) {
  return dumped({{"op", "serverInfo"},
                 {"name", name},
                 {"capabilities", ordered_json::array()},
                 {"supportedEncodings", ordered_json::array({"json"})},
                 {"metadata", ordered_json::object()},
                 {"sessionId", std::to_string(session)}});
}

std::vector<std::string> FoxgloveClient::offer(const std::vector<FoxgloveChannel>& channels) {
  std::vector<std::string> texts;
  if (channels == channels_) return texts;
  ordered_json gone = {{"op", "unadvertise"}, {"channelIds", ordered_json::array()}};
  for (const FoxgloveChannel& channel : channels_) gone["channelIds"].push_back(channel.id);
  if (!channels_.empty()) texts.push_back(dumped(gone));
  channels_ = channels;
  subscriptions_.clear();
  ordered_json come = {{"op", "advertise"}, {"channels", ordered_json::array()}};
  for (const FoxgloveChannel& channel : channels_) {
    come["channels"].push_back({{"id", channel.id},
                                {"topic", channel.topic},
                                {"encoding", "json"},
                                {"schemaName", channel.schema_name},
                                {"schemaEncoding", "jsonschema"},
                                {"schema", channel.schema}});
  }
  if (!channels_.empty()) texts.push_back(dumped(come));
  return texts;
}

std::string FoxgloveClient::hear(const std::string& text) {
  const json message = parse_json<json>(text);
  const json op = message.is_object() ? message.value("op", json()) : json();
  if (op == "subscribe") {
    const json list = message.value("subscriptions", json::array());
    for (const json& wish : list) {
      const auto id = wish.is_object() ? number_of(wish.value("id", json())) : std::nullopt;
      const auto wanted =
          wish.is_object() ? number_of(wish.value("channelId", json())) : std::nullopt;
      if (!id || !wanted || channel(*wanted) == nullptr) {
        return status(status_error, "a subscription names no channel that is offered");
      }
      if (subscriptions_.size() >= most_subscriptions && !subscriptions_.contains(*id)) {
        return status(status_error, fmt::format("there are {} subscriptions already: end one first",
                                                most_subscriptions));
      }
      subscriptions_[*id] = *wanted;
    }
    return "";
  }
  if (op == "unsubscribe") {
    const json list = message.value("subscriptionIds", json::array());
    for (const json& wish : list) {
      if (const auto id = number_of(wish)) subscriptions_.erase(*id);
    }
    return "";
  }
  return status(status_warning, "this server offers channels to subscribe to, and nothing else");
}

const FoxgloveChannel* FoxgloveClient::channel(std::uint32_t id) const noexcept {
  const auto found = std::find_if(channels_.begin(), channels_.end(),
                                  [&](const FoxgloveChannel& one) { return one.id == id; });
  return found == channels_.end() ? nullptr : &*found;
}

std::string FoxgloveClient::message(std::uint32_t subscription, std::uint64_t time_ns,
                                    std::string_view payload) {
  std::string bytes(1, message_opcode);
  append(bytes, subscription);
  append(bytes, time_ns);
  bytes += payload;
  return bytes;
}

}  // namespace spm::servo
