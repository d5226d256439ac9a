// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

namespace spm {

/// Numbers of packets, in order.
using PacketNumbers = std::vector<std::uint32_t>;

/// The packets of a list of an ElementIndex: `all`, and among them those that may hold the nearest
/// primitive.
struct IndexLists {
  PacketNumbers nearest, all;

  auto operator<=>(const IndexLists&) const = default;

  /// The list as an index keeps it, of numbers of 16 bits if they are `small`.
  [[nodiscard]] std::vector<std::uint32_t> packed(bool small) const;
};

/// Adds numbers to others.
void add_numbers(const PacketNumbers& some, PacketNumbers& to);

/// Keeps only those of some numbers that are among others.
void keep_numbers(const PacketNumbers& others, PacketNumbers& of);

}  // namespace spm
