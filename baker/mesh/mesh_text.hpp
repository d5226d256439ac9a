// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/vector.hpp"

namespace spm::baker {

/// The word in lower case, of ASCII letters alone.
[[nodiscard]] std::string lower_case(std::string_view word);

/// Whether bytes begin with the byte order mark of UTF-16, and such text in ASCII: letters that it
/// has not become '?'. Throws BakeError invalid_input, which names the file.
[[nodiscard]] bool is_utf16(std::string_view bytes);
[[nodiscard]] std::string ascii_of_utf16(const std::string& path, std::string_view bytes);

/// Walks through the lines and words of a mesh file in text form. Throws BakeError invalid_input,
/// which names file and line. Independent of the locale.
class MeshText {
 public:
  /// Begins at byte `start`, which is on line `line`. Throws where the text holds binary data.
  MeshText(std::string path, std::string_view bytes, std::size_t start = 0, std::size_t line = 0);

  /// Moves to the next line that has a word. What follows '#' is a comment. False at the end.
  [[nodiscard]] bool next_line();

  /// Next word of the line; empty at its end.
  [[nodiscard]] std::string_view next_word();

  /// Next word of this line or a following one. Throws "cut short" at the end of the file.
  [[nodiscard]] std::string_view next_word_anywhere(std::string_view what);

  /// The coordinates of a vertex, the next words of the line; `cure` where there are fewer.
  [[nodiscard]] Vector3 point(const std::string& cure);

  [[nodiscard]] double number(std::string_view word, std::string_view what) const;
  [[nodiscard]] std::int64_t integer(std::string_view word, std::string_view what) const;

  /// Throws: "path: line N: cause; cure".
  [[noreturn]] void fail(const std::string& cause, const std::string& cure) const;
  [[noreturn]] void fail_at(std::size_t line, const std::string& cause,
                            const std::string& cure) const;
  [[noreturn]] void fail_cut_short(std::string_view missing) const;

  [[nodiscard]] std::size_t line() const noexcept { return line_; }
  /// Offset of the first byte after the current line.
  [[nodiscard]] std::size_t position() const noexcept { return position_; }

 private:
  std::string path_;
  std::string_view bytes_;
  std::size_t position_;
  std::size_t line_;
  std::string_view rest_;
};

}  // namespace spm::baker
