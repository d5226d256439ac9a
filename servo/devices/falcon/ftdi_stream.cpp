// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/ftdi_stream.hpp"

#include <algorithm>

namespace spm::servo {

std::size_t strip_ftdi_status(std::span<std::uint8_t> transfer) noexcept {
  std::size_t kept = 0;
  for (std::size_t begin = 0; begin < transfer.size(); begin += ftdi_packet_size) {
    const std::size_t end = std::min(begin + ftdi_packet_size, transfer.size());
    for (std::size_t i = begin + ftdi_status_size; i < end; ++i) transfer[kept++] = transfer[i];
  }
  return kept;
}

}  // namespace spm::servo
