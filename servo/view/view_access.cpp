// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_access.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <boost/asio/ip/address.hpp>

namespace spm::servo {

Result<std::string> make_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    return fail(ExitCode::internal,
                "the system gave no random bytes for the token of the view: try again");
  }
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool same_secret(std::string_view given, std::string_view wanted) noexcept {
  std::size_t different = given.size() ^ wanted.size();
  for (std::size_t i = 0; i < std::min(given.size(), wanted.size()); ++i) {
    different |= static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(wanted[i]);
  }
  return different == 0;
}

bool is_own_host(std::string_view host, unsigned port) {
  const std::string ending = fmt::format(":{}", port);
  if (!host.ends_with(ending)) return false;
  host.remove_suffix(ending.size());
  if (host == "localhost") return true;
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  boost::system::error_code wrong;
  boost::asio::ip::make_address(std::string(host), wrong);
  return !wrong;
}

bool is_own_origin(std::string_view origin, std::string_view host) {
  constexpr std::string_view scheme = "http://";
  return origin.starts_with(scheme) && origin.substr(scheme.size()) == host;
}

Target target_of(std::string_view target, std::string_view token) {
  target = target.substr(0, target.find('?'));
  if (!target.starts_with('/')) return {};
  target.remove_prefix(1);
  const std::size_t end = target.find('/');
  if (end == std::string_view::npos || !same_secret(target.substr(0, end), token)) return {};
  return {true, std::string(target.substr(end + 1))};
}

}  // namespace spm::servo
