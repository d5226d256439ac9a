// SPDX-License-Identifier: Apache-2.0
#include "common/index/index_lists.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace spm {

std::vector<std::uint32_t> IndexLists::packed(bool small) const {
  PacketNumbers numbers = nearest;
  std::set_difference(all.begin(), all.end(), nearest.begin(), nearest.end(),
                      std::back_inserter(numbers));
  std::vector<std::uint32_t> words{static_cast<std::uint32_t>(nearest.size()) |
                                   static_cast<std::uint32_t>(numbers.size()) << 16U};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (small && (i & 1U) != 0) {
      words.back() |= numbers[i] << 16U;
    } else {
      words.push_back(numbers[i]);
    }
  }
  return words;
}

void add_numbers(const PacketNumbers& some, PacketNumbers& to) {
  PacketNumbers both;
  std::set_union(some.begin(), some.end(), to.begin(), to.end(), std::back_inserter(both));
  to = std::move(both);
}

void keep_numbers(const PacketNumbers& others, PacketNumbers& of) {
  PacketNumbers both;
  std::set_intersection(others.begin(), others.end(), of.begin(), of.end(),
                        std::back_inserter(both));
  of = std::move(both);
}

}  // namespace spm
