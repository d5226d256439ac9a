// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

namespace spm {

/// Numbers of groups, in order.
using GroupNumbers = std::vector<std::uint32_t>;

/// Groups of a list of an ElementIndex: those that may hold the nearest unit, and all, which those
/// are among.
struct IndexLists {
  GroupNumbers nearest, all;

  auto operator<=>(const IndexLists&) const = default;

  /// The list as an index keeps it, of numbers of 16 bits if they are `small`.
  [[nodiscard]] std::vector<std::uint32_t> packed(bool small) const;
};

/// Adds numbers to others.
void add_numbers(const GroupNumbers& some, GroupNumbers& to);

/// Keeps only those of some numbers that are among others.
void keep_numbers(const GroupNumbers& others, GroupNumbers& of);

}  // namespace spm
