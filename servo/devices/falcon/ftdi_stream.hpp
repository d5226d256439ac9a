// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace spm::servo {

/// Size of one USB packet of an FTDI chip at full speed, bytes.
inline constexpr std::size_t ftdi_packet_size = 64;

/// Status bytes at the head of each of its packets: of the modem lines, and of the serial line.
inline constexpr std::size_t ftdi_status_size = 2;

/// Removes the status from every packet of a bulk IN transfer, in place. Returns how many bytes of
/// data are left at the front. Packets with status alone are usual: they mean that nothing came.
[[nodiscard]] std::size_t strip_ftdi_status(std::span<std::uint8_t> transfer) noexcept;

}  // namespace spm::servo
