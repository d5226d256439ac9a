// SPDX-License-Identifier: Apache-2.0
#include "servo/top/top_terminal.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>

namespace spm::servo {

namespace {

constexpr std::size_t usual_width = 80, usual_height = 24;
constexpr char control_c = 3;

// Control sequences of ECMA-48, and the private modes that terminals have taken over from xterm.
constexpr std::string_view begin_screen = "\x1b[?1049h\x1b[?25l";
constexpr std::string_view end_screen = "\x1b[?25h\x1b[?1049l";
constexpr std::string_view to_top = "\x1b[H";
constexpr std::string_view end_line = "\x1b[K\r\n";
constexpr std::string_view clear_rest = "\x1b[J";

void write_all(std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t written = ::write(STDOUT_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

winsize size_of_terminal() noexcept {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) size = {};
  return size;
}

}  // namespace

TopTerminal::TopTerminal()
    : has_keys_(isatty(STDIN_FILENO) == 1 && tcgetattr(STDIN_FILENO, &before_) == 0) {
  if (has_keys_) {
    termios keys = before_;
    // Ctrl-C is read as a key, so that nothing stops the program before the terminal is restored.
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | ISIG);
    keys.c_cc[VMIN] = 0;
    keys.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSADRAIN, &keys);
  }
  write_all(begin_screen);
}

TopTerminal::~TopTerminal() {
  write_all(end_screen);
  if (has_keys_) tcsetattr(STDIN_FILENO, TCSADRAIN, &before_);
}

std::size_t TopTerminal::width() noexcept {
  const winsize size = size_of_terminal();
  return size.ws_col > 0 ? size.ws_col : usual_width;
}

void TopTerminal::draw(const std::string& lines) noexcept {
  const winsize size = size_of_terminal();
  // A line break in the last row would scroll all the others up.
  std::size_t room = (size.ws_row > 0 ? size.ws_row : usual_height) - std::size_t{1};
  std::string screen(to_top);
  for (std::size_t at = 0; at < lines.size() && room > 0; --room) {
    const std::size_t end = lines.find('\n', at);
    screen.append(lines, at, end - at).append(end_line);
    at = end == std::string::npos ? lines.size() : end + 1;
  }
  write_all(screen.append(clear_rest));
}

bool TopTerminal::wait_for_end(std::chrono::milliseconds time) noexcept {
  pollfd keys{STDIN_FILENO, POLLIN, 0};
  if (poll(&keys, has_keys_ ? 1 : 0, static_cast<int>(time.count())) <= 0) return false;
  char key = 0;
  const ssize_t got = read(STDIN_FILENO, &key, 1);
  return got <= 0 || key == 'q' || key == 'Q' || key == control_c;
}

}  // namespace spm::servo
