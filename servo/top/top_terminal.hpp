// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <chrono>
#include <cstddef>
#include <string>

namespace spm::servo {

/// The terminal at standard output while a program draws on it: a screen of its own, without a
/// cursor, and keys that are read at once and not echoed. At the end the terminal is restored. At
/// most one object at a time.
class TopTerminal {
 public:
  TopTerminal();
  ~TopTerminal();
  TopTerminal(const TopTerminal&) = delete;
  TopTerminal& operator=(const TopTerminal&) = delete;

  /// Width in columns; 80 if the terminal does not say.
  [[nodiscard]] static std::size_t width() noexcept;

  /// Draws lines over the previous ones. Lines that do not fit at the bottom are left out.
  void draw(const std::string& lines) noexcept;

  /// Waits until the time is over or a key is pressed. True for q, Ctrl-C and a terminal that is
  /// gone.
  [[nodiscard]] bool wait_for_end(std::chrono::milliseconds time) noexcept;

 private:
  termios before_{};
  bool has_keys_;  ///< whether standard input is a terminal too
};

}  // namespace spm::servo
