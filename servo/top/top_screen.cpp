// SPDX-License-Identifier: Apache-2.0
#include "servo/top/top_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace spm::servo {

namespace {

constexpr std::size_t indent = 4;

/// A text made of lines of limited width.
class Lines {
 public:
  explicit Lines(std::size_t width) : width_(std::max(width, narrowest_screen)) {}

  void row(std::string_view line) {
    line = line.substr(0, width_);
    const std::size_t last = line.find_last_not_of(' ');
    text_.append(line.substr(0, last == std::string_view::npos ? 0 : last + 1));
    text_ += '\n';
  }

  /// Broken between words. Lines after the first are indented, and the first one by `first`.
  void sentence(std::string_view words, std::size_t first = 0) {
    std::string line(first, ' ');
    for (bool empty = true; !words.empty();) {
      const std::string_view word = words.substr(0, words.find(' '));
      if (!empty && line.size() + 1 + word.size() > width_) {
        row(line);
        line.assign(indent, ' ');
        empty = true;
      }
      if (!empty) line += ' ';
      line += word;
      empty = false;
      words.remove_prefix(std::min(words.size(), word.size() + 1));
    }
    row(line);
  }

  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::size_t width_;
  std::string text_;
};

std::string state_of(const TopView& view) {
  const std::string since = fmt::format("{:.1f} s", view.age);
  switch (view.daemon) {
    case SPM_CLIENT_RUNNING:
      return "running";
    case SPM_CLIENT_ENDED:
      return "it has ended; these are its last figures";
    case SPM_CLIENT_GONE:
      return "GONE; these are its last figures";
    default:
      return view.age < 0 ? "its loop has not begun yet"
                          : "STALLED, no tick for " + since +
                                ": it is stopped or its loop hangs; continue it, or start it again";
  }
}

std::string times_of(const char* what, const TopTimes& times) {
  return fmt::format("{:<6} p50 {:.1f}, p99 {:.1f}, max {:.1f} us", what, times.p50, times.p99,
                     times.max);
}

/// A count since the loop began, and how much of it is new.
std::string count_of(const TopCount& count) {
  return count.recent > 0 ? fmt::format("{} (+{})", count.total, count.recent)
                          : std::to_string(count.total);
}

void add_loop(Lines& lines, const TopView& view) {
  lines.row(fmt::format("rate   {:.2f} of {:g} Hz over the last {:.1f} s; (+n) came in it",
                        view.rate_hz, view.wanted_rate_hz, view.seconds));
  lines.row(times_of("late", view.wake));
  lines.row(times_of("busy", view.busy) +
            fmt::format(", {:.2f} % of the time", 100 * view.busy_share));
  const std::string coarse =
      view.coarse.total > 0 ? "; coarser samples " + count_of(view.coarse) : "";
  lines.row(fmt::format("missed {} of {} ticks, of them skipped {}; degraded {}{}",
                        count_of(view.missed), view.ticks + view.skipped.total,
                        count_of(view.skipped), count_of(view.degraded), coarse));
}

/// Torque, where the device gives it, and the tool, where the hand holds one.
std::string turning_of(const TopDevice& device) {
  std::string text;
  if (device.torque_cap > 0) {
    text = fmt::format("torque {:.4f} N m, max {:.4f}, cap met {}, slew held {}", device.torque,
                       device.torque_max, count_of(device.torque_cap_hits),
                       count_of(device.torque_slew_hits));
  }
  const TopTool& tool = device.tool;
  if (!tool.is_there) return text;
  text += fmt::format(
      "{}tool at {:.2f} {:.2f} {:.2f} mm, turned {:.3f} {:.3f} {:.3f} {:.3f}, touches at {} "
      "place{}, {} object{} culled, level {}, coupling's cap met {}",
      text.empty() ? "" : "; ", 1e3 * tool.position[0], 1e3 * tool.position[1],
      1e3 * tool.position[2], tool.orientation[0], tool.orientation[1], tool.orientation[2],
      tool.orientation[3], tool.contacts, tool.contacts == 1 ? "" : "s", tool.culled,
      tool.culled == 1 ? "" : "s", tool.level, count_of(tool.cap_hits));
  return text + (tool.capped ? " (now)" : "");
}

void add_device(Lines& lines, const TopDevice& device) {
  lines.row(fmt::format("{:<15} {:>6.3f} N {:>6.3f} N {:>10} {:>10} {:>9.4f} J  {} {}", device.name,
                        device.force, device.force_max, count_of(device.cap_hits),
                        count_of(device.slew_hits), device.energy, device.contact ? "yes" : "no ",
                        device.contacts));
  if (const std::string turning = turning_of(device); !turning.empty()) {
    lines.sentence(turning, indent);
  }
  const std::string words = device.cause + ": " + device.cure;
  if (device.off) {
    lines.sentence("NO FORCE, " + words, indent);
  } else if (device.cuts.total > 0) {
    lines.sentence("force was cut " + count_of(device.cuts) + " times, last " + words, indent);
  }
}

const char* words_of_role(std::uint32_t role) noexcept {
  return role == SPM_CLIENT_SUPERVISOR ? ", supervisor"
         : role == SPM_CLIENT_OBSERVER ? ", observer"
                                       : "";
}

void add_applications(Lines& lines, const TopView& view) {
  const std::size_t count = view.applications.size();
  std::string words = fmt::format("{} application{}", count, count == 1 ? "" : "s");
  for (std::size_t i = 0; i < count; ++i) {
    const spm_client_application& application = view.applications[i];
    words += fmt::format("{} {} (process {}{})", i == 0 ? ":" : ",",
                         application.name[0] != '\0' ? application.name : "without a name",
                         application.process, words_of_role(application.role));
  }
  lines.sentence(words);
  lines.sentence(fmt::format("commands: {} taken, {} refused, {} garbage", view.commands,
                             view.refused, view.garbage));
}

}  // namespace

std::string top_screen(const TopView& view, std::size_t width) {
  Lines lines(width);
  lines.sentence(
      fmt::format("spm-servo {}, process {}: {}", view.version, view.process, state_of(view)));
  add_loop(lines, view);
  lines.row("");
  lines.row(fmt::format("{:<15} {:>8} {:>8} {:>10} {:>10} {:>11}  {}", "device", "force", "max",
                        "cap met", "slew held", "energy", "touches"));
  for (const TopDevice& device : view.devices) add_device(lines, device);
  lines.row("");
  add_applications(lines, view);
  return lines.take();
}

}  // namespace spm::servo
