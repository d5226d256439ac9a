// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace spm {

/// Levels of objects and arrays that a JSON text may nest. Ours have fewer than ten.
inline constexpr int most_json_levels = 64;

/// Whether a text nests no deeper than `most_json_levels`, whatever else is wrong with it. To copy,
/// print and destroy a value takes a call a level, so that a deep one would end the program.
[[nodiscard]] bool is_shallow_json(std::string_view text) noexcept;

/// The value of a JSON text that came from outside; a discarded value, which is neither object nor
/// array, where it is broken, nests too deep or has a number beyond all doubles.
template <class Json>
[[nodiscard]] Json parse_json(std::string_view text) {
  if (!is_shallow_json(text)) return Json(Json::value_t::discarded);
  return Json::parse(text.begin(), text.end(), nullptr, false);
}

}  // namespace spm
