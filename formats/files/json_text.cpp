// SPDX-License-Identifier: Apache-2.0
#include "formats/files/json_text.hpp"

namespace spm {

bool is_shallow_json(std::string_view text) noexcept {
  int levels = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (quoted) {
      if (letter == '\\') ++i;  // whatever is escaped ends no text
      quoted = letter != '"';
    } else if (letter == '"') {
      quoted = true;
    } else if (letter == '{' || letter == '[') {
      if (++levels > most_json_levels) return false;
    } else if (letter == '}' || letter == ']') {
      --levels;
    }
  }
  return true;
}

}  // namespace spm
