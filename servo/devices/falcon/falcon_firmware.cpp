// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_firmware.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <thread>

#include "formats/files/sha256.hpp"
#include "servo/devices/falcon/falcon_packet.hpp"

namespace spm::servo {

namespace {

using std::chrono::milliseconds;

// Requests to the FTDI chip, and their values, as public drivers of the chip send them.
constexpr std::uint8_t purge_request = 0, modem_request = 1, flow_request = 2, baud_request = 3,
                       line_request = 4, latency_request = 9;
constexpr std::uint16_t purge_receiving = 1, purge_sending = 2;
constexpr std::uint16_t data_ready_low = 0x0100, data_ready_high = 0x0101, send_ready_low = 0x0200;
constexpr std::uint16_t no_flow_control = 0, eight_bits_no_parity = 0x0008;
constexpr std::uint16_t boot_baud = 0x4138;    // 9600
constexpr std::uint16_t upload_baud = 0x0015;  // 142 857
constexpr std::uint16_t normal_baud = 0x0002;  // 1.5 million
constexpr std::uint16_t normal_latency = 1;    // ms
/// With 1 ms the answers of the boot program arrive in several packets.
constexpr std::uint16_t upload_latency = 16;  // ms

constexpr std::array<std::uint8_t, 3> boot_call{0x0A, 0x43, 0x0D};
/// Sometimes preceded by one zero or more.
constexpr std::array<std::uint8_t, 4> boot_answer{0x0A, 0x44, 0x2C, 0x0D};
constexpr std::array<std::uint8_t, 1> load_call{0x41};

constexpr milliseconds transfer_timeout{1000};
/// Time between two checks of `stop`.
constexpr milliseconds look_interval{50};
/// The call and its answer take 8 ms at 9600 baud, and the chip takes up to 16 ms to pass them on.
constexpr milliseconds boot_answer_timeout{50};
constexpr std::size_t max_boot_bytes = 512;  // that may come with its answer, as users found
constexpr std::size_t block_size = 62;       // the largest block that one USB packet can echo

constexpr int probe_rounds = 10;
constexpr milliseconds probe_timeout{100};  // for one round
constexpr std::size_t max_probe_bytes = 4096;

constexpr std::size_t smallest_file = 4096, largest_file = 16384;  // bytes
/// The key of a boot table for this family of signal processors.
constexpr std::array<std::uint8_t, 2> boot_key{0xAA, 0x08};

struct KnownFirmware {
  std::size_t size;
  std::string_view sha256_begin;
};

/// Files that public drivers and their users have. Used only to recognise them.
constexpr std::array<KnownFirmware, 4> known_firmware{{{8492, "1119e39c39fab1f3"},
                                                       {7914, "ae838730af34b582"},
                                                       {7914, "e0ae3598670fa1c8"},
                                                       {7324, "b2700d5cd5ca217e"}}};

/// Why an attempt ended: a clause of a sentence; empty if it succeeded.
struct Outcome {
  std::string failure;
  bool again = true;  ///< whether another attempt may succeed
};

Outcome failed(std::string_view step, std::string_view cause) {
  return {fmt::format("{}: {}", step, cause), true};
}

Outcome failed(std::string_view step, LinkStatus status) {
  switch (status) {
    case LinkStatus::done:
      return {};
    case LinkStatus::timed_out:
      return failed(step, "no answer came");
    case LinkStatus::failed:
      return failed(step, "the transfer failed");
    case LinkStatus::gone:
      break;
  }
  return {fmt::format("{}: the device was unplugged", step), false};
}

Outcome ended(std::string_view step) {
  return {fmt::format("{}: it was told to end", step), false};
}

struct Request {
  std::uint8_t request;
  std::uint16_t value;
};

LinkStatus send_requests(ByteLink& link, std::span<const Request> requests) {
  for (const Request& request : requests) {
    const LinkStatus status = link.control(request.request, request.value);
    if (status != LinkStatus::done) return status;
  }
  return LinkStatus::done;
}

LinkStatus enter_normal_mode(ByteLink& link) {
  constexpr std::array<Request, 6> requests{{{purge_request, purge_receiving},
                                             {purge_request, purge_sending},
                                             {latency_request, normal_latency},
                                             {baud_request, normal_baud},
                                             {purge_request, purge_receiving},
                                             {purge_request, purge_sending}}};
  return send_requests(link, requests);
}

/// Reads until `enough` is true for all bytes read, `most` bytes have come, or nothing came for
/// `timeout`. The status is `timed_out` also if `enough` was never true.
template <class Enough>
LinkResult read_until(ByteLink& link, std::span<std::uint8_t> bytes, milliseconds timeout,
                      const std::atomic<bool>& stop, const Enough& enough) {
  LinkResult all;
  milliseconds waited{0};
  while (all.bytes < bytes.size() && waited < timeout && !stop.load()) {
    const milliseconds wait = std::min(look_interval, timeout - waited);
    const LinkResult part = link.read(bytes.subspan(all.bytes), wait);
    all.bytes += part.bytes;
    if (part.bytes > 0 && enough(bytes.first(all.bytes))) return all;
    if (part.status == LinkStatus::timed_out) {
      waited += wait;
    } else if (part.status != LinkStatus::done) {
      return {part.status, all.bytes};
    }
  }
  return {LinkStatus::timed_out, all.bytes};
}

bool holds(std::span<const std::uint8_t> bytes, std::span<const std::uint8_t> pattern) {
  return std::search(bytes.begin(), bytes.end(), pattern.begin(), pattern.end()) != bytes.end();
}

/// Sends a call, and waits until its answer is among the bytes that arrive.
LinkStatus call(ByteLink& link, std::span<const std::uint8_t> question,
                std::span<const std::uint8_t> answer, milliseconds timeout,
                const std::atomic<bool>& stop) {
  const LinkResult sent = link.write(question, transfer_timeout);
  if (sent.status != LinkStatus::done) return sent.status;
  std::array<std::uint8_t, max_boot_bytes> bytes{};
  return read_until(link, bytes, timeout, stop,
                    [answer](std::span<const std::uint8_t> come) { return holds(come, answer); })
      .status;
}

/// Starts the boot program, and calls it until it answers.
Outcome start_boot_program(ByteLink& link, const std::atomic<bool>& stop, int calls) {
  constexpr std::string_view setting = "setting the line for the boot program";
  constexpr std::array<Request, 9> requests{{{purge_request, purge_receiving},
                                             {purge_request, purge_sending},
                                             {latency_request, upload_latency},
                                             {baud_request, boot_baud},
                                             {line_request, eight_bits_no_parity},
                                             {flow_request, no_flow_control},
                                             {modem_request, send_ready_low},
                                             {modem_request, data_ready_low},
                                             {modem_request, data_ready_high}}};
  LinkStatus status = send_requests(link, requests);
  if (status != LinkStatus::done) return failed(setting, status);

  constexpr std::string_view calling = "calling the boot program";
  for (int i = 0; i < calls; ++i) {
    status = call(link, boot_call, boot_answer, boot_answer_timeout, stop);
    if (stop.load()) return ended(calling);
    if (status != LinkStatus::timed_out) return failed(calling, status);
  }
  return failed(calling, LinkStatus::timed_out);
}

Outcome begin_load(ByteLink& link, const std::atomic<bool>& stop) {
  constexpr std::string_view step = "asking the boot program to load";
  constexpr std::array<Request, 2> requests{
      {{modem_request, data_ready_low}, {baud_request, upload_baud}}};
  LinkStatus status = send_requests(link, requests);
  if (status != LinkStatus::done) return failed(step, status);
  status = call(link, load_call, load_call, transfer_timeout, stop);
  if (stop.load()) return ended(step);
  return failed(step, status);
}

/// Sends the file block by block; the boot program echoes every byte.
Outcome send_file(ByteLink& link, std::span<const std::uint8_t> firmware,
                  const std::atomic<bool>& stop) {
  for (std::size_t begin = 0; begin < firmware.size(); begin += block_size) {
    const auto block = firmware.subspan(begin, std::min(block_size, firmware.size() - begin));
    const std::string step =
        fmt::format("sending bytes {} to {} of the file", begin, begin + block.size() - 1);
    if (stop.load()) return ended(step);
    const LinkResult sent = link.write(block, transfer_timeout);
    if (sent.status != LinkStatus::done) return failed(step, sent.status);

    std::array<std::uint8_t, block_size> echo{};
    const std::span<std::uint8_t> wanted = std::span(echo).first(block.size());
    const LinkResult come = read_until(
        link, wanted, transfer_timeout, stop,
        [&block](std::span<const std::uint8_t> bytes) { return bytes.size() == block.size(); });
    if (stop.load()) return ended(step);
    const auto [at, echoed] = std::mismatch(
        block.begin(), block.begin() + static_cast<std::ptrdiff_t>(come.bytes), echo.begin());
    const auto right = static_cast<std::size_t>(at - block.begin());
    if (right < come.bytes) {
      return failed(step, fmt::format("byte {} came back as {:02x}, not {:02x}", begin + right,
                                      unsigned{*echoed}, unsigned{*at}));
    }
    if (come.status == LinkStatus::timed_out) {
      return failed(step, fmt::format("only {} of {} bytes came back", come.bytes, block.size()));
    }
    if (come.status != LinkStatus::done) return failed(step, come.status);
  }
  return {};
}

/// Whether a packet is answered by a packet, within one round.
LinkStatus probe(ByteLink& link, const std::atomic<bool>& stop) {
  const auto packet = encode(FalconCommand{});
  const LinkResult sent = link.write(packet, transfer_timeout);
  if (sent.status != LinkStatus::done) return sent.status;
  FalconParser parser;
  std::size_t parsed = 0;
  std::array<std::uint8_t, max_probe_bytes> bytes{};
  return read_until(link, bytes, probe_timeout, stop,
                    [&](std::span<const std::uint8_t> come) {
                      for (; parsed < come.size(); ++parsed) {
                        if (parser.take(come[parsed])) return true;
                      }
                      return false;
                    })
      .status;
}

Outcome start_firmware(ByteLink& link, const std::atomic<bool>& stop) {
  constexpr std::string_view step = "starting the firmware";
  const LinkStatus status = enter_normal_mode(link);
  if (status != LinkStatus::done) return failed(step, status);
  for (int round = 0; round < probe_rounds; ++round) {
    const LinkStatus answered = probe(link, stop);
    if (stop.load()) return ended(step);
    if (answered != LinkStatus::timed_out) return failed(step, answered);
  }
  return failed(step, "it was sent whole, but does not answer");
}

Outcome upload_once(ByteLink& link, std::span<const std::uint8_t> firmware,
                    const std::atomic<bool>& stop, int calls) {
  if (Outcome outcome = start_boot_program(link, stop, calls); !outcome.failure.empty()) {
    return outcome;
  }
  if (Outcome outcome = begin_load(link, stop); !outcome.failure.empty()) return outcome;
  if (Outcome outcome = send_file(link, firmware, stop); !outcome.failure.empty()) return outcome;
  return start_firmware(link, stop);
}

void back_off(milliseconds time, const std::atomic<bool>& stop) {
  for (milliseconds waited{0}; waited < time && !stop.load(); waited += look_interval) {
    std::this_thread::sleep_for(std::min(look_interval, time - waited));
  }
}

tl::unexpected<Error> link_error(std::string_view what, LinkStatus status) {
  if (status == LinkStatus::gone) {
    return fail(ExitCode::file_or_device,
                fmt::format("the Falcon was unplugged while {}; plug it in again", what));
  }
  return fail(ExitCode::file_or_device,
              fmt::format("the Falcon's USB chip {} while {}; plug its USB cable in again, at "
                          "another port or without a hub",
                          status == LinkStatus::timed_out ? "did not answer" : "refused", what));
}

}  // namespace

Result<FalconFirmwareFile> read_falcon_firmware(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  FalconFirmwareFile firmware;
  firmware.path = path;
  // One byte more than is allowed reveals a longer file, however long it is.
  std::vector<char> bytes(largest_file + 1);
  if (file) file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file.is_open() || file.bad()) {
    return fail(ExitCode::file_or_device,
                fmt::format("{}: the Falcon's firmware cannot be read ({}); name the file that "
                            "came with the device's software: --device falcon:firmware=FILE",
                            path, std::strerror(errno)));
  }
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  firmware.bytes.assign(bytes.begin(), bytes.end());
  const std::size_t size = bytes.size();
  if (size < smallest_file || size > largest_file) {
    return fail(ExitCode::invalid_input,
                fmt::format("{}: is no Falcon's firmware, it has {} bytes and a firmware {} to {}; "
                            "name the file that came with the device's software",
                            path, size > largest_file ? "too many" : std::to_string(size),
                            smallest_file, largest_file));
  }
  if (!std::equal(boot_key.begin(), boot_key.end(), firmware.bytes.begin())) {
    return fail(ExitCode::invalid_input,
                fmt::format("{}: is no Falcon's firmware, it begins with {:02x} {:02x} and a "
                            "firmware with aa 08; name the file that came with the device's "
                            "software",
                            path, unsigned{firmware.bytes[0]}, unsigned{firmware.bytes[1]}));
  }
  firmware.sha256 = sha256_bytes(std::string_view(bytes.data(), size));
  firmware.known = std::any_of(
      known_firmware.begin(), known_firmware.end(), [&firmware](const KnownFirmware& known) {
        return known.size == firmware.bytes.size() &&
               firmware.sha256.compare(0, known.sha256_begin.size(), known.sha256_begin) == 0;
      });
  return firmware;
}

