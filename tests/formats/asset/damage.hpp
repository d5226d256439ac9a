// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/asset/asset.hpp"

namespace spm::test {

/// A damaged file, and how it must be refused.
struct Damage {
  std::string name;
  std::string bytes;
  std::string cause;  ///< words of the message
};

/// Bytes of an asset's file; the writer does not check where the words of grid and octree point.
[[nodiscard]] std::string baked(const Asset& asset);

/// Replaces text in the header by text of the same length and makes the checksum right again.
[[nodiscard]] std::string with_header_text(std::string bytes, const std::string& from,
                                           const std::string& to);

/// Puts a word at an offset and makes the checksum right again.
[[nodiscard]] std::string with_word(std::string bytes, std::uint64_t offset, std::uint32_t word);

/// Offset of word k of a flat part, found by hand.
[[nodiscard]] std::uint64_t flat_word(const std::string& bytes, const std::string& name,
                                      std::uint64_t k);

/// Checks that the file at `path` is refused as invalid input, however it is mapped, with one
/// sentence that names it, the cause and the cure.
void check_refused(const Damage& damage, const std::string& path);
void check_all_refused(const std::vector<Damage>& cases);

}  // namespace spm::test
