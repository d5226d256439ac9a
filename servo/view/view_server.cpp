// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_server.hpp"

#include <fmt/format.h>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <exception>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "servo/view/view_access.hpp"
#include "servo/view/view_desk.hpp"
#include "servo/view/view_foxglove.hpp"
#include "servo/view/view_pages.hpp"
#include "servo/view/view_recordings.hpp"
#include "servo/view/view_session.hpp"

namespace spm::servo {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

/// 60 frames a second for pages; without one, often enough to find a daemon.
constexpr std::chrono::microseconds frame_interval{16'667};
constexpr std::chrono::milliseconds idle_interval{100};
/// How long to wait where no connection can be accepted, and between sentences to the user.
constexpr std::chrono::milliseconds refused_interval{100};
constexpr std::chrono::seconds telling_interval{10};

/// At most one sentence in `telling_interval`: a page that comes again and again fills no log.
TellUser at_limited_rate(TellUser tell) {
  return [tell = std::move(tell), next = std::chrono::steady_clock::time_point::min()](
             const std::string& sentence) mutable {
    const auto now = std::chrono::steady_clock::now();
    if (now < next) return;
    next = now + telling_interval;
    tell(sentence);
  };
}

bool is_out_of_handles(const boost::system::error_code& wrong) {
  return wrong == boost::system::errc::too_many_files_open ||
         wrong == boost::system::errc::too_many_files_open_in_system;
}

class Server {
 public:
  Server(asio::io_context& context, tcp::acceptor acceptor, ViewContent content,
         const std::atomic<bool>& stop)
      : context_(context),
        acceptor_(std::move(acceptor)),
        timer_(context),
        refused_(context),
        stop_(stop),
        content_(std::move(content)) {}

  void start() {
    asio::co_spawn(context_, accept(), EndsView{});
    asio::co_spawn(context_, tick(), EndsView{});
  }

 private:
  asio::awaitable<void> accept() {
    for (;;) {
      boost::system::error_code wrong;
      tcp::socket socket =
          co_await acceptor_.async_accept(asio::redirect_error(asio::use_awaitable, wrong));
      if (!wrong) {
        asio::co_spawn(context_, serve_connection(std::move(socket), content_),
                       EndTold{content_.tell});
        continue;
      }
      content_.tell(
          is_out_of_handles(wrong)
              ? "the view has no handle left for another page: close pages or programs, "
                "or raise the limit of open files (ulimit -n); it goes on once one is free"
              : fmt::format("no page can connect ({}): the view goes on trying", wrong.message()));
      refused_.expires_after(refused_interval);
      co_await refused_.async_wait(asio::use_awaitable);
    }
  }

  /// Reads the daemon and hands frames to the pages and viewers. Whether there is one.
  bool look() {
    if (content_.desk == nullptr) return false;
    content_.desk->look();
    content_.foxglove->look(content_.desk->feed().state());
    return content_.desk->is_watched() || content_.foxglove->is_watched();
  }

  /// The clock of the view.
  asio::awaitable<void> tick() {
    auto due = std::chrono::steady_clock::now();
    while (!stop_.load(std::memory_order_relaxed)) {
      const bool is_watched = look();
      const auto now = std::chrono::steady_clock::now();
      due += is_watched ? std::chrono::nanoseconds(frame_interval)
                        : std::chrono::nanoseconds(idle_interval);
      if (due < now) due = now;
      timer_.expires_at(due);
      co_await timer_.async_wait(asio::use_awaitable);
    }
    context_.stop();
  }

  asio::io_context& context_;
  tcp::acceptor acceptor_;
  asio::steady_timer timer_, refused_;
  const std::atomic<bool>& stop_;
  ViewContent content_;
};

/// Opens the port. Errors as serve_view() says.
Result<tcp::acceptor> listen(asio::io_context& context, const ViewSettings& settings) {
  boost::system::error_code wrong;
  const auto address = asio::ip::make_address(settings.address, wrong);
  if (wrong) {
    return fail(ExitCode::usage, fmt::format("--address {}: is no address in digits; leave it away "
                                             "for this machine alone",
                                             settings.address));
  }
  tcp::acceptor acceptor(context);
  const tcp::endpoint place(address, settings.port);
  acceptor.open(place.protocol(), wrong);
  if (!wrong) acceptor.set_option(asio::socket_base::reuse_address(true), wrong);
  if (!wrong) acceptor.bind(place, wrong);
  if (!wrong) acceptor.listen(asio::socket_base::max_listen_connections, wrong);
  if (wrong) {
    return fail(ExitCode::file_or_device,
                fmt::format("port {} of {} cannot be opened ({}): take another one with --port, or "
                            "0 for any",
                            settings.port, settings.address, wrong.message()));
  }
  return acceptor;
}

}  // namespace

bool is_loopback(const std::string& address) {
  boost::system::error_code wrong;
  const auto parsed = asio::ip::make_address(address, wrong);
  return !wrong && parsed.is_loopback();
}

Result<void> serve_view(const ViewSettings& settings, const std::atomic<bool>& stop,
                        const std::function<void(const ViewAddresses&)>& started) {
  auto page =
      read_page(settings.page, settings.recordings.empty() ? PageKind::live : PageKind::recording);
  if (!page) return tl::make_unexpected(std::move(page.error()));
  auto recordings = ViewRecordings::open(settings.recordings);
  if (!recordings) return tl::make_unexpected(std::move(recordings.error()));
  auto token = make_token();
  if (!token) return tl::make_unexpected(std::move(token.error()));
  asio::io_context context(1);
  auto acceptor = listen(context, settings);
  if (!acceptor) return tl::make_unexpected(std::move(acceptor.error()));
  const tcp::endpoint place = acceptor->local_endpoint();
  const std::string host =
      place.address().is_v6() ? fmt::format("[{}]", settings.address) : settings.address;
  const std::string address = fmt::format("{}:{}/{}/", host, place.port(), *token);
  ViewFeed feed(settings.feed);
  ViewDesk desk(feed);
  FoxgloveDesk foxglove;
  ViewContent content{&*page, *token, place.port(), at_limited_rate(settings.tell),
                      settings.origins};
  ViewAddresses addresses{"http://" + address, ""};
  if (settings.recordings.empty()) {
    content.desk = &desk;
    content.foxglove = &foxglove;
    addresses.foxglove = fmt::format("ws://{}{}", address, foxglove_path);
  } else {
    content.recordings = &*recordings;
  }
  Server server(context, std::move(*acceptor), content, stop);
  server.start();
  started(addresses);
  try {
    context.run();
  } catch (const std::exception& problem) {
    return fail(ExitCode::internal,
                fmt::format("the view ended by a defect ({}): report it as a bug", problem.what()));
  }
  return {};
}

}  // namespace spm::servo
