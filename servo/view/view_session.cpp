// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_session.hpp"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <charconv>
#include <chrono>
#include <memory>
#include <optional>

#include "servo/view/view_access.hpp"

namespace spm::servo {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;

namespace {

constexpr std::size_t longest_message = 4096;     // bytes, of a page
constexpr std::uint32_t longest_header = 8192;    // bytes
constexpr std::chrono::seconds request_time{20};  // a connection that asks nothing is closed

/// The page may load and reach nothing but this server; no page may frame it.
constexpr const char* content_policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' "
    "data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

Response answer(const Request& request, http::status status, const std::string& type,
                std::string body) {
  Response response(status, request.version());
  response.set(http::field::content_type, type);
  response.set(http::field::cache_control, "no-store");
  response.set("Content-Security-Policy", content_policy);
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.keep_alive(request.keep_alive());
  response.body() = std::move(body);
  response.prepare_payload();
  return response;
}

Response refuse(const Request& request, http::status status, std::string why) {
  Response response = answer(request, status, "text/plain; charset=utf-8", std::move(why) + "\n");
  response.keep_alive(false);
  return response;
}

std::string text_of(boost::string_view text) { return {text.data(), text.size()}; }

/// "mesh/7" to 7.
std::optional<std::size_t> mesh_number(const std::string& path) {
  constexpr std::string_view prefix = "mesh/";
  if (!path.starts_with(prefix)) return {};
  std::size_t number = 0;
  const char* const end = path.data() + path.size();
  const auto parsed = std::from_chars(path.data() + prefix.size(), end, number);
  if (parsed.ec != std::errc{} || parsed.ptr != end) return {};
  return number;
}

Response file_for(const Request& request, const std::string& path, const ViewContent& content) {
  if (const auto file = content.page->find(path); file != content.page->end()) {
    return answer(request, http::status::ok, file->second.type, file->second.bytes);
  }
  if (content.recordings != nullptr) {
    if (auto file = content.recordings->file(path)) {
      return answer(request, http::status::ok, file->type, std::move(file->bytes));
    }
    return refuse(request, http::status::not_found, "there is no such thing here");
  }
  if (path == "scene.toml") {
    Response response = answer(request, http::status::ok, "application/toml",
                               scene_toml(content.desk->feed().state()));
    response.set(http::field::content_disposition, "attachment; filename=\"scene.toml\"");
    return response;
  }
  if (const auto number = mesh_number(path)) {
    if (const auto mesh = content.desk->feed().mesh(*number)) {
      return answer(request, http::status::ok, "application/octet-stream", *mesh);
    }
  }
  return refuse(request, http::status::not_found, "there is no such thing here");
}

bool is_named(const std::string& origin, const std::vector<std::string>& origins) {
  return std::find(origins.begin(), origins.end(), origin) != origins.end();
}

/// The Foxglove subprotocol to answer with; empty where the client knows none.
std::string_view chosen_for(const Request& request) {
  const auto offered = request[http::field::sec_websocket_protocol];
  return chosen_protocol({offered.data(), offered.size()});
}

/// What is wrong with a request before it is looked at; nothing if it may be answered.
std::optional<Response> refusal_of(const Request& request, const Target& target,
                                   const ViewContent& content) {
  const std::string host = text_of(request[http::field::host]);
  if (!is_own_host(host, content.port)) {
    return refuse(request, http::status::forbidden,
                  "this name is not the view's own: open the address that spm-servo view printed");
  }
  if (!target.granted) {
    return refuse(request, http::status::forbidden,
                  "the token in the address is missing or wrong: open the address that spm-servo "
                  "view printed last");
  }
  if (request.method() != http::verb::get) {
    return refuse(request, http::status::method_not_allowed, "only GET is answered here");
  }
  const std::string origin = text_of(request[http::field::origin]);
  const bool is_foxglove = target.path == foxglove_path;
  if (!origin.empty() && !is_own_origin(origin, host) &&
      !(is_foxglove && is_named(origin, content.origins))) {
    return refuse(request, http::status::forbidden,
                  is_foxglove ? "pages of this origin may not watch: name it with --allow-origin"
                              : "a page of another origin may not ask here");
  }
  if (is_foxglove && (!websocket::is_upgrade(request) || chosen_for(request).empty())) {
    return refuse(request, http::status::bad_request,
                  "here the Foxglove protocol is spoken: open a WebSocket of the subprotocol "
                  "foxglove.sdk.v1 or foxglove.websocket.v1");
  }
  if (target.path == "ws" && (origin.empty() || !websocket::is_upgrade(request))) {
    return refuse(request, http::status::forbidden, "only the view's page speaks here");
  }
  return {};
}

using Socket = websocket::stream<beast::tcp_stream>;

/// Sends a page or a viewer what waits for it, until the connection ends.
template <class Peer>
asio::awaitable<void> send_all(std::shared_ptr<Socket> socket, std::shared_ptr<Peer> peer,
                               std::shared_ptr<asio::steady_timer> waker) {
  ViewPage::Message message;
  while (!peer->has_ended() && !peer->is_hopeless()) {
    if (!peer->next(message)) {
      waker->expires_at(std::chrono::steady_clock::time_point::max());
      boost::system::error_code woken;
      co_await waker->async_wait(asio::redirect_error(asio::use_awaitable, woken));
      continue;
    }
    boost::system::error_code wrong;
    socket->binary(message.is_frame);
    co_await socket->async_write(asio::buffer(message.bytes),
                                 asio::redirect_error(asio::use_awaitable, wrong));
    if (wrong) break;
  }
  beast::get_lowest_layer(*socket).close();
}

/// Speaks with a page or a viewer, which the desk knows meanwhile. `hear(peer, text)` follows what
/// it says.
template <class Peer, class Desk, class Hear>
asio::awaitable<void> serve_peer(beast::tcp_stream stream, Request request, Desk& desk,
                                 TellUser tell, Hear hear) {
  auto socket = std::make_shared<Socket>(std::move(stream));
  beast::get_lowest_layer(*socket).expires_never();
  socket->set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
  socket->set_option(websocket::stream_base::decorator(
      [protocol = std::string(chosen_for(request))](websocket::response_type& response) {
        if (!protocol.empty()) response.set(http::field::sec_websocket_protocol, protocol);
      }));
  socket->read_message_max(longest_message);
  boost::system::error_code wrong;
  co_await socket->async_accept(request, asio::redirect_error(asio::use_awaitable, wrong));
  if (wrong) co_return;
  auto waker = std::make_shared<asio::steady_timer>(socket->get_executor());
  auto peer = std::make_shared<Peer>([waker] { waker->cancel(); });
  desk.join(peer);
  asio::co_spawn(socket->get_executor(), send_all(socket, peer, waker), EndTold{std::move(tell)});
  beast::flat_buffer buffer;
  for (;;) {
    co_await socket->async_read(buffer, asio::redirect_error(asio::use_awaitable, wrong));
    if (wrong) break;
    hear(*peer, beast::buffers_to_string(buffer.data()));
    buffer.consume(buffer.size());
  }
  desk.leave(*peer);
  beast::get_lowest_layer(*socket).close();
  peer->end();
}

asio::awaitable<void> serve_page(beast::tcp_stream stream, Request request, ViewDesk& desk,
                                 TellUser tell) {
  return serve_peer<ViewPage>(
      std::move(stream), std::move(request), desk, std::move(tell),
      [&desk](ViewPage& page, const std::string& text) { desk.hear(page, text); });
}

asio::awaitable<void> serve_viewer(beast::tcp_stream stream, Request request, FoxgloveDesk& desk,
                                   TellUser tell) {
  return serve_peer<FoxgloveViewer>(
      std::move(stream), std::move(request), desk, std::move(tell),
      [](FoxgloveViewer& viewer, const std::string& text) { viewer.hear(text); });
}

}  // namespace

asio::awaitable<void> serve_connection(tcp::socket socket, ViewContent content) {
  beast::tcp_stream stream(std::move(socket));
  beast::flat_buffer buffer;
  boost::system::error_code wrong;
  stream.socket().set_option(tcp::no_delay(true), wrong);
  for (;;) {
    http::request_parser<http::empty_body> parser;
    parser.header_limit(longest_header);
    stream.expires_after(request_time);
    co_await http::async_read(stream, buffer, parser,
                              asio::redirect_error(asio::use_awaitable, wrong));
    if (wrong) break;
    const Request request = parser.release();
    const Target target = target_of(text_of(request.target()), content.token);
    std::optional<Response> response = refusal_of(request, target, content);
    if (!response && content.desk != nullptr && target.path == "ws") {
      if (!content.desk->is_full()) {
        co_await serve_page(std::move(stream), request, *content.desk, content.tell);
        co_return;
      }
      response = refuse(request, http::status::service_unavailable,
                        "there are 16 pages already: close one");
    }
    if (!response && content.foxglove != nullptr && target.path == foxglove_path) {
      if (!content.foxglove->is_full()) {
        co_await serve_viewer(std::move(stream), request, *content.foxglove, content.tell);
        co_return;
      }
      response = refuse(request, http::status::service_unavailable,
                        "there are 16 viewers already: close one");
    }
    if (!response) response = file_for(request, target.path, content);
    co_await http::async_write(stream, *response, asio::redirect_error(asio::use_awaitable, wrong));
    if (wrong || !response->keep_alive()) break;
  }
  stream.socket().shutdown(tcp::socket::shutdown_send, wrong);
}

}  // namespace spm::servo
