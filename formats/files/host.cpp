// SPDX-License-Identifier: Apache-2.0
#include "formats/files/host.hpp"

namespace spm {

Result<void> check_host(const std::string& path, const Host& host) {
  constexpr std::size_t needed_bits = 64;
  std::string cause;
  if (host.order != std::endian::little) {
    cause = "this processor is not little-endian";
  } else if (host.address_bits < needed_bits) {
    cause =
        "this program was built for addresses of " + std::to_string(host.address_bits) + " bits";
  } else {
    return {};
  }
  return fail(ExitCode::unsupported,
              path + ": cannot be used on this machine, since " + cause +
                  "; its words are read as they lie, so use a 64-bit little-endian machine");
}

}  // namespace spm
