// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace spm::cli {

/// The word that a misspelt one most likely stands for: the one with the smallest Levenshtein
/// distance, the first in a tie; nothing where more than a third of the letters would change.
[[nodiscard]] std::optional<std::string> nearest_word(std::string_view misspelt,
                                                      std::span<const std::string> words);

}  // namespace spm::cli
