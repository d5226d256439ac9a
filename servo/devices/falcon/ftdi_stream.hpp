// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace spm::servo {

/// Bytes of one USB packet of an FTDI chip at full speed.
inline constexpr std::size_t ftdi_packet_size = 64;

/// Bytes of status that lead each of its packets: of the modem lines, and of the serial line.
inline constexpr std::size_t ftdi_status_size = 2;

/// Takes the status out of every packet of a bulk IN transfer, in place, and returns how many bytes
/// of data are left at its front. A packet of status alone is usual, it means that nothing came.
[[nodiscard]] std::size_t strip_ftdi_status(std::span<std::uint8_t> transfer) noexcept;

}  // namespace spm::servo
