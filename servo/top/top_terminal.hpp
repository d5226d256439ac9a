// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <chrono>
#include <cstddef>
#include <string>

namespace spm::servo {

/// The terminal at standard output while a program draws on it: a screen of its own, without a
/// cursor, and keys that come at once and unseen. As it was before at the end. One at a time.
class TopTerminal {
 public:
  TopTerminal();
  ~TopTerminal();
  TopTerminal(const TopTerminal&) = delete;
  TopTerminal& operator=(const TopTerminal&) = delete;

  /// Columns, 80 where the terminal does not tell.
  [[nodiscard]] static std::size_t width() noexcept;

  /// Draws lines over what was there; those that have no room below are left out.
  void draw(const std::string& lines) noexcept;

  /// Waits so long, or until a key is pressed; true for q, Ctrl-C and a terminal that is gone.
  [[nodiscard]] bool wait_for_end(std::chrono::milliseconds time) noexcept;

 private:
  termios before_{};
  bool has_keys_;  ///< standard input is a terminal too
};

}  // namespace spm::servo