Result<void> set_falcon_normal_mode(ByteLink& link) {
  const LinkStatus status = enter_normal_mode(link);
  if (status != LinkStatus::done) return link_error("its line was set", status);
  return {};
}

Result<bool> falcon_firmware_runs(ByteLink& link, const std::atomic<bool>& stop) {
  constexpr std::string_view what = "it was asked whether its firmware runs";
  for (int round = 0; round < probe_rounds; ++round) {
    const LinkStatus status = probe(link, stop);
    if (stop.load()) {
      return fail(ExitCode::file_or_device, "the Falcon was not opened, it was told to end");
    }
    if (status == LinkStatus::done) return true;
    if (status != LinkStatus::timed_out) return link_error(what, status);
  }
  return false;
}

Result<void> upload_falcon_firmware(ByteLink& link, std::span<const std::uint8_t> firmware,
                                    const std::atomic<bool>& stop,
                                    const FalconUploadLimits& limits) {
  milliseconds wait = limits.back_off;
  int attempts = 0;
  Outcome outcome;
  do {
    if (attempts > 0) {
      back_off(wait, stop);
      wait = std::min(2 * wait, limits.longest_back_off);
    }
    outcome = upload_once(link, firmware, stop, limits.calls);
    ++attempts;
    if (outcome.failure.empty()) return {};
  } while (outcome.again && attempts < limits.attempts && !stop.load());
  return fail(ExitCode::file_or_device,
              fmt::format("the Falcon's firmware could not be loaded in {} attempt{}, the last "
                          "failed at {}; check that its power supply is plugged in, try another "
                          "USB port without a hub, and unplug its power for some seconds",
                          attempts, attempts == 1 ? "" : "s", outcome.failure));
}

}  // namespace spm::servo
