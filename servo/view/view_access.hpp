// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace spm::servo {

/// A secret of 128 bits from the system, in 32 hexadecimal digits. Errors: internal, where the
/// system gives none.
[[nodiscard]] Result<std::string> make_token();

/// Whether two texts are the same, in a time that does not tell how far they are.
[[nodiscard]] bool same_secret(std::string_view given, std::string_view wanted) noexcept;

/// Whether a request's Host header may be answered: an address in digits or `localhost`, with the
/// server's port. A name could be one that a foreign site points at this machine.
[[nodiscard]] bool is_own_host(std::string_view host, unsigned port);

/// Whether a page of this origin may open the view's WebSocket: the page that was got from the same
/// host alone.
[[nodiscard]] bool is_own_origin(std::string_view origin, std::string_view host);

/// What a request's target asks for below the token: "" for the page, "view.js", "ws", ... ; empty
/// `granted` where the token is missing or wrong.
struct Target {
  bool granted = false;
  std::string path;
};
[[nodiscard]] Target target_of(std::string_view target, std::string_view token);

}  // namespace spm::servo
